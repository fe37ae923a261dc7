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

}  // namespace
}  // namespace lapidary
