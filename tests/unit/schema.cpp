// SPDX-License-Identifier: MIT
//
// One declaration of properties: what loading, checking, help and printing read from it.
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "kernel/registry/help.h"
#include "kernel/registry/schema.h"
#include "support/catch.h"

namespace lapidary {
namespace {

struct Coloured {
    Colour colour_{0.25, 0.5, 1};
};

// A thing with a property of every type.
struct Widget : Coloured {
    enum class Mood { calm, wild };

    static void describe(Schema<Widget>& schema) {
        schema.summary("A thing for tests.");
        schema.add("radius", &Widget::radius_).unit(Unit::length).above(0).help("Of the thing.");
        schema.add("radii", &Widget::major_, &Widget::minor_).unit(Unit::length).above(0).arguments("R, r");
        schema.add("location", &Widget::location_).unit(Unit::length);
        schema.add("colour", &Widget::colour_);
        schema.add("angles", &Widget::inner_, &Widget::outer_).unit(Unit::angle).between(0, std::numbers::pi);
        schema.add("octaves", &Widget::octaves_).between(1, 32);
        schema.add("height", &Widget::height_).above(0);
        schema.add("title", &Widget::title_);
        schema.add("mood", &Widget::mood_, {"calm", "wild"});
        schema.add("aov", &Widget::layers_);
        schema.add("colour2", &Widget::colours_);
        schema.child("even", &Widget::even_).help("The first.");
        schema.children("more", &Widget::more_).help("Any number.");
        schema.require("the tube must be thinner than the ring", [](const Widget& w) { return w.minor_ < w.major_; });
        schema.derive([](Widget& w) { w.reach_ = w.major_ + w.minor_; });
    }

