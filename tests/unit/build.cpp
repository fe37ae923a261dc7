// SPDX-License-Identifier: MIT
//
// What a scene's text becomes: the shape of trees, the order of transforms, what is shared and what is inherited.
#include <fmt/format.h>

#include <set>
#include <string>

#include "kernel/prepare/world.h"
#include "support/catch.h"
#include "support/scenes.h"

namespace lapidary {

namespace {

// The tree as text: the operations' initials, `o` for a leaf, names in front where there are any.
std::string shape_of(const SceneNode& node) {
    constexpr const char* letters[] = {"o", "union", "merge", "minus", "and", "xor"};
    std::string text = (node.name.empty() ? "" : node.name + ":") + letters[static_cast<int>(node.operation)];
    if (node.operation == Operation::leaf) return text;
    text += '(';
    for (const auto& operand : node.operands) text += (text.back() == '(' ? "" : " ") + shape_of(*operand);
    return text + ')';
}

// The only thing in the rendered block.
const SceneNode& only(const Scene& scene) {
    REQUIRE(scene.root->operands.size() == 1);
    return *scene.root->operands.front();
}

std::string shape(const std::string& items) {
    const auto built = test::build("cube a {} cube b {} cube c {} cube d {} objects { " + items + " } lights { ambient {} }");
    INFO(items);
    REQUIRE(built->scene);
    return shape_of(only(*built->scene));
}

Point image(const std::string& transform, const Point& p) {
    const auto built = test::build("objects { cube { " + transform + " } } lights { ambient {} }");
    INFO(transform);
    REQUIRE(built->scene);
    return Transform(only(*built->scene).transform).to_parent(p);
}

void check_near(const Point& a, const Point& b) {
    CHECK(a.x == Approx(b.x).margin(1e-15));
    CHECK(a.y == Approx(b.y).margin(1e-15));
    CHECK(a.z == Approx(b.z).margin(1e-15));
}

}  // namespace

TEST_CASE("Operations take branches, or the items of one block, from left to right", "[build]") {
    CHECK(shape("subtraction { a; } with { b; } with { c; }") == "minus(a:o b:o c:o)");
    CHECK(shape("subtraction { a; b; c; }") == "minus(a:o b:o c:o)");
    CHECK(shape("difference { a; b; }") == "minus(a:o b:o)");
    CHECK(shape("subtraction { a; b; } with { c; d; }") == "minus(union(a:o b:o) union(c:o d:o))");
    CHECK(shape("intersection { a; } with { subtraction { b; c; } }") == "and(a:o minus(b:o c:o))");
    CHECK(shape("symdiff { a; b; c; }") == "xor(a:o b:o c:o)");
    CHECK(shape("merge { a; } with { }") == "merge(a:o union())");
    CHECK(shape("union u { sphere { } merge { a; b; } }") == "u:union(o merge(a:o b:o))");
}

TEST_CASE("A transform in a branch acts on that branch alone", "[build]") {
    const auto built = test::build(
        "objects { subtraction { cube {} } with { cube {} transform { translate(1,0,0); } priority(2); } } lights { ambient {} "
        "}");
    REQUIRE(built->scene);
    const SceneNode& difference = only(*built->scene);
    CHECK(difference.factors.empty());
    CHECK(difference.operands[0]->factors.empty());
    CHECK(shape_of(*difference.operands[1]) == "union(o)");
    REQUIRE(difference.operands[1]->factors.size() == 1);
    CHECK(difference.operands[1]->factors[0].values[0] == 1);
    CHECK(difference.operands[1]->priority == 2.0);
}

TEST_CASE("Transforms act in the order written, wherever they stand", "[build]") {
    check_near(image("transform { translate(1,0,0); scale(2); }", {1, 1, 1}), {4, 2, 2});
    check_near(image("transform { scale(2); translate(1,0,0); }", {1, 1, 1}), {3, 2, 2});
    check_near(image("transform { scale(2); } size(1,1,1); transform { translate(1,0,0); }", {1, 1, 1}), {3, 2, 2});
    // +y toward +z, +z toward +x, +x toward +y.
    check_near(image("transform { rotx(90deg); }", {0, 1, 0}), {0, 0, 1});
    check_near(image("transform { roty(90deg); }", {0, 0, 1}), {1, 0, 0});
    check_near(image("transform { rotz(90deg); }", {1, 0, 0}), {0, 1, 0});
    check_near(image("transform { rotate(0,0,5, 90deg); }", {1, 0, 0}), {0, 1, 0});
    check_near(image("transform { shear(2,3,5,7,11,13); }", {1, 1, 1}), {1 + 2 + 3, 1 + 5 + 7, 1 + 11 + 13});
    check_near(image("transform { matrix(1,2,3, 4,5,6, 7,8,10, 11,12,13); }", {1, 1, 1}), {23, 27, 32});
    // The inverse of a composition is that of the factors, in reverse order.
    check_near(image("transform { inverse { translate(1,0,0); scale(2); } }", {4, 2, 2}), {1, 1, 1});
    check_near(image("transform { inverse { inverse { translate(1,0,0); scale(2); } } }", {1, 1, 1}), {4, 2, 2});
}

TEST_CASE("Named transforms act like the block they name", "[build]") {
    const auto built = test::build(
        "transform t { translate(1,0,0); } objects { cube { t; transform { scale(2); t; inverse { t; } } } } lights { ambient {} "
        "}");
    REQUIRE(built->scene);
    check_near(Transform(only(*built->scene).transform).to_parent(Point{0, 0, 0}), {2, 0, 0});
}

TEST_CASE("A name used several times is one node in memory", "[build]") {
    const auto built = test::build("objects { union a { cube {} } a; subtraction { a; sphere {} } } lights { ambient {} }");
    REQUIRE(built->scene);
    const auto& operands = built->scene->root->operands;
    CHECK(operands[0] == operands[1]);
    CHECK(operands[0] == operands[2]->operands[0]);
}

TEST_CASE("Colour and shininess are short for plain matter", "[build]") {
    const auto built = test::build("objects { cube { colour(0.5,0.25,1); } } lights { ambient {} }");
    REQUIRE(built->scene);
    const auto material = only(*built->scene).material;
    REQUIRE(material);
    const Matter matter = material->material->evaluate({});
    CHECK(matter.colour == Colour{0.5, 0.25, 1});
    CHECK(matter.shininess == 10);
    CHECK(material->material->is_uniform());
    CHECK_FALSE(material->plugin);
}

TEST_CASE("Transforms of textures act on what stands in their block", "[build]") {
    // The cell at the origin is even; doubled in size, it reaches to 2.
    const auto colour_at = [](const std::string& material, const Point& p) {
        const auto built = test::build("objects { cube { material { " + material + " } } } lights { ambient {} }");
        INFO(material);
        REQUIRE(built->scene);
        return only(*built->scene).material->material->evaluate({p, 0}).colour.r;
    };
    CHECK(colour_at("checkers { value(1); value(0); }", {0.5, 0.5, 0.5}) == 1);
    CHECK(colour_at("checkers { value(1); value(0); }", {1.5, 0.5, 0.5}) == 0);
    CHECK(colour_at("checkers { value(1); value(0); transform { scale(2); } }", {1.5, 0.5, 0.5}) == 1);
    CHECK(colour_at("checkers { value(1); value(0); } transform { scale(2); }", {1.5, 0.5, 0.5}) == 1);
    CHECK(colour_at("checkers { value(1); value(0); transform { scale(2); } } transform { translate(2,0,0); }",
                    {1.5, 0.5, 0.5}) == 0);
    // In one of several branches, on that branch alone.
    const std::string inner = "checkers { value(0.25); value(0.75); }";
    CHECK(colour_at("checkers { " + inner + " } with { value(0); }", {0.5, 0.5, 0.5}) == 0.25);
    CHECK(colour_at("checkers { " + inner + " transform { translate(1,0,0); } } with { value(0); }", {0.5, 0.5, 0.5}) == 0.75);
    CHECK(colour_at("checkers { " + inner + " transform { translate(1,0,0); } } with { value(0); }", {1.5, 0.5, 0.5}) == 0);
}

TEST_CASE("Materials are shared by name, whichever way they are named", "[build]") {
    const auto built = test::build(
        "solid red { colour(1,0,0); } material m { red; } "
        "objects { cube { red; } cube { material { red; } } cube { m; } cube { material { m; } } cube { material own { red; } } "
        "cube { own; } }"
        "lights { ambient {} }");
    REQUIRE(built->scene);
    const auto& operands = built->scene->root->operands;
    CHECK(operands[0]->material == operands[1]->material);
    CHECK(operands[2]->material == operands[3]->material);
    CHECK(operands[4]->material == operands[5]->material);
    for (const auto& operand : operands) CHECK(operand->material->material == operands[0]->material->material);
}

TEST_CASE("What is painted alike, one after the other, is of one matter", "[build]") {
    const auto built = test::build(
        "objects { cube { colour(1,0,0); } sphere { colour(1,0,0); } sphere { colour(1,0,0); shininess(3); } sphere { } "
        "cube { colour(1,0,0); shininess(3); } cube { colour(0,1,0); } cube { colour(1,0,0); } } lights { ambient {} }");
    REQUIRE(built->scene);
    const auto& operands = built->scene->root->operands;
    CHECK(operands[0]->material == operands[1]->material);
    CHECK(operands[1]->material != operands[2]->material);
    CHECK(operands[2]->material == operands[4]->material);
    CHECK(operands[4]->material != operands[5]->material);
    CHECK(operands[5]->material != operands[6]->material);
    CHECK_FALSE(operands[3]->material);

    const auto world = prepare_world(*built->scene, built->messages);
    REQUIRE(world->materials.size() == 5);
    for (std::size_t i = 0; i < 5; ++i) CHECK(world->materials[i].number == static_cast<std::int32_t>(i) + 1);
}

TEST_CASE("Objects of the same kind and properties are one in memory, wherever they stand", "[build]") {
    const auto built = test::build(
        "objects { sphere { radius(2); } sphere { colour(1,0,0); radius(2); transform { translate(1,0,0); } } sphere { } "
        "sphere { radius(1); } cylinder { radius(2); } torus { radii(2, 1); } torus { radii(2, 0.5); } "
        "union { sphere { radius(2); } torus { radii(2, 1); } sphere { } } } lights { ambient {} }");
    REQUIRE(built->scene);
    const auto& operands = built->scene->root->operands;
    const auto& inner = operands[7]->operands;
    CHECK(operands[1]->object == operands[0]->object);
    CHECK(inner[0]->object == operands[0]->object);
    CHECK(inner[1]->object == operands[5]->object);
    CHECK(inner[2]->object == operands[2]->object);
    std::set<const Object*> different;
    for (std::size_t i : {0, 2, 4, 5, 6}) different.insert(operands[i]->object.get());
    CHECK(different.size() == 5);
    CHECK(operands[0] != operands[1]);
}

TEST_CASE("An object that is like another one is still complained about", "[build]") {
    const auto built = test::build(
        "objects { sphere { radius(2); radius(1); } sphere { radius(2); radius(1); } sphere { radius(1); radius(2); } "
        "sphere { radius(-1); } sphere { radius(-1); } } lights { ambient {} }");
    REQUIRE(built->scene);
    CHECK(built->headlines().size() == 5);
    const auto& operands = built->scene->root->operands;
    CHECK(operands[0]->object->bounds().high.x == 1);
    CHECK(operands[1]->object->bounds().high.x == 1);
    CHECK(operands[2]->object->bounds().high.x == 2);
    CHECK(operands[3]->object->bounds().high.x == operands[4]->object->bounds().high.x);
}

TEST_CASE("Of thousands of objects each is as it was written, be there many like it or none", "[build]") {
    constexpr int count = 3000, sizes = 700;
    std::string objects;
    for (int i = 0; i < count; ++i) objects += fmt::format("sphere {{ radius({}); }} ", 1 + i * i % sizes);
    const auto built = test::build("objects { " + objects + "} lights { ambient {} }");
    REQUIRE(built->scene);
    const auto& operands = built->scene->root->operands;
    REQUIRE(operands.size() == count);
    for (int i = 0; i < count; ++i) CHECK(operands[static_cast<std::size_t>(i)]->object->bounds().high.x == 1 + i * i % sizes);
}

TEST_CASE("Lights are placed by their own transforms, then by those of their block", "[build]") {
    const auto built = test::build(
        "point key { location(1,0,0); transform { translate(1,0,0); } }"
        "objects { cube {} } lights { key; transform { scale(2); } } lights { key; }");
    REQUIRE(built->scene);
    const auto distance_to_origin = [&](int i) {
        return built->scene->lights.at(static_cast<std::size_t>(i)).light->toward({0, 0, 0}, {}).distance;
    };
    REQUIRE(built->scene->lights.size() == 2);
    CHECK(distance_to_origin(0) == 4);
    CHECK(distance_to_origin(1) == 2);
}

TEST_CASE("The camera's screen follows from its location, look_at or screen", "[build]") {
    const auto camera = [](const std::string& items) {
        const auto built = test::build("camera { " + items + " } objects { cube {} } lights { ambient {} }");
        INFO(items);
        REQUIRE(built->scene);
        return built->scene->camera;
    };
    CHECK(camera("location(1,2,3);").screen_centre == Point{1, 2, 4});
    CHECK(camera("location(1,2,3); look_at(1,12,3);").screen_centre == Point{1, 3, 3});
    CHECK(camera("screen { location(4,5,6); size(2,3); }").screen_centre == Point{4, 5, 6});
    CHECK(camera("screen { size(2,3); }").screen_width == 2.0);
    CHECK(camera("screen { size(2,3); }").screen_height == 3);
    CHECK(camera("screen { size(2,3); }").screen_height_given);
    CHECK_FALSE(camera("").screen_width);
    CHECK_FALSE(camera("").rays);
    CHECK(camera("rays(3); points(2);").rays == 3);
    CHECK(camera("projection(orthographic);").projection == Camera::Projection::orthographic);
}

TEST_CASE("Where there are errors there is no scene", "[build]") {
    const auto built = test::build("objects { cube { size(1); } }");
    CHECK_FALSE(built->scene);
    CHECK(built->messages.errors() == 1);
}

TEST_CASE("References may chain a hundred thousand objects", "[build]") {
    constexpr int levels = 100'000;
    std::string text = "cube n0 {}\n";
    for (int i = 1; i <= levels; ++i)
        text += "subtraction n" + std::to_string(i) + " { n" + std::to_string(i - 1) + "; sphere {} }\n";
    auto built = test::build(text + "objects { n" + std::to_string(levels) + "; } lights { ambient {} }");
    REQUIRE(built->scene);
    int depth = 0;
    for (const SceneNode* node = built->scene->root.get(); !node->operands.empty(); node = node->operands.front().get()) ++depth;
    CHECK(depth == levels + 1);
    built.reset();  // releases the chain without a deep stack
}

TEST_CASE("Textures may be chained a thousand deep, and no more", "[build]") {
    const auto chain = [](int levels) {
        std::string text = "solid n1 {}\n";
        for (int i = 2; i <= levels; ++i)
            text += "checkers n" + std::to_string(i) + " { n" + std::to_string(i - 1) + "; value(1); }\n";
        return test::build(text + "objects { cube { n" + std::to_string(levels) + "; } } lights { ambient {} }");
    };
    CHECK(chain(1000)->scene);
    CHECK(chain(1001)->headlines() ==
          std::vector<std::string>{"s:1001:1: error: textures are nested more than 1000 deep; use fewer levels"});
}

}  // namespace lapidary
