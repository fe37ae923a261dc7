// SPDX-License-Identifier: MIT
//
// The exact text and place of every message that reading a scene can produce.
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "loaders/scene/load.h"
#include "support/catch.h"

namespace lapidary {

namespace {

using Lines = std::vector<std::string>;

Lines headlines(const Messages& messages) {
    Lines lines;
    for (const Message& message : messages.all()) lines.push_back(message.headline());
    return lines;
}

Lines said_of(std::string text, std::uint64_t max_items = 1000) {
    Messages messages;
    LoadOptions options;
    options.max_items = max_items;
    load_scene_text("s", std::move(text), options, messages);
    return headlines(messages);
}

// A folder of files that goes when the test ends.
class Folder {
public:
    Folder() {
        std::string name = (std::filesystem::temp_directory_path() / "lapidary-XXXXXX").string();
        REQUIRE(mkdtemp(name.data()));
        path_ = name;
    }
    ~Folder() { std::filesystem::remove_all(path_); }

    void write(const std::string& name, const std::string& text) const {
        std::filesystem::create_directories((path_ / name).parent_path());
        std::ofstream(path_ / name, std::ios::binary) << text;
    }
    std::string operator/(const std::string& name) const { return (path_ / name).string(); }

    // What is said of a file in it, with its own path left out.
    Lines said_of(const std::string& name, std::vector<std::filesystem::path> include_path = {},
                  std::uint64_t max_items = 1000) const {
        Messages messages;
        LoadOptions options;
        options.include_path = std::move(include_path);
        options.max_items = max_items;
        load_scene_file(path_ / name, options, messages);
        return without_folder(headlines(messages));
    }

private:
    Lines without_folder(Lines lines) const {
        const std::string folder = path_.string() + "/";
        for (std::string& line : lines)
            for (std::size_t at; (at = line.find(folder)) != std::string::npos;) line.erase(at, folder.size());
        return lines;
    }