    double radius_ = 1, major_ = 1, minor_ = 0.25, reach_ = 0;
    Point location_{1, 2, 3};
    double inner_ = 20 * std::numbers::pi / 180, outer_ = 0.123456789;
    int octaves_ = 6;
    std::optional<double> height_;
    std::string title_ = "none yet";
    Mood mood_ = Mood::wild;
    std::vector<std::string> layers_;
    std::vector<Colour> colours_;
    MaterialPtr even_;
    std::vector<MaterialPtr> more_;
};

const Schema<Widget>& schema() {
    static const Schema<Widget> described;
    return described;
}

const PropertySchema& property(const char* name) {
    const PropertySchema* found = schema().find(name);
    REQUIRE(found);
    return *found;
}

TEST_CASE("a signature says what the parentheses take") {
    CHECK(property("radius").signature() == "(r)");
    CHECK(property("radii").signature() == "(R, r)");
    CHECK(property("location").signature() == "(x, y, z)");
    CHECK(property("colour").signature() == "(r, g, b)");
    CHECK(property("angles").signature() == "(a, b)");
    CHECK(property("octaves").signature() == "(n)");
    CHECK(property("height").signature() == "(h)");
    CHECK(property("title").signature() == "(\"text\")");
    CHECK(property("mood").signature() == "(calm | wild)");
    CHECK(property("aov").signature() == "(word, …)");
}

TEST_CASE("defaults are printed as the scene language writes them") {
    const auto text = [](const char* name) { return schema().default_text(property(name)); };
    CHECK(text("radius") == "1");
    CHECK(text("radii") == "(1, 0.25)");
    CHECK(text("location") == "(1, 2, 3)");
    CHECK(text("colour") == "(0.25, 0.5, 1)");
    CHECK(text("angles") == "(20deg, 0.123456789)");
    CHECK(text("octaves") == "6");
    CHECK(text("height") == "none");
    CHECK(text("title") == "\"none yet\"");
    CHECK(text("mood") == "wild");
    CHECK(text("aov") == "none");
    CHECK(text("colour2") == "none");
}

TEST_CASE("values arrive in the members that are bound") {
    Widget widget;
    property("radii").assign(&widget, {number_value(5), number_value(2)});
    CHECK(widget.major_ == 5);
    CHECK(widget.minor_ == 2);
    property("location").assign(&widget, {number_value(7), number_value(8), number_value(9)});
    CHECK(widget.location_ == Point{7, 8, 9});
    property("colour").assign(&widget, {number_value(0), number_value(0.5), number_value(1)});
    CHECK(widget.colour_ == Colour{0, 0.5, 1});
    property("octaves").assign(&widget, {number_value(3)});
    CHECK(widget.octaves_ == 3);
    property("height").assign(&widget, {number_value(4)});
    CHECK(widget.height_ == 4.0);
    property("title").assign(&widget, {text_value("dice")});
    CHECK(widget.title_ == "dice");
    property("mood").assign(&widget, {word_value("calm")});
    CHECK(widget.mood_ == Widget::Mood::calm);
    property("aov").assign(&widget, {word_value("depth"), word_value("normal")});
    CHECK(widget.layers_ == std::vector<std::string>{"depth", "normal"});
}

TEST_CASE("what is read back is what was assigned") {
    Widget widget;
    CHECK(property("height").read(&widget).empty());
    for (const double red : {0.1, 0.2})
        property("colour2").assign(&widget, {number_value(red), number_value(0), number_value(1)});
    const auto lines = property("colour2").read(&widget);
    REQUIRE(lines.size() == 2);
    CHECK(lines[1][0].number == 0.2);
    property("mood").assign(&widget, {word_value("calm")});
    CHECK(property("mood").read(&widget)[0][0].text == "calm");
}

TEST_CASE("only places, ways and normals are taken into the world") {
    const Transform moved(*ExactTransform::of(TransformFactor{TransformFactor::Kind::translate, {10, 20, 30}, false}));
    Widget widget;
    REQUIRE(property("location").place);
    property("location").place(&widget, moved);
    CHECK(widget.location_ == Point{11, 22, 33});
    CHECK_FALSE(property("radius").place);
    CHECK_FALSE(property("colour").place);
}

TEST_CASE("a condition across properties is a sentence and a test") {
    Widget widget;
    REQUIRE(schema().requirements().size() == 1);
    const Requirement& requirement = schema().requirements()[0];
    CHECK(requirement.sentence == "the tube must be thinner than the ring");
    CHECK(requirement.holds(&widget));
    widget.minor_ = 2;
    CHECK_FALSE(requirement.holds(&widget));
}

TEST_CASE("what follows from properties is derived from the values that they have") {
    Widget widget;
    schema().derive(&widget);
    CHECK(widget.reach_ == 1.25);
    property("radii").assign(&widget, {number_value(5), number_value(2)});
    schema().derive(&widget);
    CHECK(widget.reach_ == 7);
}

TEST_CASE("an unknown property is not found") { CHECK(schema().find("radios") == nullptr); }

TEST_CASE("a range says itself in words") {
    constexpr double inf = std::numeric_limits<double>::infinity();
    CHECK(Range{}.describe().empty());
    CHECK(Range{0, inf, true, false}.describe() == "above 0");
    CHECK(Range{0, inf, false, false}.describe() == "at least 0");
    CHECK(Range{-inf, 1, false, false}.describe() == "at most 1");
    CHECK(Range{-inf, 1, false, true}.describe() == "below 1");
    CHECK(Range{0, 1, false, false}.describe() == "0 to 1");
    CHECK(Range{0, 1, true, false}.describe() == "above 0 and at most 1");
    CHECK(Range{0, 1, true, true}.describe() == "above 0 and below 1");
}

TEST_CASE("clamping lands inside the range, and leaves alone what is there") {
    constexpr double inf = std::numeric_limits<double>::infinity();
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const Range ranges[] = {{},
                            {0, inf, true, false},
                            {0, 1, false, false},
                            {0, 1, true, true},
                            {-5, 1e-9, true, true},
                            {1e20, inf, true, false},
                            {0, 1e-9, true, true}};
    for (const Range& range : ranges)
        for (const double v : {-1e300, -1.0, 0.0, 1e-12, 0.5, 1.0, 3.0, 1e300, nan}) {
            const double clamped = range.clamp(v);
            CAPTURE(range.low, range.high, v, clamped);
            CHECK(range.contains(clamped));
            if (range.contains(v)) CHECK(clamped == v);
        }
    CHECK(Range{0, 1, false, false}.clamp(7) == 1);
    CHECK(Range{0, inf, true, false}.clamp(-1) == 1e-6);
}

TEST_CASE("help shows everything that the schema knows") {
    const std::string help = help_text(schema(), "widget");
    INFO(help);
    CHECK(help.starts_with("widget: A thing for tests.\n"));
    CHECK(help.find("  radius(r)           length, above 0; 1 unless given\n"
                    "                      Of the thing.\n") != std::string::npos);
    CHECK(help.find("  angles(a, b)        angles, 0 to 180deg; (20deg, 0.123456789) unless given\n") != std::string::npos);
    CHECK(help.find("  height(h)           number, above 0; nothing unless given\n") != std::string::npos);
    CHECK(help.find("  mood(calm | wild)   calm or wild; wild unless given\n") != std::string::npos);
    CHECK(help.find("  even     The first.\n  more …   Any number.\n") != std::string::npos);
    CHECK(help.find("Conditions:\n  the tube must be thinner than the ring\n") != std::string::npos);
}

}  // namespace
}  // namespace lapidary
