// SPDX-License-Identifier: MIT
//
// A printed scene is itself a scene, and builds to what was printed: same tree, same numbers to the last bit.
#include <string>

#include "kernel/scene/print.h"
#include "support/catch.h"
#include "support/scenes.h"

namespace lapidary {

namespace {

void check_same(const SceneNode& a, const SceneNode& b) {
    REQUIRE(a.operation == b.operation);
    REQUIRE(a.plugin == b.plugin);
    REQUIRE(a.operands.size() == b.operands.size());
    CHECK(a.priority == b.priority);
    REQUIRE(a.factors.size() == b.factors.size());
    for (std::size_t i = 0; i < a.factors.size(); ++i) {
        CHECK(a.factors[i].kind == b.factors[i].kind);
        CHECK(a.factors[i].values == b.factors[i].values);
        CHECK(a.factors[i].inverted == b.factors[i].inverted);
    }
    REQUIRE(!a.material == !b.material);
    if (a.material) {
        CHECK(a.material->name == b.material->name);
        for (const Point& p : {Point{0.1, 0.2, 0.3}, Point{1.7, -2.3, 0.9}, Point{-4.1, 0.3, 8.8}}) {
            const Matter m = a.material->material->evaluate({p, 0}), n = b.material->material->evaluate({p, 0});
            CHECK(m.colour == n.colour);
            CHECK(m.refraction == n.refraction);
            CHECK(m.shininess == n.shininess);
            CHECK(m.relief == n.relief);
        }
    }
    for (std::size_t i = 0; i < a.operands.size(); ++i) check_same(*a.operands[i], *b.operands[i]);
}

// Prints, builds again with the same registry, compares, and gives the printed text.
std::string check_round_trip(const std::string& text) {
    const auto built = test::build(text);
    INFO(text);
    REQUIRE(built->scene);
    const std::string printed = print_scene(*built->scene);
    INFO(printed);
    Messages messages;
    const Document document = load_scene_text("printed", printed, {}, messages);
    const auto again = build_scene(document, *built->registry, "s", messages);
    REQUIRE(again);
    CHECK(messages.errors() == 0);
    CHECK(print_scene(*again) == printed);
    check_same(*built->scene->root, *again->root);
    return printed;
}

}  // namespace

TEST_CASE("Printed objects build to the same tree", "[print]") {
    check_round_trip(
        "transform turn { rotx(0.1); inverse { roty(123deg); scale(3); } }"
        "sphere ball { radius(0.1); turn; }"
        "objects { ball; subtraction die { cube { size(1,2,1e-7); } } with { ball; turn; priority(-2); } die;"
        "  intersection { cylinder { height(2); } torus { radii(1,0.3); } transform { matrix(1,2,3,0,1,4,0,0,1,5,6,7); } }"
        "  symdiff { ball; merge { cube {} cone {} } } plane {} transform { shear(0.1,0,0,0,0,0); rotate(1,2,3,0.4); } }"
        "lights { ambient {} }");
}

TEST_CASE("Printed materials are the same matter", "[print]") {
    check_round_trip(
        "material wood { checkers { rings { solid { colour(1,0,0); } solid glass { refraction(1.5); } } glass; transform { "
        "scale(0.3); } }"
        "  transform { translate(1,0,0); } }"
        "objects { cube { wood; } cube { material { wood; transform { scale(2); } } } cube { colour(0.1,0.2,0.3); } cube { "
        "shininess(3); }"
        "  cube { material { checkers { value(0.25); colour(1,0,0.5); } } } cube { material { sine { bump(0.5); } } }"
        "  sphere { material { checkers { wood; } with { glass; transform { scale(3); } } } } }"
        "lights { ambient {} }");
}

TEST_CASE("Printed settings are the same settings", "[print]") {
    const std::string printed = check_round_trip(
        "camera { location(1,2,-10); look_at(0.1,0,0); angle(40deg); rays(4); } render { depth(5); cutoff(0.1); error(0.01); }"
        "background(0.1,0.2,0.3); output { resolution(320,200); name(\"x\"); encoding(linear); } objects { cube {} }"
        "point key { location(1,2,3); transform { rotx(1); } } lights { key; spot { angles(10deg,20deg); } direct {} } lights { "
        "key; }");
    CHECK(printed.find("resolution(320, 200);") != std::string::npos);
    CHECK(printed.find("encoding(linear);") != std::string::npos);
    CHECK(printed.find("background(0.1, 0.2, 0.3);") != std::string::npos);
    CHECK(printed.find("angle(0.6981317007977318rad);") != std::string::npos);
}

TEST_CASE("A filter is printed with its reach, where that was given", "[print]") {
    const auto printed = [](const std::string& filter) {
        return check_round_trip("render { " + filter + " } objects { cube {} } lights { ambient {} }");
    };
    CHECK(printed("filter(\"mitchell\", 2.5);").find("filter(\"mitchell\", 2.5);") != std::string::npos);
    CHECK(printed("filter(\"gaussian\");").find("filter(\"gaussian\");") != std::string::npos);
    // The last one counts, with what it does not say.
    CHECK(printed("filter(\"mitchell\", 2.5); filter(\"gaussian\");").find("filter(\"gaussian\");") != std::string::npos);
}

TEST_CASE("Writers are printed with their properties", "[print]") {
    const std::string printed = check_round_trip(
        "output { encoding(linear); png { bits(16); } exr { aov(depth, normal); } } objects { cube {} } lights { ambient {} }");
    CHECK(printed.find("bits(16);") != std::string::npos);
    CHECK(printed.find("aov(depth, normal);") != std::string::npos);
}

TEST_CASE("What is shared is printed once", "[print]") {
    const std::string printed = check_round_trip("objects { union u { torus {} } u; u; } lights { ambient {} }");
    CHECK(printed.find("torus") == printed.rfind("torus"));
}

TEST_CASE("A chain of ten thousand operations prints without deep blocks", "[print]") {
    std::string text = "cube n0 {}\n";
    for (int i = 1; i <= 10'000; ++i) text += "union n" + std::to_string(i) + " { n" + std::to_string(i - 1) + "; sphere {} }\n";
    const auto built = test::build(text + "objects { n10000; } lights { ambient {} }");
    REQUIRE(built->scene);
    Messages messages;
    const Document document = load_scene_text("printed", print_scene(*built->scene), {}, messages);
    CHECK(build_scene(document, *built->registry, "s", messages));
    CHECK(messages.errors() == 0);
}

}  // namespace lapidary