    std::filesystem::path path_;
};

}  // namespace

TEST_CASE("A good scene says nothing", "[language]") {
    CHECK(said_of("").empty());
    CHECK(said_of("// nothing\n/* at\nall */").empty());
    CHECK(said_of("objects { sphere ball { radius(2); } ball; }\nlet a = 3; camera { location(a, a*2, -a); }").empty());
    CHECK(said_of("subtraction { cube {} } with { sphere {} } with { sphere {} }").empty());
    CHECK(said_of("plugins \"own\"; repeat i (0, 3) { sphere { radius(i + 1); } }").empty());
}

TEST_CASE("Comments and strings that are not closed", "[language]") {
    CHECK(said_of("sphere {}\n  /* and\nso on") ==
          Lines{"s:2:3: error: the comment that is opened here is not closed: '*/' is missing before the end of the file"});
    CHECK(said_of("output { name(\"picture); }\n}") ==
          Lines{"s:1:15: error: the string that is opened here is not closed: '\"' is missing before the end of the line"});
}

TEST_CASE("Characters that mean nothing", "[language]") {
    CHECK(said_of("sphere {} ? cube {}") == Lines{"s:1:11: error: the character '?' means nothing here; remove it"});
    CHECK(said_of("# note") ==
          Lines{"s:1:1: error: '#' means nothing here; a comment begins with '//', and a colour is written hex(\"#ff8800\")",
                "s:1:7: warning: missing ';' after 'note': assumed"});
    CHECK(said_of(std::string("\0\0\1", 3)) == Lines{"s:1:1: error: the character U+0000 means nothing here; remove it"});
    CHECK(said_of("\xff\xff sphere {}") == Lines{"s:1:1: error: the byte 0xff is no UTF-8; save the file as UTF-8"});
    CHECK(said_of("\xff\xfes\0") == Lines{"s: error: the file is written in UTF-16; save it as UTF-8"});
    CHECK(said_of("include “a”;") ==
          Lines{"s:1:9: error: the quotation mark '“' means nothing here; strings stand between straight ones: \"…\"",
                "s:1:12: error: expected a file name after 'include', not 'a': include \"file\"",
                "s:1:13: error: the quotation mark '”' means nothing here; strings stand between straight ones: \"…\""});
}

TEST_CASE("Blocks", "[language]") {
    CHECK(
        said_of("objects {\n  sphere {\n") ==
        Lines{
            "s:2:10: error: the block of 'sphere' that is opened here is not closed: '}' is missing before the end of the file"});
    CHECK(said_of("sphere {} }") ==
          Lines{"s:1:11: error: '}' closes no block; remove it, or look for a '{' that is missing above"});
    CHECK(said_of("{ sphere {} }") == Lines{"s:1:1: error: a block needs a keyword before its '{'"});
    CHECK(said_of("{ sphere {") ==
          Lines{"s:1:1: error: a block needs a keyword before its '{'",
                "s:1:1: error: the block that is opened here is not closed: '}' is missing before the end of the file"});
    CHECK(said_of("with { sphere {} }") == Lines{"s:1:1: error: 'with' follows the '}' of a block: keyword { … } with { … }"});
    CHECK(said_of("union {} with cube {}") == Lines{"s:1:15: error: expected '{' after 'with', not 'cube'"});
    CHECK(said_of("sphere {};") == Lines{"s:1:10: warning: this ';' ends nothing: ignored"});
    CHECK(said_of(") sphere {}") == Lines{"s:1:1: error: expected a keyword or a name, not ')'"});
    CHECK(said_of("sphere , { radius(1); } cube {} }") ==
          Lines{"s:1:8: error: expected '(', '{' or ';' after 'sphere', not ','",
                "s:1:33: error: '}' closes no block; remove it, or look for a '{' that is missing above"});
}

TEST_CASE("Statements that lack their end", "[language]") {
    CHECK(said_of("sphere { radius(2) }") == Lines{"s:1:19: warning: missing ';' after 'radius(…)': assumed"});
    CHECK(said_of("sphere { radius(2)\n}") == Lines{"s:1:19: warning: missing ';' after 'radius(…)': assumed"});
    CHECK(said_of("union { ball box }") ==
          Lines{"s:1:13: warning: missing ';' after 'ball': assumed", "s:1:17: warning: missing ';' after 'box': assumed"});
    CHECK(said_of("ball") == Lines{"s:1:5: warning: missing ';' after 'ball': assumed"});
    CHECK(said_of("sphere ball {} ball\ncube box {}") == Lines{"s:1:20: warning: missing ';' after 'ball': assumed"});
    CHECK(said_of("let a = 1 let b = a; camera { focus(b); }") ==
          Lines{"s:1:10: warning: missing ';' after 'let a = …': assumed"});
    CHECK(said_of("plugins \"own\" camera {}") == Lines{"s:1:14: warning: missing ';' after \"own\": assumed"});
}

TEST_CASE("Statements in another language", "[language]") {
    CHECK(said_of("sphere { radius 2; }") == Lines{"s:1:17: error: values stand in parentheses: radius(…);"});
    CHECK(said_of("sphere { radius = 2; }") ==
          Lines{"s:1:10: error: a property is written 'radius(…);', and a constant is defined with 'let radius = …;'"});
    CHECK(said_of("output { name \"a.png\"; }") == Lines{"s:1:15: error: values stand in parentheses: name(…);"});
}

TEST_CASE("Values", "[language]") {
    CHECK(said_of("p(1,,2);") == Lines{"s:1:5: error: a value is missing before ','"});
    CHECK(said_of("p(1,2,);") == Lines{"s:1:7: error: a value is missing before ')'"});
    CHECK(said_of("p(,);") ==
          Lines{"s:1:3: error: a value is missing before ','", "s:1:4: error: a value is missing before ')'"});
    CHECK(said_of("p(1 2 3);") == Lines{"s:1:5: error: expected ',' or ')' before the number 2",
                                        "s:1:7: error: expected ',' or ')' before the number 3"});
    CHECK(said_of("p(a \"b\");") == Lines{"s:1:5: error: expected ',' or ')' before the string \"b\""});
    CHECK(said_of("p(1, 2; q(3);") == Lines{"s:1:7: error: missing ')' after the values of 'p'"});
    CHECK(said_of("p(1, 2\nq(3);") == Lines{"s:1:7: error: missing ')' after the values of 'p'"});
    CHECK(said_of("b { p(1, 2 }") == Lines{"s:1:11: error: missing ')' after the values of 'p'"});
    CHECK(said_of("p(1, *); q(?);") ==
          Lines{"s:1:6: error: expected a number, not '*'", "s:1:12: error: the character '?' means nothing here; remove it"});
    CHECK(said_of("p((1); q(2);") == Lines{"s:1:6: error: missing ')' after the values of 'p'"});
    CHECK(said_of("p({1});") == Lines{"s:1:3: error: expected a number, not '{'"});
}

TEST_CASE("Numbers", "[language]") {
    CHECK(said_of("p(1e999);") == Lines{"s:1:3: error: 1e999 is too large: numbers reach up to 1.79e308"});
    CHECK(said_of("p(-1e999, 1e-999, 0e999999999999999999999);") ==
          Lines{"s:1:4: error: 1e999 is too large: numbers reach up to 1.79e308"});
    CHECK(said_of("p(1e308*10);") == Lines{"s:1:8: error: the result is too large: numbers reach up to 1.79e308"});
    CHECK(said_of("p(1/0, 1/(2-2));") == Lines{"s:1:4: error: division by zero", "s:1:9: error: division by zero"});
    CHECK(said_of("p(sqrt(-1), log(0), pow(-1, .5));") == Lines{"s:1:3: error: sqrt(-1) is no finite number",
                                                                "s:1:13: error: log(0) is no finite number",
                                                                "s:1:21: error: pow(-1, 0.5) is no finite number"});
    CHECK(said_of("p(3cm, 4e, 0x10);") == Lines{"s:1:4: error: unknown unit 'cm'; the units are 'deg' and 'rad'",
                                                "s:1:9: error: unknown unit 'e'; the units are 'deg' and 'rad'",
                                                "s:1:13: error: unknown unit 'x10'; the units are 'deg' and 'rad'"});
    CHECK(said_of("p(45deg rad, (45deg)deg);") ==
          Lines{"s:1:9: error: expected ',' or ')' before 'rad'", "s:1:21: error: this is an angle already; remove 'deg'"});
    CHECK(said_of("p(1.5.2);") == Lines{"s:1:6: error: expected ',' or ')' before the number .2"});
    CHECK(said_of("p(" + std::string(300, '(') + "1" + std::string(300, ')') + "); q(2);") ==
          Lines{"s:1:203: error: parentheses stand more than 200 deep; name parts of the expression with 'let'"});
}

TEST_CASE("Functions and constants", "[language]") {
    CHECK(said_of("p(sinus(1), sn(1));") ==
          Lines{"s:1:3: error: unknown function 'sinus'", "s:1:13: error: unknown function 'sn'; did you mean 'sin'?"});
    CHECK(said_of("p(sin(), sin(1, 2), min(1), atan2(1));") ==
          Lines{"s:1:3: error: 'sin' takes 1 number, not 0", "s:1:10: error: 'sin' takes 1 number, not 2",
                "s:1:21: error: 'min' takes at least 2 numbers, not 1", "s:1:29: error: 'atan2' takes 2 numbers, not 1"});
    CHECK(said_of("p(sin + 1);") == Lines{"s:1:3: error: 'sin' is a function; it is written sin(…) with 1 number"});
    CHECK(said_of("p(sin(1);") == Lines{"s:1:9: error: missing ')' after the values of 'p'"});
    CHECK(said_of("p(sin(1 2));") == Lines{"s:1:9: error: expected ',' or ')', not the number 2"});
    CHECK(said_of("p((1 2));") == Lines{"s:1:6: error: expected an operator or ')', not the number 2"});
    CHECK(said_of("let width = 3; p(2*widht, width);") == Lines{"s:1:20: error: 'widht' is not defined; did you mean 'width'?"});
    CHECK(said_of("p(2*x);") == Lines{"s:1:5: error: 'x' is not defined; define it above with 'let x = …;'"});
    CHECK(said_of("let a = 1;\nlet a = 2; p(a);") ==
          Lines{"s:2:5: error: 'a' is defined twice, first at s:1:5; choose another name"});
    CHECK(said_of("let pi = 3; let sin = 3; let deg = 3; let hex = 3;") ==
          Lines{"s:1:5: error: 'pi' is defined already; choose another name",
                "s:1:17: error: 'sin' is a function of the language; choose another name",
                "s:1:30: error: 'deg' is a unit of the language; choose another name",
                "s:1:43: error: 'hex' is a function of the language; choose another name"});
    CHECK(said_of("let a = 1;") == Lines{"s:1:5: warning: 'a' is defined, but not used"});
    CHECK(said_of("let a = 1/0; p(a, a + 1);") == Lines{"s:1:10: error: division by zero"});
    CHECK(said_of("let 3 = a; let; let a 3; let a = \"b\"; let b = ;") ==
          Lines{"s:1:5: error: expected a name after 'let', not the number 3",
                "s:1:15: error: expected a name after 'let', not ';'",
                "s:1:23: error: expected '=' after 'let a', not the number 3",
                "s:1:34: error: 'let' names a number, not a string", "s:1:47: error: expected a number, not ';'"});
}

TEST_CASE("Colours", "[language]") {
    CHECK(said_of("p(srgb(1, 2), srgb(255, 128, 0), srgb(a), srgb(1, 2);") ==
          Lines{"s:1:3: error: 'srgb' takes 3 numbers, not 2",
                "s:1:15: warning: the numbers of 'srgb' run from 0 to 1; parts from 0 to 255 are written hex(\"#rrggbb\")",
                "s:1:39: error: 'a' is not defined; define it above with 'let a = …;'",
                "s:1:34: error: 'srgb' takes 3 numbers, not 1", "s:1:43: error: 'srgb' takes 3 numbers, not 2",
                "s:1:53: error: missing ')' after the values of 'p'"});
    CHECK(said_of("p(hex(\"#ff88\"), hex(\"#gg8800\"), hex(\"\"), hex(ff8800), hex(\"#fff\";") ==
          Lines{"s:1:7: error: a colour is written with three or six hexadecimal digits: hex(\"#f80\") or hex(\"#ff8800\")",
                "s:1:21: error: a colour is written with three or six hexadecimal digits: hex(\"#f80\") or hex(\"#ff8800\")",
                "s:1:37: error: a colour is written with three or six hexadecimal digits: hex(\"#f80\") or hex(\"#ff8800\")",
                "s:1:46: error: 'hex' takes a string: hex(\"#ff8800\"), not 'ff8800'",
                "s:1:65: error: expected ')' after the colour, not ';'"});
    CHECK(said_of("p(2*srgb(1,1,1)); p(1 + hex(\"#fff\"));") ==
          Lines{"s:1:5: error: 'srgb' stands for a colour's three numbers and cannot be part of an expression",
                "s:1:25: error: 'hex' stands for a colour's three numbers and cannot be part of an expression"});
}

TEST_CASE("Loops", "[language]") {
    CHECK(said_of("repeat (0, 1) {}") ==
          Lines{"s:1:8: error: expected the name of a counter, not '(': repeat i (first, last) { … }"});
    CHECK(said_of("repeat i {} sphere {} }") ==
          Lines{"s:1:10: error: expected '(' after the name of the counter, not '{'",
                "s:1:23: error: '}' closes no block; remove it, or look for a '{' that is missing above"});
    CHECK(said_of("repeat i (0) {}") == Lines{"s:1:12: error: expected ',' after the first value of the counter, not ')'"});
    CHECK(said_of("repeat i (0, 1 {}") == Lines{"s:1:16: error: expected ')' after the last value of the counter, not '{'"});
    CHECK(said_of("repeat i (0, 1) sphere {} }") ==
          Lines{"s:1:17: error: expected '{' after the bounds of the loop, not 'sphere'",
                "s:1:27: error: '}' closes no block; remove it, or look for a '{' that is missing above"});
    CHECK(said_of("repeat i (0, 1.5) {}") ==
          Lines{"s:1:14: error: a loop counts in whole numbers, and 1.5 is none; floor(…) makes one"});
    CHECK(said_of("repeat i (0, 1e30) {}") == Lines{"s:1:14: error: a loop cannot count as far as 1e+30"});
    CHECK(said_of("repeat i (0, x) { sphere {} }") ==
          Lines{"s:1:14: error: 'x' is not defined; define it above with 'let x = …;'"});
    CHECK(said_of("repeat i (3, 2) { sphere {} }") ==
          Lines{"s:1:17: warning: the loop from 3 to 2 has no round: what it holds is left out"});
    CHECK(
        said_of("repeat i (0, 3) {\n sphere {}") ==
        Lines{
            "s:1:17: error: the block of 'repeat' that is opened here is not closed: '}' is missing before the end of the file"});
    CHECK(said_of("repeat i (0, 3) { p(1/(i-2)) }") == Lines{"s:1:29: warning: missing ';' after 'p(…)': assumed",
                                                             "s:1:22: error: division by zero (in the round with i = 2)"});
    CHECK(said_of("repeat i (0, 3) { repeat i (0, 3) { p(i); } }") ==
          Lines{"s:1:26: error: 'i' is defined twice, first at s:1:8; choose another name"});
    CHECK(said_of("repeat i (0, 3) { sphere ball {} }") == Lines{"s:1:26: error: 'ball' is defined again in every round of the "
                                                                 "loop; define it above the loop (in the round with i = 1)"});
    CHECK(said_of("repeat i (0, 3) { let a = i; }") == Lines{"s:1:23: warning: 'a' is defined, but not used"});
    CHECK(said_of("repeat i (0, 3) { p(i); } p(i + 1);") == Lines{"s:1:29: error: 'i' is not defined; did you mean 'pi'?"});
}

TEST_CASE("Loops that make too much", "[language]") {
    CHECK(said_of("repeat i (1, 1000) { p(i); }").empty());
    CHECK(
        said_of("repeat i (1, 1001) {}") ==
        Lines{
            "s:1:1: error: the loop over 'i' makes more than 1000 items; make it smaller, or raise the bound with --max-items"});
    CHECK(
        said_of("repeat i (1, 501) { p(i); q(i); }") ==
        Lines{
            "s:1:1: error: the loop over 'i' makes more than 1000 items; make it smaller, or raise the bound with --max-items"});
    CHECK(
        said_of("objects { repeat i (1, 5) {\n repeat j (1, 300) { sphere {} } } }") ==
        Lines{
            "s:2:2: error: the loop over 'j' makes more than 1000 items; make it smaller, or raise the bound with --max-items"});
    CHECK(said_of("repeat i (1, 1e15) { sphere {} }", 10'000'000) ==
          Lines{"s:1:1: error: the loop over 'i' makes more than 10000000 items; make it smaller, or raise the bound with "
                "--max-items"});
}

TEST_CASE("Blocks within blocks within blocks", "[language]") {
    std::string text;
    for (int i = 0; i < 100'000; ++i) text += "union {";
    CHECK(said_of(text) ==
          Lines{"s:1:7001: error: blocks are nested more than 1000 deep; name the inner ones and refer to them",
                "s:1:7007: error: the block that is opened here is not closed: '}' is missing before the end of the file"});
    CHECK(said_of(std::string(100'000, '{')) ==
          Lines{"s:1:1: error: a block needs a keyword before its '{'",
                "s:1:1: error: the block that is opened here is not closed: '}' is missing before the end of the file"});
    CHECK(said_of("p(" + std::string(100'000, '-') + "1);").empty());
}

TEST_CASE("Includes", "[language]") {
    const Folder folder;
    folder.write(
        "scene",
        "include \"lib/balls.inc\" ball; include \"no.inc\"; include 3;\ninclude \"lib\"; include \"/dev/zero\"; include \"\";");
    folder.write("lib/balls.inc", "include \"more.inc\";\nsphere ball { radius(1) }\nlet unused = 1;\n}");
    folder.write("lib/more.inc", "");
    CHECK(folder.said_of("scene", {folder / "lib"}) ==
          Lines{"lib/balls.inc:2:24: warning: missing ';' after 'radius(…)': assumed",
                "lib/balls.inc:4:1: error: '}' closes no block; remove it, or look for a '{' that is missing above",
                "scene:1:39: error: there is no file 'no.inc' to include; looked for 'no.inc', 'lib/no.inc'",
                "scene:1:57: error: expected a file name after 'include', not the number 3: include \"file\"",
                "scene:2:9: error: cannot read 'lib': it is a folder",
                "scene:2:24: error: cannot read '/dev/zero': it is no ordinary file",
                "scene:2:45: error: the name of the file to include is empty"});
    CHECK(folder.said_of("none") == Lines{"error: cannot read 'none': there is no such file"});
    CHECK(folder.said_of("lib") == Lines{"error: cannot read 'lib': it is a folder"});
}

TEST_CASE("Circular includes show their chain", "[language]") {
    const Folder folder;
    folder.write("a", "include \"b\";");
    folder.write("b", "include \"./c\";");
    folder.write("c", "include \"a\";");
    folder.write("self", "include \"self\";");
    CHECK(folder.said_of("a") ==
          Lines{"c:1:9: error: circular include: 'a' includes 'b' includes 'c' includes 'a'; take one of these includes out"});
    CHECK(folder.said_of("self") ==
          Lines{"self:1:9: error: circular include: 'self' includes 'self'; take one of these includes out"});
}

TEST_CASE("Includes that make too much", "[language]") {
    // Every file includes the next one ten times: 10^8 spheres from a kilobyte.
    const Folder folder;
    for (int i = 0; i < 8; ++i) {
        std::string text;
        for (int j = 0; j < 10; ++j) text += "include \"" + std::to_string(i + 1) + "\";\n";
        folder.write(std::to_string(i), text);
    }
    folder.write("8", "sphere {}");
    CHECK(folder.said_of("0", {}, 1000) == Lines{"0:1:1: error: the included file '1' makes more than 1000 items; make it "
                                                 "smaller, or raise the bound with --max-items"});
}

}  // namespace lapidary
