// SPDX-License-Identifier: MIT
//
// Packets against single rays where boxes kept as floats could lose one: rays that graze boxes, from near and far, of worlds
// tiny and huge, along the axes, in packets that are not full.
#include <fmt/format.h>

#include <array>
#include <numbers>
#include <random>

#include "kernel/csg/packet_through_world.h"
#include "kernel/prepare/world.h"
#include "support/catch.h"
#include "support/scenes.h"

using namespace lapidary;

namespace {

constexpr int width = PacketThroughWorld::width;

// Rays in one or two packets of any length, and what becomes of them, against one ray after the other.
class Comparison {
public:
    explicit Comparison(const std::string& scene) : built_(test::build(scene)) {
        for (const std::string& line : built_->headlines()) UNSCOPED_INFO(line);
        REQUIRE(built_->scene);
        Messages messages;
        world_ = prepare_world(*built_->scene, messages);
        packets_ = std::make_unique<PacketThroughWorld>(*world_, statistics_);
        single_ = std::make_unique<RayThroughWorld>(*world_, statistics_);
    }

    const World& world() const { return *world_; }

    // Packets of all lengths.
    void add(const Ray& ray, double distance) {
        if (waiting_.count == 0) length_ = 1 + static_cast<int>(random_() % width);
        distances_[waiting_.count] = distance;
        waiting_.add(ray);
        if (waiting_.count == length_) compare();
    }

    int met = 0, blocked = 0, different = 0;
    int seen_at_once = 0;  // packets of which some rays are blocked, found without asking any object

private:
    void compare() {
        waiting_.fill_up();
        BoundaryPacket boundaries;
        packets_->first_boundaries(waiting_, nullptr, boundaries);
        const std::uint64_t tests_before = statistics_.object_tests;
        const unsigned bits = packets_->blocked(waiting_, distances_);
        seen_at_once += bits != 0 && statistics_.object_tests == tests_before;
        for (int i = 0; i < waiting_.count; ++i) {
            single_->start(waiting_.ray(i));
            const Boundary expected = single_->next(0, Label{});
            const bool is_blocked = single_->is_blocked(distances_[i]);
            const bool same = boundaries.t[i] == expected.t && boundaries.solid[static_cast<std::size_t>(i)] == expected.solid;
            const bool same_shadow = is_blocked == ((bits >> i & 1) != 0);
            different += !same + !same_shadow;
            met += expected.t < infinity;
            blocked += is_blocked;
        }
        waiting_.clear();
    }

    std::unique_ptr<test::BuiltScene> built_;
    std::shared_ptr<const World> world_;
    TraceStatistics statistics_;
    std::unique_ptr<PacketThroughWorld> packets_;
    std::unique_ptr<RayThroughWorld> single_;
    std::mt19937 random_{7};
    RayPacket waiting_;
    Lanes distances_;
    int length_ = 1;
};

// Small solids of several kinds, scattered about a place, all sizes times a scale.
std::string scattered(double scale, const Point& place, int count) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> coordinate(-1, 1);
    std::string text = "camera { } lights { ambient { } } objects {\n";
    for (int i = 0; i < count; ++i) {
        const std::array kinds{"cube { }", "sphere { }", "cylinder { height(1); }",
                               "subtraction { cube { } sphere { radius(1.2); } }"};
        text += fmt::format("union {{ {} transform {{ scale({}); translate({}, {}, {}); }} }}\n", kinds[random() % kinds.size()],
                            0.03 * scale * (1 + random() % 3), place.x + scale * coordinate(random),
                            place.y + scale * coordinate(random), place.z + scale * coordinate(random));
    }
    return text + "}";
}

