// SPDX-License-Identifier: MIT
//
// Shafts between boxes: no box that a straight way between them meets is lost, and those that no way meets are told apart.
#include "kernel/math/shaft.h"

#include <array>
#include <random>

#include "support/catch.h"

using namespace lapidary;

namespace {

using Corner = std::array<double, 3>;

class Random {
public:
    double number(double low, double high) { return std::uniform_real_distribution<double>(low, high)(engine_); }
    Point point_within(const Bounds& box) {
        // Also on faces, edges and corners.
        const auto coordinate = [this](double low, double high) {
            const double u = number(-0.2, 1.2);
            return u < 0 ? low : u > 1 ? high : low + u * (high - low);
        };
        return {coordinate(box.low.x, box.high.x), coordinate(box.low.y, box.high.y), coordinate(box.low.z, box.high.z)};
    }
    Bounds box(double size, double extent) {
        const Point p{number(-size, size), number(-size, size), number(-size, size)};
        // Flat ones, too.
        const auto half = [&] { return extent * std::fmax(0, number(-0.3, 1)); };
        const Vector h{half(), half(), half()};
        return {p - h, p + h};
    }

private:
    std::mt19937 engine_{17};
};

bool may_meet(const ShaftAmongBoxes& shaft, const Bounds& box, const Point& anchor) {
    const Vector low = box.low - anchor, high = box.high - anchor;
    return shaft.may_meet(Corner{low.x, low.y, low.z}, Corner{high.x, high.y, high.z});
}

}  // namespace

TEST_CASE("A shaft meets every box that a way from one end to the other meets") {
    Random random;
    int lost = 0;
    for (int i = 0; i < 50000; ++i) {
        const double size = std::pow(10, random.number(-9, 9));
        const Bounds from = random.box(size, size * std::pow(10, random.number(-6, 0)));
        const Bounds to = random.box(size, size * std::pow(10, random.number(-6, 0)));
        const Point begin = random.point_within(from), end = random.point_within(to);
        const Point met = begin + random.number(0, 1) * (end - begin);
        const Point anchor{random.number(-size, size), random.number(-size, size), random.number(-size, size)};
        const double half = 1e-15 * size;
        const Bounds box{met - Vector{half, half, half}, met + Vector{half, half, half}};
        lost += !may_meet(ShaftAmongBoxes(from, to, anchor, size), box, anchor);
    }
    CHECK(lost == 0);
}

TEST_CASE("A box is met by a shaft just where it overlaps the box that the shaft fills at some part of the way") {
    Random random;
    int wrong = 0, met = 0, beside = 0;
    for (int i = 0; i < 10000; ++i) {
        const Bounds from = random.box(1, 0.4), to = random.box(1, 0.4), box = random.box(1, 0.4);
        const bool found = may_meet(ShaftAmongBoxes(from, to, {0, 0, 0}, 2), box, {0, 0, 0});
        const auto overlaps_at = [&](double u, double margin) {
            const auto low = [&](double a, double b) { return (1 - u) * a + u * b - margin; };
            const auto high = [&](double a, double b) { return (1 - u) * a + u * b + margin; };
            return box.overlaps({{low(from.low.x, to.low.x), low(from.low.y, to.low.y), low(from.low.z, to.low.z)},
                                 {high(from.high.x, to.high.x), high(from.high.y, to.high.y), high(from.high.z, to.high.z)}});
        };
        // The true answer lies between those for boxes that are as much smaller and larger as they change from step to step.
        constexpr int steps = 200;
        bool surely = false, maybe = false;
        for (int step = 0; step <= steps; ++step) {
            surely = surely || overlaps_at(double(step) / steps, 0);
            maybe = maybe || overlaps_at(double(step) / steps, 4.0 / steps);
        }
        wrong += (surely && !found) || (found && !maybe);
        met += found, beside += !found;
    }
    CHECK(wrong == 0);
    CHECK(met > 300);
    CHECK(beside > 300);
}

TEST_CASE("A shaft meets every ball that a way from one end to the other touches") {
    Random random;
    int lost = 0;
    for (int i = 0; i < 50000; ++i) {
        const double size = std::pow(10, random.number(-120, 120));
        const Bounds from = random.box(size, size * std::pow(10, random.number(-6, 0)));
        const Bounds to = random.box(size, size * std::pow(10, random.number(-6, 0)));
        const Point begin = random.point_within(from), end = random.point_within(to);
        const Point touched = begin + random.number(0, 1) * (end - begin);
        const Point anchor{random.number(-size, size), random.number(-size, size), random.number(-size, size)};
        const double radius = size * std::pow(10, random.number(-9, 6));
        const Vector aside = normalize(Vector{random.number(-1, 1), random.number(-1, 1), random.number(-1, 1)});
        const ShaftAmongBoxes shaft(from, to, anchor, size);
        lost += !shaft.may_meet(Ball::around(touched + radius * aside, radius, anchor)) || !shaft.may_meet(Ball{});
    }
    CHECK(lost == 0);
}

TEST_CASE("Between points, a shaft meets just the balls that are no farther from the line than their radius") {
    Random random;
    int wrong = 0, met = 0, beside = 0;
    for (int i = 0; i < 10000; ++i) {
        const Bounds from = random.box(1, 0), to = random.box(1, 0);
        const Point centre = random.box(1.5, 0).low;
        const double radius = random.number(0, 1);
        const Vector way = to.low - from.low;
        const double part = std::clamp(dot(centre - from.low, way) / dot(way, way), 0.0, 1.0);
        const double distance = length(centre - (from.low + part * way));
        const bool found = ShaftAmongBoxes(from, to, {0, 0, 0}, 2).may_meet(Ball::around(centre, radius, {0, 0, 0}));
        wrong += found ? distance > radius + 1e-9 : distance < radius;
        met += found, beside += !found;
    }
    CHECK(wrong == 0);
    CHECK(met > 500);
    CHECK(beside > 500);
}

TEST_CASE("A shaft tells half-spaces apart by their infinite boxes") {
    const ShaftAmongBoxes level({{-1, 0, -1}, {1, 0, 1}}, {{4, 3, 4}, {4, 3, 4}}, {0, 0, 0}, 10);
    const auto below = [&](double y) {
        return level.may_meet(Corner{-infinity, -infinity, -infinity}, Corner{infinity, y, infinity});
    };
    const auto beyond = [&](double x) {
        return level.may_meet(Corner{x, -infinity, -infinity}, Corner{infinity, infinity, infinity});
    };
    CHECK(below(0));
    CHECK_FALSE(below(-1e-6));
    CHECK(beyond(4));
    CHECK_FALSE(beyond(4.000001));
}
