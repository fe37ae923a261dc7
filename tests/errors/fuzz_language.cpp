// SPDX-License-Identifier: MIT
//
// A seeded, bounded fuzzer: thousands of damaged scenes and plain noise, none of which may crash the loader, make it
// hang, or make it hold more than the scene accounts for. tests/fuzz has the endless one.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <random>
#include <string>
#include <string_view>

#include "kernel/report/printable.h"
#include "loaders/scene/load.h"
#include "support/catch.h"

namespace lapidary {

namespace {

constexpr std::uint64_t max_items = 2'000;

constexpr std::array<std::string_view, 4> scenes{
    "// a die\nlet edge = 2; let r = sqrt(3)*0.8;\nobjects { intersection die { cube { size(edge/2, edge/2, edge/2); } sphere { "
    "radius(r); } }\n"
    "subtraction { die; } with { repeat i (0, 5) { sphere { radius(0.2); transform { translate(i, -1.5e-1, cos(i*60deg)); } } } "
    "} }",
    "camera { location(0, 1, -5); look_at(0, 0, 0); angle(40deg); } lights { ambient { intensity(.1); } point sun { "
    "colour(srgb(1, .9, .8)); } }\n"
    "background(hex(\"#102030\")); output { resolution(320, 240); name(\"a.png\"); exr { aov(depth, normal); } }",
    "/* nested\n loops */ objects { repeat i (1, 4) { repeat j (i, 4) { union { a; } with { b } with { } } } }\nplugins \"own\"; "
    "include \"no.inc\"",
    "torus t { radii(1, max(.25, abs(-1)/8)); material { checkers { solid { colour(1, 0, 0); } solid { } transform { rotx(pi/4) "
    "} } } } t;",
};

// What a parser might stumble over.
constexpr std::array<std::string_view, 36> pieces{
    "{",
    "}",
    "(",
    ")",
    ";",
    ",",
    "\"",
    "/*",
    "*/",
    "//",
    "\n",
    "=",
    "-",
    "*",
    "/",
    "with",
    "let a = ",
    "repeat i (0, 9) {",
    "repeat j (0, 1e9) {",
    "include \"x\"",
    "srgb(",
    "hex(",
    "deg",
    "1e999",
    "0.",
    ".",
    "1/0",
    "pi",
    "sqrt(-1)",
    std::string_view("\0", 1),
    "\xff",
    "\xc3",
    "é",
    "\xe2\x80\xae",
    "#",
    "a",
};

class Damage {
public:
    explicit Damage(unsigned seed) : random_(seed) {}

    std::string scene() {
        std::string text(scenes[below(scenes.size())]);
        for (std::size_t i = 0, n = 1 + below(12); i < n; ++i) damage(text);
        return text;
    }

    std::string noise() {
        std::string text(below(400), ' ');
        for (char& c : text) c = static_cast<char>(below(256));
        return text;
    }

    std::string jumble() {
        std::string text;
        for (std::size_t i = 0, n = below(300); i < n; ++i) (text += pieces[below(pieces.size())]) += below(2) ? " " : "";
        return text;
    }

private:
    std::size_t below(std::size_t n) { return std::uniform_int_distribution<std::size_t>(0, n - 1)(random_); }

    void damage(std::string& text) {
        const std::size_t at = below(text.size() + 1);
        const std::size_t length = std::min(below(20), text.size() - at);
        switch (below(6)) {
            case 0:
                text.erase(at, length);
                break;
            case 1:
                text.insert(at, pieces[below(pieces.size())]);
                break;
            case 2:
                text.insert(below(text.size() + 1), text.substr(at, length));
                break;
            case 3:
                text.replace(at, length, pieces[below(pieces.size())]);
                break;
            case 4:
                text.insert(at, below(50), "{(-}"[below(4)]);
                break;
            default:
                if (at < text.size()) text[at] = static_cast<char>(below(256));
        }
    }

    std::mt19937 random_;
};

std::size_t count(const Items& items) {
    std::size_t n = items.size();
    for (const Item& item : items)
        if (const auto* block = std::get_if<std::unique_ptr<Block>>(&item))
            for (const Branch& branch : (*block)->branches) n += count(branch.items);
    return n;
}

void check(const Place& place) {
    REQUIRE(place.file);
    REQUIRE(place.line >= 1);
    REQUIRE(place.column >= 1);
}

// All that follows relies on: finite numbers, branches with their places, places in a file.
void check(const Items& items) {
    for (const Item& item : items) {
        if (const auto* property = std::get_if<Property>(&item)) {
            check(property->place);
            for (const Value& value : property->values) REQUIRE(std::isfinite(value.number));
        } else if (const auto* block = std::get_if<std::unique_ptr<Block>>(&item)) {
            check((*block)->place);
            REQUIRE_FALSE((*block)->branches.empty());
            for (const Branch& branch : (*block)->branches) {
                check(branch.place);
                check(branch.items);
            }
        }
    }
}

// A crash shows itself; the rest is checked here.
void survive(const std::string& text) {
    INFO(printable(text, 1000));
    Messages messages;
    LoadOptions options;
    options.max_items = max_items;
    const Document document = load_scene_text("fuzz", text, options, messages);
    check(document.items);
    REQUIRE(count(document.items) <= text.size() + max_items);
    for (const Message& message : messages.all()) {
        REQUIRE_FALSE(message.text.empty());
        REQUIRE(message.format().size() < 5000);
    }
}

}  // namespace

TEST_CASE("Damaged scenes do no harm", "[language][fuzz]") {
    Damage damage(20051122);
    for (int i = 0; i < 4000; ++i) survive(damage.scene());
}

TEST_CASE("Noise does no harm", "[language][fuzz]") {
    Damage damage(1);
    for (int i = 0; i < 2000; ++i) survive(damage.noise());
}

TEST_CASE("Jumbled pieces do no harm", "[language][fuzz]") {
    Damage damage(2);
    for (int i = 0; i < 2000; ++i) survive(damage.jumble());
}

TEST_CASE("Long repetitions take time in proportion", "[language][fuzz]") {
    const auto start = std::chrono::steady_clock::now();
    for (const std::string_view piece : pieces) {
        std::string text;
        while (text.size() < 200'000) (text += piece) += ' ';
        survive(text);
        survive("p(" + text);
        survive("p(1" + text);
        survive("let x = " + text);
    }
    // 30 MB; anything that grows with the square of the length would take hours.
    CHECK(std::chrono::steady_clock::now() - start < std::chrono::seconds(120));
}

}  // namespace lapidary