// Rays at faces, edges and corners of leaves' boxes, in which cubes' faces lie, and past them.
void aim_at_boxes(Comparison& comparison, double scale, double distance, int count) {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> coordinate(-1, 1);
    const std::vector<Leaf>& leaves = comparison.world().leaves;
    for (int k = 0; k < count; ++k) {
        const Leaf& leaf = leaves[random() % leaves.size()];
        const Bounds local = leaf.object->bounds();
        const auto pick = [&](double low, double high) {
            const std::array<double, 4> places{low, high, 0.5 * (low + high),
                                               low + (high - low) * 0.5 * (1 + coordinate(random))};
            return places[random() % places.size()];
        };
        const Point target = leaf.placement.to_parent(
            Point{pick(local.low.x, local.high.x), pick(local.low.y, local.high.y), pick(local.low.z, local.high.z)});
        Vector direction{coordinate(random), coordinate(random), coordinate(random)};
        // Many along an axis or in a plane of two.
        if (random() % 3 == 0) direction.x = 0;
        if (random() % 3 == 0) direction.y = random() % 2 == 0 ? 0.0 : -0.0;
        if (random() % 3 == 0) direction.z = random() % 4 == 0 ? 1e-300 : 0;
        direction = normalize(direction);
        if (direction == Vector{}) direction = {0, 0, 1};
        const double away = scale * distance * (random() % 8 == 0 ? 0 : 1);
        comparison.add({target - away * direction, direction, {}, {}}, away + scale * coordinate(random));
    }
}

// Balls and ellipsoids, some turned, some in two solids, some cut.
std::string rounded(double scale, const Point& place, int count) {
    std::mt19937 random(13);
    std::uniform_real_distribution<double> coordinate(-1, 1);
    std::string text = "camera { } lights { ambient { } } objects {\n";
    for (int i = 0; i < count; ++i) {
        const std::array solids{"sphere { }",
                                "sphere { } sphere { }",
                                "sphere { transform { scale(1, 1.5, 0.7); } }",
                                "sphere { transform { scale(1, 1.5, 0.7); rotz(35deg); rotx(50deg); } }",
                                "intersection { cube { } sphere { radius(1.3); } }",
                                "subtraction { sphere { } sphere { radius(0.8); transform { translate(0.5, 0, 0); } } }"};
        text += fmt::format("union {{ {} transform {{ roty({}deg); scale({}); translate({}, {}, {}); }} }}\n",
                            solids[random() % solids.size()], 90 * coordinate(random), 0.03 * scale * (1 + random() % 3),
                            place.x + scale * coordinate(random), place.y + scale * coordinate(random),
                            place.z + scale * coordinate(random));
    }
    return text + "}";
}

// Rays that run through balls, or past them, most by so much that it is certain, and end at all kinds of places on their way.
void pass_balls(Comparison& comparison, double scale, double distance, int count) {
    std::mt19937 random(29);
    std::uniform_real_distribution<double> coordinate(-1, 1);
    const std::vector<Leaf>& leaves = comparison.world().leaves;
    for (int k = 0; k < count; ++k) {
        const Leaf& leaf = leaves[random() % leaves.size()];
        const double radius = comparison.world().inner_radius(leaf), furthest = std::max(scale * distance, 2 * radius);
        const Vector direction = normalize(Vector{coordinate(random), coordinate(random), coordinate(random)});
        const Vector across = normalize(cross(direction, Vector{coordinate(random), coordinate(random), coordinate(random)}));
        const double beside = std::array{1e-11, 1e-9, 1e-6, 1e-3, 0.1, 0.9}[random() % 6];
        const double out = radius * (random() % 3 == 0 ? 1 + beside : 1 - beside);
        const double half = std::max(1e-3 * radius, std::sqrt(std::max(0.0, (radius - out) * (radius + out))));
        // Seldom where the ball is entered, at its middle or where it is left: else far before or behind.
        const double off = 1 + std::array{1e-15, 1e-9, 1e-3}[random() % 3] * coordinate(random);
        const double at_ball = off * half * std::array{-1.0, 0.0, 1.0}[random() % 3];
        const bool begins_at_ball = random() % 16 == 0, ends_at_ball = random() % 16 == 0;
        const double begin = begins_at_ball ? at_ball : -furthest;
        const double far_end = random() % 4 == 0 ? begin + 0.5 * (furthest - radius) : furthest;
        const double end = ends_at_ball ? at_ball : far_end;
        comparison.add({leaf.anchor() + out * across + begin * direction, direction, {}, {}}, std::max(end - begin, 0.0));
    }
}

