// SPDX-License-Identifier: MIT
//
// What the World keeps of the scene for those who ask what a pixel shows.
#include <fmt/format.h>

#include <random>

#include "kernel/prepare/world.h"
#include "support/catch.h"
#include "support/scenes.h"

namespace lapidary {
namespace {

TEST_CASE("a leaf knows its name, or that of the innermost block around it") {
    const auto built = test::build(R"(
union pair { sphere { } sphere left { } }
solid red { colour(1, 0, 0); }
lights { ambient { } }
objects {
    pair;
    sphere { material { red; } }
}
)");
    for (const std::string& headline : built->headlines()) FAIL_CHECK(headline);
    REQUIRE(built->scene);
    const auto world = prepare_world(*built->scene, built->messages);
    REQUIRE(world->leaves.size() == 3);
    std::vector<std::string> names(3);
    for (const Leaf& leaf : world->leaves) {
        REQUIRE(leaf.source);
        if (const std::string* name = world->name_of(leaf)) names.at(static_cast<std::size_t>(leaf.number - 1)) = *name;
    }
    CHECK(names == std::vector<std::string>{"pair", "left", ""});

    CHECK(world->materials.front().source == nullptr);
    REQUIRE(world->materials.size() == 2);
    REQUIRE(world->materials.back().source);
    CHECK(world->materials.back().source->name == "red");
}

TEST_CASE("leaves that are out of reach are left out, and counted") {
    const auto left_out = [](const std::string& objects) {
        const auto built = test::build("lights { ambient { } } objects { " + objects + " }");
        REQUIRE(built->scene);
        const auto world = prepare_world(*built->scene, built->messages);
        return std::pair{world->leaves.size(), world->leaves_left_out};
    };
    const std::string far = "sphere { transform { translate(9, 0, 0); } }";
    CHECK(left_out("subtraction { cube { } sphere { radius(1.2); } }") == std::pair<std::size_t, std::size_t>{2, 0});
    CHECK(left_out("subtraction { cube { } " + far + " sphere { radius(1.2); } }") == std::pair<std::size_t, std::size_t>{2, 1});
    CHECK(left_out("intersection { cube { } " + far + " } sphere { }") == std::pair<std::size_t, std::size_t>{1, 2});
    // Distributed over the union, the subtrahend stands in one of its parts only.
    CHECK(left_out("subtraction { union { cube { } " + far + " } sphere { radius(1.2); } }") ==
          std::pair<std::size_t, std::size_t>{3, 0});
}

TEST_CASE("solids stand in the order of writing, each with its leaves together, and sheets behind them") {
    const auto built = test::build(R"(lights { ambient { } } objects {
    sphere { }
    plane { transform { translate(0, -1, 0); } }
    union {
        subtraction { cube { } sphere { radius(1.2); } sphere { transform { translate(9, 0, 0); } } }
        intersection { plane { } cube { } }
    }
    subtraction { union { cube { } sphere { transform { translate(1, 0, 0); } } } cylinder { } }
    sphere { }
})");
    for (const std::string& headline : built->headlines()) FAIL_CHECK(headline);
    REQUIRE(built->scene);
    const auto world = prepare_world(*built->scene, built->messages);
    std::vector<std::vector<std::int32_t>> numbers;
    for (const Solid& solid : world->solids) {
        CHECK(solid.first_leaf ==
              (numbers.empty() ? 0 : static_cast<std::int32_t>((&solid - 1)->first_leaf + (&solid - 1)->leaf_count)));
        std::vector<std::int32_t>& of_solid = numbers.emplace_back();
        for (std::int32_t i = 0; i < solid.leaf_count; ++i)
            of_solid.push_back(world->leaves.at(static_cast<std::size_t>(solid.first_leaf + i)).number);
    }
    // Distributed over a union, a subtrahend stands once in each of its parts.
    CHECK(numbers == std::vector<std::vector<std::int32_t>>{{1}, {3, 4}, {8, 10}, {9, 10}, {11}});
    CHECK(world->leaves_left_out == 1);

