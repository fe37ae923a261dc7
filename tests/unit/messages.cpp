// SPDX-License-Identifier: MIT
//
// Messages: how they look, what they survive, and what they suggest.
#include "kernel/report/messages.h"

#include <string>
#include <vector>

#include "kernel/report/printable.h"
#include "support/catch.h"

namespace lapidary {

namespace {

// The message about one place of a one-line file.
Message message_at(Sources& sources, std::string line, std::uint32_t column) {
    Messages messages;
    messages.error({&sources.add("s", "first\n" + std::move(line) + "\nlast"), 2, column}, "no");
    return messages.all().at(0);
}

// What stands above the caret.
std::string above_caret(const Message& message) {
    std::u32string text;
    for (std::size_t at = 0; at < message.excerpt.size();) {
        const CodePoint c = decode_utf8(std::string_view(message.excerpt).substr(at));
        for (int i = 0; i < display_width(c.value); ++i) text += c.value;
        at += c.length;
    }
    std::string result;
    if (message.caret < text.size()) append_utf8(result, text[message.caret]);
    return result;
}

}  // namespace

TEST_CASE("A message shows place, line, caret and the chain of includes", "[messages]") {
    Sources sources;
    const SourceFile& all = sources.add("scenes/all.scene", "\n\ninclude \"dice.scene\"\n");
    const SourceFile& dice = sources.add("scenes/dice.scene", "objects {\n\tspere { radius(2); }\r\n}", {&all, 3, 9});
    Messages messages;
    messages.error({&dice, 2, 2}, "unknown keyword 'spere'; did you mean 'sphere'?");
    CHECK(messages.all().at(0).format() ==
          "scenes/dice.scene:2:2: error: unknown keyword 'spere'; did you mean 'sphere'?\n"
          "    spere { radius(2); }\n"
          "    ^\n"
          "  included from scenes/all.scene:3:9\n");
    messages.warning({&dice, 2, 20}, "too large");
    CHECK(messages.all().at(1).format() ==
          "scenes/dice.scene:2:20: warning: too large\n"
          "    spere { radius(2); }\n"
          "                      ^\n"
          "  included from scenes/all.scene:3:9\n");
}

TEST_CASE("A message may concern a whole file or none", "[messages]") {
    Sources sources;
    Messages messages;
    messages.error({&sources.add("s", "text"), 0, 0}, "too large");
    messages.warning({}, "slow");
    CHECK(messages.all().at(0).format() == "s: error: too large\n");
    CHECK(messages.all().at(1).format() == "warning: slow\n");
}

TEST_CASE("The caret stands under its place, whatever stands before it", "[messages]") {
    Sources sources;
    CHECK(above_caret(message_at(sources, "abcXdef", 4)) == "X");
    CHECK(above_caret(message_at(sources, " \t abcXdef", 7)) == "X");
    CHECK(above_caret(message_at(sources, "a\tb\tX", 5)) == "X");
    CHECK(above_caret(message_at(sources, "äöüX", 7)) == "X");
    CHECK(above_caret(message_at(sources, "日本X", 7)) == "X");
    CHECK(above_caret(message_at(sources, "e\xcc\x81X", 4)) == "X");
    CHECK(above_caret(message_at(sources, "\xff\xfe\x80X", 4)) == "X");
    CHECK(above_caret(message_at(sources, "\x1b[31mX", 6)) == "X");
    // Behind the end of the line, and far behind it.
    CHECK(message_at(sources, "abc", 4).caret == 3);
    CHECK(message_at(sources, "abc", 4000).caret == 3);
}

TEST_CASE("Long lines are shortened around the caret", "[messages]") {
    Sources sources;
    for (const std::size_t before : {0, 10, 49, 50, 51, 99, 100, 1000, 100'000})
        for (const std::size_t after : {0, 10, 60, 100'000}) {
            const std::string line = std::string(before, 'a') + "X" + std::string(after, 'b');
            const Message message = message_at(sources, line, static_cast<std::uint32_t>(before + 1));
            CAPTURE(before, after);
            CHECK(above_caret(message) == "X");
            CHECK(message.excerpt.size() <= 110);
            CHECK((before + after < 100 ? message.excerpt == line : message.excerpt.find("…") != std::string::npos));
        }
    // Nor are characters torn apart.
    std::string line;
    for (int i = 0; i < 1000; ++i) line += "ü";
    const Message message = message_at(sources, line + "X", 2001);
    CHECK(above_caret(message) == "X");
    CHECK(message.excerpt.find("\xEF\xBF\xBD") == std::string::npos);
}

TEST_CASE("Nothing harmful reaches the terminal", "[messages]") {
    Sources sources;
    Messages messages;
    std::string all;
    for (int c = 1; c < 256; ++c)
        if (c != '\n') all += static_cast<char>(c);
    all += "\u202E\u200B\u2028";
    messages.error({&sources.add("s" + all, all), 1, 1}, "what\n" + all);
    const std::string text = messages.all().at(0).format();
    for (std::size_t at = 0; at < text.size();) {
        const CodePoint c = decode_utf8(std::string_view(text).substr(at));
        REQUIRE(c.valid);
        REQUIRE((c.value == '\n' || harmless(c) == c.value || c.value == replacement_character));
        at += c.length;
    }
    CHECK(messages.all().at(0).headline().find('\n') == std::string::npos);
    messages.error({}, std::string(1'000'000, 'a'));
    CHECK(messages.all().at(1).text.size() < 3000);
}

TEST_CASE("UTF-8 is decoded as Unicode defines it", "[messages]") {
    const auto value = [](std::string_view text) { return decode_utf8(text).value; };
    CHECK(value("A") == U'A');
    CHECK(value("ü") == U'ü');
    CHECK(value("€") == U'€');
    CHECK(value("😀") == U'😀');
    for (const std::string_view bad :
         {"\xC0\xAF", "\xE0\x80\x80", "\xED\xA0\x80", "\xF4\x90\x80\x80", "\x80", "\xE2\x82", "\xF8"}) {
        CHECK_FALSE(decode_utf8(bad).valid);
        CHECK(decode_utf8(bad).length == 1);
    }
    for (char32_t c = 1; c <= 0x10FFFF; c += c < 0x3000 ? 1 : 97) {
        if (c >= 0xD800 && c <= 0xDFFF) continue;
        std::string text;
        append_utf8(text, c);
        if (decode_utf8(text).value != c || decode_utf8(text).length != text.size())
            FAIL("U+" << std::hex << static_cast<unsigned>(c));
    }
}

TEST_CASE("Thousands of messages stay readable", "[messages]") {
    Messages messages(3);
    std::vector<std::string> heard;
    messages.listen([&](const Message& message) { heard.push_back(message.headline()); });
    for (int i = 0; i < 5; ++i) messages.error({}, "e" + std::to_string(i));
    CHECK_FALSE(messages.wants_errors());
    messages.warning({}, "w");
    CHECK(messages.errors() == 5);
    CHECK(messages.warnings() == 1);
    CHECK(messages.all().back().headline() == "error: … and 2 more errors");

    messages.finish();
    CHECK(heard == std::vector<std::string>{"error: e0", "error: e1", "error: e2", "warning: w", "error: … and 2 more errors"});
    for (int i = 0; i < 3; ++i) messages.warning({}, "w");
    CHECK(messages.all().back().text == "… and 2 more errors and 1 more warning");
    CHECK(Messages().all().empty());
}

TEST_CASE("What was said of a place is not said again", "[messages]") {
    Sources sources;
    const SourceFile &a = sources.add("a", "text"), &b = sources.add("b", "text");
    Messages messages;
    for (int round = 0; round < 3; ++round) {
        messages.error({&a, 1, 1}, "no");
        messages.error({&a, 1, 2}, "no");
        messages.error({&b, 1, 1}, "no");
        messages.error({&a, 1, 1}, "never");
        messages.warning({&a, 1, 1}, "no");
    }
    CHECK(messages.errors() == 4);
    CHECK(messages.warnings() == 1);
    CHECK(messages.all().size() == 5);
}

TEST_CASE("Suggestions are the nearest names", "[messages]") {
    const std::vector<std::string> shapes{"sphere", "cube", "cylinder", "plane", "cone", "torus", "spheres"};
    using Names = std::vector<std::string>;
    CHECK(nearest_names("spere", shapes) == Names{"sphere"});
    CHECK(nearest_names("spehre", shapes) == Names{"sphere", "spheres"});
    CHECK(nearest_names("cubes", shapes) == Names{"cube"});
    CHECK(nearest_names("Cube", shapes) == Names{"cube"});
    CHECK(nearest_names("con", shapes) == Names{"cone"});
    CHECK(nearest_names("box", shapes).empty());
    CHECK(nearest_names("", shapes).empty());
    CHECK(nearest_names("x", {"a", "b", ""}).empty());
    CHECK(nearest_names("abc", {"abd", "abe", "abf", "abg", "abd"}) == Names{"abd", "abe", "abf"});
    CHECK(nearest_names(std::string(1'000'000, 'a'), {std::string(1'000'000, 'b')}).empty());

    CHECK(did_you_mean("box", shapes).empty());
    CHECK(did_you_mean("spere", shapes) == "; did you mean 'sphere'?");
    CHECK(did_you_mean("spehre", shapes) == "; did you mean 'sphere' or 'spheres'?");
    CHECK(did_you_mean("abc", {"abd", "abe", "abf"}) == "; did you mean 'abd', 'abe' or 'abf'?");
}

}  // namespace lapidary