// Packets of rays that graze one ball each, some by less than rounding, from before it, from within or from behind.
void graze_balls(Comparison& comparison, double scale, double distance, int count) {
    std::mt19937 random(17);
    std::uniform_real_distribution<double> coordinate(-1, 1);
    const std::vector<Leaf>& leaves = comparison.world().leaves;
    for (int k = 0; k < count; ++k) {
        const Leaf& leaf = leaves[random() % leaves.size()];
        for (int i = 0; i < width; ++i) {
            const Vector beside = normalize(Vector{coordinate(random), coordinate(random), coordinate(random)});
            const Vector local = cross(beside, Vector{coordinate(random), coordinate(random), coordinate(random)});
            const double out =
                1 + std::array{0.0, 1e-16, 1e-14, 1e-12, 1e-9, 1e-3, 0.5}[random() % 7] * (random() % 4 == 0 ? -1 : 1);
            const Surface sphere = comparison.world().faces_of(leaf).empty() ? Surface{} : comparison.world().faces_of(leaf)[0];
            const double radius = sphere.kind == Surface::Kind::sphere ? sphere.a : 1;
            const Point touched = leaf.placement.to_parent(to_point(radius * out * beside));
            const Vector direction = normalize(leaf.placement.to_parent(local));
            const double away = scale * distance * std::array{1.0, 1e-3, 0.0, -1e-3, -1.0}[random() % 5];
            comparison.add({touched - away * direction, direction, {}, {}}, std::fabs(away) * (1 + coordinate(random)));
        }
    }
}

// Cubes without their corners, each with a large ball taken out of it.
constexpr double trimmed_to = 1.3, radius_of_hole = 2.4;
constexpr Vector middle_of_hole{2.2, 0.3, 0};
std::string hollowed(double scale, const Point& place, int count) {
    std::mt19937 random(19);
    std::uniform_real_distribution<double> coordinate(-1, 1);
    std::string text = "camera { } lights { ambient { } } objects {\n";
    for (int i = 0; i < count; ++i)
        text += fmt::format(
            "subtraction {{ intersection {{ cube {{ }} sphere {{ radius({}); }} }}"
            " sphere {{ radius({}); transform {{ translate({}, {}, {}); }} }}"
            " transform {{ roty({}deg); scale({}); translate({}, {}, {}); }} }}\n",
            trimmed_to, radius_of_hole, middle_of_hole.x, middle_of_hole.y, middle_of_hole.z, 90 * coordinate(random),
            0.03 * scale, place.x + scale * coordinate(random), place.y + scale * coordinate(random),
            place.z + scale * coordinate(random));
    return text + "}";
}

// Rays into a trimmed cube right beside the rims where a face ends at the ball that it is cut with, or at the hole: what they run
// through then lies in that ball but for next to nothing, or not quite.
void pass_rims(Comparison& comparison, double scale, double distance, int count) {
    std::mt19937 random(23);
    std::uniform_real_distribution<double> coordinate(-1, 1);
    for (int k = 0; k < count; ++k) {
        const Solid& solid = comparison.world().solids[random() % comparison.world().solids.size()];
        const Transform& placement = comparison.world().leaves[static_cast<std::size_t>(solid.first_leaf)].placement;
        const bool at_hole = k % 2 == 0;
        for (int i = 0; i < width; ++i) {
            // On the left face the rim is a circle; on the upper one, that of the hole runs along z.
            const double angle = std::numbers::pi * coordinate(random), across = std::sqrt(trimmed_to * trimmed_to - 1),
                         z = coordinate(random) / 2;
            const double high = 1 - middle_of_hole.y, squared = radius_of_hole * radius_of_hole - high * high - z * z;
            const Vector rim = at_hole ? Vector{middle_of_hole.x - std::sqrt(squared), 1, z}
                                       : Vector{-1, across * std::cos(angle), across * std::sin(angle)};
            const Vector middle = at_hole ? middle_of_hole : Vector{};
            const double out = std::array{0.0, 1e-16, 1e-14, 1e-12, 1e-9, 1e-5}[random() % 6] * (random() % 3 == 0 ? 1 : -1);
            const Vector begin = middle + (1 + out) * (rim - middle);
            const Vector end = at_hole ? Vector{0.5 + 0.3 * coordinate(random), -0.9, 0.3 * coordinate(random)}
                                       : Vector{-0.5, 0.5 * coordinate(random), 0.5 * coordinate(random)};
            const Point touched = placement.to_parent(to_point(begin));
            const Vector direction = normalize(placement.to_parent(end - begin));
            const double away = scale * distance * std::array{1.0, 1e-3, 0.0, -1e-3}[random() % 4];
            comparison.add({touched - away * direction, direction, {}, {}}, std::fabs(away) * (1 + coordinate(random)));
        }
    }
}

}  // namespace

