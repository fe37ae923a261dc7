// SPDX-License-Identifier: MIT
//
// What is known of solids before the first ray: boxes around what is turned, and what a cut swallows or leaves alone.
#include "kernel/prepare/containment.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <tuple>
#include <vector>

#include "kernel/prepare/placed_bounds.h"
#include "kernel/prepare/world.h"
#include "support/catch.h"
#include "support/scenes.h"

namespace lapidary {
namespace {

// An object, of which the beginning is given, somewhere, turned and stretched.
std::string anywhere(const std::string& object, std::mt19937& random) {
    std::uniform_real_distribution<double> angle(0, 360), place(-3, 3), factor(0.5, 1.5);
    return fmt::format("{} transform {{ rotx({}deg); scale({}, {}, {}); roty({}deg); rotz({}deg); translate({}, {}, {}); }} }} ",
                       object, angle(random), factor(random), factor(random), factor(random), angle(random), angle(random),
                       place(random), place(random), place(random));
}

// Its first leaf, and what keeps it alive.
struct Stood {
    std::shared_ptr<const World> world;
    explicit Stood(const std::string& object) {
        const auto built = test::build("lights { ambient { } } objects { " + object + " }");
        for (const std::string& headline : built->headlines()) FAIL_CHECK(headline);
        REQUIRE(built->scene);
        world = prepare_world(*built->scene, built->messages);
        REQUIRE(world->leaves.size() == 1);
    }
    const Leaf& leaf() const { return world->leaves[0]; }
    PlacedObject placed() const { return {*leaf().object, leaf().placement, world->faces_of(leaf())}; }
    Bounds box() const { return placed_bounds(leaf().placement, leaf().object->bounds(), world->faces_of(leaf())); }

