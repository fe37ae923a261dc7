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

}  // namespace
}  // namespace lapidary
