// SPDX-License-Identifier: MIT
//
// What the World keeps of the scene for those who ask what a pixel shows.
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
        if (leaf.name) names.at(static_cast<std::size_t>(leaf.number - 1)) = *leaf.name;
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

}  // namespace
}  // namespace lapidary