    // Points of its boundary in the world, by lines through its box.
    std::vector<Point> boundary(std::mt19937& random, int lines) const {
        const Bounds own = leaf().object->bounds();
        std::uniform_real_distribution<double> part(0, 1);
        const auto within = [&] {
            const Vector diagonal = own.diagonal();
            return own.low + Vector{part(random) * diagonal.x, part(random) * diagonal.y, part(random) * diagonal.z};
        };
        std::vector<Point> points;
        for (int i = 0; i < lines; ++i) {
            const Point a = within(), b = within();
            const Vector direction = (b - a) / length(b - a);
            const Point closest = a - dot(to_vector(a), direction) * direction;
            std::vector<Span> spans(static_cast<std::size_t>(leaf().object->max_spans()));
            const int count = leaf().object->spans({closest, direction}, spans.data());
            for (int k = 0; k < count; ++k)
                for (const double t : {spans[static_cast<std::size_t>(k)].in, spans[static_cast<std::size_t>(k)].out})
                    points.push_back(leaf().placement.to_parent(closest + t * direction));
        }
        return points;
    }
    bool holds(const Point& p) const {
        const Point local = leaf().placement.to_local(p);
        const Vector direction{0, 0, 1};
        std::vector<Span> spans(static_cast<std::size_t>(leaf().object->max_spans()));
        const int count = leaf().object->spans({{local.x, local.y, 0}, direction}, spans.data());
        return std::any_of(spans.begin(), spans.begin() + count,
                           [&](const Span& span) { return span.in <= local.z && local.z < span.out; });
    }
};

TEST_CASE("the box around a round solid that is turned holds it, and fits") {
    std::mt19937 random(5);
    for (const std::string object : {"sphere {", "cylinder { height(2);", "cone {", "cone { radii(0.3, 0.9);", "torus {"})
        for (int i = 0; i < 20; ++i) {
            const std::string text = anywhere(object, random);
            CAPTURE(text);
            const Stood stood(text);
            const Bounds box = stood.box();
            Bounds found;
            for (const Point& p : stood.boundary(random, 3000)) found = unite(found, p);
            const double size = length(box.diagonal());
            for (const auto& [low, low_found, high, high_found] :
                 {std::array{box.low.x, found.low.x, box.high.x, found.high.x},
                  std::array{box.low.y, found.low.y, box.high.y, found.high.y},
                  std::array{box.low.z, found.low.z, box.high.z, found.high.z}}) {
                CHECK(low <= low_found + 1e-14 * size);
                CHECK(high >= high_found - 1e-14 * size);
                // Random lines come near to its ends.
                CHECK(low_found - low < 0.05 * size);
                CHECK(high - high_found < 0.05 * size);
            }
        }
}

TEST_CASE("what lies inside or outside of a solid by its faces does so with all of its points") {
    std::mt19937 random(6);
    int inside = 0, outside = 0, unknown = 0;
    for (int i = 0; i < 600; ++i) {
        const std::vector<std::string> small{"sphere {", "cube {", "cylinder { height(2);", "cone { radii(0.3, 0.9);", "torus {"},
            large{"sphere { radius(4);", "cube { size(6, 7, 8);", "cylinder { radius(3); height(8);", "halfspace {"};
        const std::string what = anywhere(small[static_cast<std::size_t>(i) % small.size()], random);
        const std::string cut = anywhere(large[static_cast<std::size_t>(i) / small.size() % large.size()], random);
        CAPTURE(what, cut);
        const Stood solid(what), other(cut);
        const Containment containment = containment_of(solid.placed(), other.placed());
        std::size_t held = 0;
        const std::vector<Point> points = solid.boundary(random, 200);
        for (const Point& p : points) held += other.holds(p) ? 1 : 0;
        if (containment == Containment::inside) CHECK(held == points.size());
        if (containment == Containment::outside) CHECK(held == 0);
        inside += containment == Containment::inside ? 1 : 0;
        outside += containment == Containment::outside ? 1 : 0;
        unknown += containment == Containment::unknown ? 1 : 0;
    }
    // Each verdict is given often enough to be tested.
    CHECK(inside > 50);
    CHECK(outside > 50);
    CHECK(unknown > 50);
}

TEST_CASE("solids that a cut swallows are left out, and those that it misses are not cut") {
    const auto left = [](const std::string& objects) {
        const auto built = test::build("lights { ambient { } } objects { " + objects + " }");
        REQUIRE(built->scene);
        const auto world = prepare_world(*built->scene, built->messages);
        return std::tuple{world->solids.size(), world->leaves.size(), world->features.shared_surfaces};
    };
    using Left = std::tuple<std::size_t, std::size_t, bool>;
    const std::string turned = "transform { rotx(30deg); roty(40deg); ";
    CHECK(left("subtraction { cube { " + turned + " } } sphere { radius(1.8); } }") == Left{0, 0, false});
    CHECK(left("subtraction { cube { " + turned + " } } sphere { radius(1.7); } }") == Left{1, 2, false});
    // Of the cube, the ball that it is cut with lies inside; of what else is cut out of it nothing is asked.
    CHECK(left("subtraction { subtraction { intersection { cube { } sphere { radius(1.4); } } sphere { radius(0.5); } } "
               "sphere { radius(1.5); } }") == Left{0, 0, false});
    // Half-spaces that are turned have no bounds.
    const std::string three =
        "union { sphere { transform { translate(-3, 0, 0); } } sphere { } "
        "sphere { transform { translate(3, 0, 0); } } }";
    CHECK(left("subtraction { " + three + " halfspace { transform { rotz(80deg); } } }") == Left{2, 3, false});
    // A ball that is taken out of two solids lies on one surface in both; where they stand apart, that does not matter.
    CHECK(left("subtraction { " + three + " sphere { radius(3); } }") == Left{2, 4, false});
    CHECK(left("subtraction { union { cube { } cube { transform { translate(2, 0, 0); } } } sphere { radius(1.3); } }") ==
          Left{2, 4, true});
}

}  // namespace
}  // namespace lapidary