    REQUIRE(world->sheets.size() == 2);
    const auto number_of = [&](const Sheet& sheet) { return world->leaves.at(static_cast<std::size_t>(sheet.leaf)).number; };
    CHECK(number_of(world->sheets[0]) == 2);
    CHECK(world->sheets[0].order == 1);
    CHECK(number_of(world->sheets[1]) == 6);
    CHECK(world->sheets[1].order == 2);
    REQUIRE(world->clips.size() == 1);
    CHECK(world->leaves.at(static_cast<std::size_t>(world->clips[0].first_leaf)).number == 7);
}

TEST_CASE("materials of one finish share it, and keep their colours and numbers") {
    const auto built = test::build(R"(lights { ambient { } } objects {
    sphere { colour(1, 0, 0); shininess(20); }
    sphere { colour(0, 1, 0); shininess(20); }
    sphere { colour(0, 1, 0); shininess(30); }
    sphere { }
})");
    REQUIRE(built->scene);
    const auto world = prepare_world(*built->scene, built->messages);
    REQUIRE(world->materials.size() == 4);
    CHECK(world->finishes.size() == 2);
    const std::vector<Colour> colours{Colour::white(), {1, 0, 0}, {0, 1, 0}, {0, 1, 0}};
    const std::vector<double> shininess{10, 20, 20, 30};
    for (std::size_t i = 0; i < 4; ++i) {
        CAPTURE(i);
        const MaterialInstance& material = world->materials[i];
        REQUIRE(material.is_uniform());
        CHECK(material.matter().colour == colours[i]);
        CHECK(material.matter().shininess == shininess[i]);
        CHECK(material.number == static_cast<std::int32_t>(i) + 1);
    }
}

TEST_CASE("of thousands of balls, those that stand there twice share their faces, and no others") {
    constexpr int balls = 3000, every = 10;
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> coordinate(-10, 10), radius(0.1, 1);
    std::string objects;
    for (int i = 0; i < balls; ++i) {
        const double x = coordinate(random), y = coordinate(random), z = coordinate(random);
        const std::string ball =
            fmt::format("sphere {{ radius({}); transform {{ translate({},{},{}); }} }} ", radius(random), x, y, z);
        objects += i % every == 0 ? ball + ball : ball;
    }
    const auto built = test::build("lights { ambient { } } objects { " + objects + " }");
    REQUIRE(built->scene);
    const auto world = prepare_world(*built->scene, built->messages);
    REQUIRE(world->leaves.size() == balls + balls / every);
    CHECK(world->surface_classes.size() == balls / every);
    int number = 0;
    const auto surface_class = [&]() -> std::int32_t {
        const Leaf& leaf = world->leaves.at(static_cast<std::size_t>(number++));
        return leaf.first_surface < 0 ? -1 : world->surface_uses.at(static_cast<std::size_t>(leaf.first_surface)).surface_class;
    };
    for (int i = 0; i < balls; ++i) {
        const std::int32_t own = surface_class();
        REQUIRE((own >= 0) == (i % every == 0));
        if (own >= 0) REQUIRE(surface_class() == own);
    }
}

TEST_CASE("a product knows the ball that it lies in") {
    const auto ball_of = [](const std::string& solid) {
        const auto built = test::build("lights { ambient { } } objects { " + solid + " }");
        REQUIRE(built->scene);
        const auto world = prepare_world(*built->scene, built->messages);
        REQUIRE(world->solids.size() == 1);
        const Solid& only = world->solids.front();
        return only.ball < 0 ? -1 : world->leaves[only.first_leaf + only.ball].radius();
    };
    const auto is_about = [](double found, double radius) { return found >= radius && found < 1.00001 * radius; };
    CHECK(is_about(ball_of("sphere { radius(3); }"), 3));
    CHECK(is_about(ball_of("sphere { transform { rotz(30deg); rotx(50deg); scale(2); translate(5, 6, 7); } }"), 2));
    CHECK(is_about(ball_of("intersection { cube { } sphere { radius(1.3); } }"), 1.3));
    CHECK(is_about(ball_of("subtraction { sphere { } sphere { radius(0.5); } }"), 1));
    CHECK(is_about(ball_of("sphere { transform { scale(-2, 2, 2); } }"), 2));
    CHECK(ball_of("sphere { transform { scale(1, 1, 1.0001); } }") == -1);
    CHECK(ball_of("sphere { transform { shear(0.01, 0, 0, 0, 0, 0); } }") == -1);
    CHECK(ball_of("cube { }") == -1);
    CHECK(ball_of("subtraction { cube { } sphere { } }") == -1);
}