TEST_CASE("packets take no more for what lies in a ball: scales and distances", "[packets]") {
    for (const double scale : {1.0, 1e-6, 1e6, 1e-25, 1e20, 1e-90, 1e90})
        for (const double offset : {0.0, 1e3})
            for (const double distance : {0.1, 10.0, 1e6}) {
                CAPTURE(scale, offset, distance);
                Comparison comparison(hollowed(scale, {offset * scale, -offset * scale, 3 * offset * scale}, 10));
                const bool fits_floats = scale > 1e-30 && scale < 1e30;  // else boxes say nothing about sizes
                for (const Solid& solid : comparison.world().solids) REQUIRE((solid.hole >= 0) == fits_floats);
                pass_rims(comparison, scale, distance, 60);
                CHECK(comparison.met > 100);
                CHECK(comparison.blocked > 20);
                CHECK(comparison.different == 0);
            }
}

TEST_CASE("packets lose no ball: scales and distances", "[packets]") {
    for (const double scale : {1.0, 1e-6, 1e6, 1e-25, 1e20, 1e-90, 1e90})
        for (const double offset : {0.0, 1e3})
            for (const double distance : {0.1, 10.0, 1e6}) {
                CAPTURE(scale, offset, distance);
                Comparison comparison(rounded(scale, {offset * scale, -offset * scale, 3 * offset * scale}, 40));
                graze_balls(comparison, scale, distance, 60);
                CHECK(comparison.met > 100);
                CHECK(comparison.blocked > 20);
                CHECK(comparison.different == 0);
            }
}

TEST_CASE("packets of shadow rays know balls in their way: scales and distances", "[packets]") {
    for (const double scale : {1.0, 1e-6, 1e6, 1e-25, 1e20, 1e-90, 1e90})
        for (const double offset : {0.0, 1e3})
            for (const double distance : {0.1, 10.0, 1e6}) {
                CAPTURE(scale, offset, distance);
                std::mt19937 random(31);
                std::uniform_real_distribution<double> coordinate(-1, 1);
                std::string text = "camera { } lights { ambient { } } objects {\n";
                for (int i = 0; i < 5; ++i)
                    text += fmt::format("sphere {{ radius({}); transform {{ rotx(20deg); translate({}, {}, {}); }} }}\n",
                                        0.03 * scale * (1 + random() % 3), scale * (offset + coordinate(random)),
                                        scale * (coordinate(random) - offset), scale * (3 * offset + coordinate(random)));
                Comparison comparison(text + "}");
                pass_balls(comparison, scale, distance, 4000);
                CHECK(comparison.blocked > 1000);
                const bool fits_floats = scale > 1e-30 && scale < 1e30;                  // else radii are not known
                if (fits_floats && distance < 1e3) CHECK(comparison.seen_at_once > 20);  // from further away rounding says less
                CHECK(comparison.different == 0);
            }
}

TEST_CASE("packets lose no box: scales and distances", "[packets]") {
    for (const double scale : {1.0, 1e-6, 1e6, 1e-25, 1e20})
        for (const double offset : {0.0, 1e3})
            for (const double distance : {0.5, 10.0, 1e3, 1e6, 1e9}) {
                CAPTURE(scale, offset, distance);
                Comparison comparison(scattered(scale, {offset * scale, -offset * scale, 3 * offset * scale}, 60));
                aim_at_boxes(comparison, scale, distance, 400);
                CHECK(comparison.met > 100);
                CHECK(comparison.blocked > 20);
                CHECK(comparison.different == 0);
            }
}

TEST_CASE("packets lose no negative leaf: one to many of them", "[packets]") {
    for (const int count : {1, 2, 3, 8, 9, 30, 100, 700}) {
        CAPTURE(count);
        std::mt19937 random(5);
        std::uniform_real_distribution<double> coordinate(-1, 1);
        std::string text = "camera { } lights { ambient { } } objects { subtraction { cube { }";
        for (int i = 0; i < count; ++i)
            text += fmt::format(" {} {{ transform {{ scale({}); translate({}, {}, {}); }} }}", i % 2 == 0 ? "sphere" : "cube",
                                0.5 / std::cbrt(count), coordinate(random), coordinate(random), coordinate(random));
        Comparison comparison(text + " } }");
        aim_at_boxes(comparison, 1, 4, 1500);
        CHECK(comparison.met > 300);
        CHECK(comparison.different == 0);
    }
}