TEST_CASE("a product knows a hole that is as large as it") {
    const auto hole_of = [](const std::string& solid) {
        const auto built = test::build("lights { ambient { } } objects { " + solid + " }");
        REQUIRE(built->scene);
        const auto world = prepare_world(*built->scene, built->messages);
        REQUIRE(world->solids.size() == 1);
        const Solid& only = world->solids.front();
        return only.hole < 0 ? -1 : world->inner_radius(world->leaves[only.first_leaf + only.hole]);
    };
    const auto is_about = [](double found, double radius) { return found <= radius && found > 0.99999 * radius; };
    const std::string small = "sphere { radius(0.5); transform { translate(1, 0, 0); } } ";
    CHECK(is_about(hole_of("subtraction { cube { } " + small + "sphere { radius(3); transform { translate(3, 0, 0); } } }"), 3));
    CHECK(is_about(hole_of("subtraction { cube { } sphere { transform { rotz(30deg); scale(-2); translate(2, 0, 0); } } }"), 2));
    CHECK(hole_of("subtraction { cube { } sphere { radius(1.7); transform { translate(1, 0, 0); } } }") == -1);
    CHECK(hole_of("subtraction { cube { } sphere { transform { scale(3, 3, 3.001); translate(3, 0, 0); } } }") == -1);
    CHECK(hole_of("cube { }") == -1);
}

TEST_CASE("a leaf that is neither turned nor scaled represents the surface that it shares") {
    std::mt19937_64 random(5);
    std::uniform_real_distribution<double> angle(-180, 180), scale(0.5, 2), place(-9, 9);
    for (int scene = 0; scene < 20; ++scene) {
        CAPTURE(scene);
        std::string objects;
        for (int post = 0; post < 6; ++post) {
            if (post == scene % 6) objects += "halfspace { transform { translate(0, -2, 0); } } ";
            objects += fmt::format(
                "cylinder {{ height(2); transform {{ translate(0, 1, 0); roty({}deg); scale({}); translate({}, -2, {}); }} }} ",
                angle(random), scale(random), place(random), place(random));
        }
        const auto built = test::build("lights { ambient { } } objects { " + objects + " }");
        REQUIRE(built->scene);
        const auto world = prepare_world(*built->scene, built->messages);
        const Vector up{0, 1, 0};
        const auto shared_floor = [&](const Leaf& leaf) -> const SurfaceUse* {
            for (int face = 0; face < leaf.surface_count; ++face) {
                const SurfaceUse& use = world->surface_uses.at(static_cast<std::size_t>(leaf.first_surface + face));
                if (world->leaves[world->surface_classes[use.surface_class].leaf].placement.has_identity_linear()) return &use;
            }
            return nullptr;
        };
        for (const Leaf& leaf : world->leaves) {
            const SurfaceUse* floor = shared_floor(leaf);
            REQUIRE(floor);
            const SurfaceClass& surface_class = world->surface_classes[floor->surface_class];
            CHECK(surface_class.is(Surface::Kind::plane));
            CHECK(floor->flipped == (leaf.object->bounds().is_finite()));  // posts stand on what the ground fills
            CHECK((surface_class.shifted_by > 0) == (dot(generic_shift, up) > 0));
        }
    }
}

}  // namespace
}  // namespace lapidary
