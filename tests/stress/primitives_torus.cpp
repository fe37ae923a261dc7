// SPDX-License-Identifier: MIT
//
// Lines and tori, T16 to T20: counts and places of crossings against the quartic in 200-bit arithmetic.

#include <algorithm>
#include <cmath>

#include "kernel/math/roots.h"
#include "stress/exact.h"
#include "support/catch.h"

namespace lapidary::test {
namespace {

// (sqrt(x^2 + z^2) - R)^2 + y^2 - r^2 at a place of the line: negative within the outer skin.
Exact skin(const LocalLine& line, double major, double minor, const Exact& t) {
    const ExactVector p = at(line.closest, line.direction, t);
    const Exact beyond = sqrt(p.x * p.x + p.z * p.z) - major;
    return beyond * beyond + p.y * p.y - Exact(minor) * minor;
}

// The crossings of the outer skin: the sign changes of the quartic, which has the inner skin of a self-covering torus,
// too, at which the skin's own sign changes.
std::vector<Exact> crossings(const LocalLine& line, double major, double minor) {
    const double reach = 2 * (major + minor) / length(line.direction);
    const auto roots = sign_changes(torus_polynomial(line.closest, line.direction, major, minor), -reach, reach);
    std::vector<Exact> outer;
    for (std::size_t i = 0; i < roots.size(); ++i) {
        const Exact before = i == 0 ? Exact(-reach) : (roots[i - 1] + roots[i]) / 2;
        const Exact after = i + 1 == roots.size() ? Exact(reach) : (roots[i] + roots[i + 1]) / 2;
        if ((skin(line, major, minor, before) < 0) != (skin(line, major, minor, after) < 0)) outer.push_back(roots[i]);
    }
    return outer;
}

struct Outcome {
    int wrong = 0, hits = 0;
    double worst = 0;  // how far ends are off across the surface, in units of u (R + r)
};

void compare(const LocalLine& line, double major, double minor, Outcome& outcome) {
    Span spans[2];
    const int count = torus_spans(line, major, minor, spans);
    const auto truth = crossings(line, major, minor);
    if (truth.size() != 2 * static_cast<std::size_t>(count)) {
        ++outcome.wrong;
        return;
    }
    for (int i = 0; i < 2 * count; ++i) {
        const double t = i % 2 ? spans[i / 2].out : spans[i / 2].in;
        const ExactVector p = at(line.closest, line.direction, truth[i]);
        const Exact rho = sqrt(p.x * p.x + p.z * p.z), outward = (rho - major) / rho;
        const ExactVector normal{p.x * outward, p.y, p.z * outward};
        const Exact across = abs(dot(normal, ExactVector(line.direction))) / minor;
        outcome.worst = std::max(outcome.worst, static_cast<double>(abs(Exact(t) - truth[i]) * across / (major + minor)) / u);
        ++outcome.hits;
    }
}

}  // namespace

TEST_CASE("T16: through a torus along its equator") {
    Span spans[2];
    REQUIRE(torus_spans({{0, 0, 0}, {1, 0, 0}}, 1, 0.25, spans) == 2);
    CHECK(std::fabs(spans[0].in + 1.25) <= 4 * u);
    CHECK(std::fabs(spans[0].out + 0.75) <= 4 * u);
    CHECK(std::fabs(spans[1].in - 0.75) <= 4 * u);
    CHECK(std::fabs(spans[1].out - 1.25) <= 4 * u);
}

TEST_CASE("Random lines through tori of all proportions and sizes") {
    struct Case {
        double major, minor;
    };
    Random random(16);
    for (const Case& c : {Case{1, 0.25}, Case{1, 0.9}, Case{1, 1e-4}, Case{3e7, 1e6}, Case{2e-9, 1e-9}, Case{1, 1}, Case{0.5, 1},
                          Case{1e-3, 1}, Case{0.999, 1}, Case{1e150, 1e149}, Case{3e-151, 1e-151}}) {
        CAPTURE(c.major, c.minor);
        const double size = c.major + c.minor;
        Outcome outcome;
        for (int i = 0; i < 100; ++i) {
            // Through or just past a random place of the tube, so that thin rings are met.
            const double turn = random.uniform(-3.2, 3.2), part = random.uniform(-3.2, 3.2);
            const double depth = random.uniform(0, 1.1) * c.minor / size;
            const double rho = c.major / size + depth * std::cos(part);
            const Point place{rho * std::cos(turn), depth * std::sin(part), rho * std::sin(turn)};
            const LocalLine line = recentre(place, random.direction()).line;
            compare({to_point(size * to_vector(line.closest)), size * line.direction}, c.major, c.minor, outcome);
        }
        CHECK(outcome.wrong == 0);
        CHECK(outcome.hits > 100);
        CHECK(outcome.worst <= 8);
    }
}

TEST_CASE("T17: planes that touch a torus at its crown") {
    Random random(17);
    int wrong = 0;
    for (int exponent = -14; exponent <= -6; ++exponent)
        for (double side : {-1.0, 1.0})
            for (int i = 0; i < 50; ++i) {
                const double y = 0.25 * (1 + side * std::pow(10, exponent));
                const double turn = random.uniform(-3, 3), aside = random.uniform(-0.9, 0.9);
                const LocalLine line{{-aside * std::sin(turn), y, aside * std::cos(turn)}, {std::cos(turn), 0, std::sin(turn)}};
                Span spans[2];
                if (torus_spans(line, 1, 0.25, spans) != (side < 0 ? 2 : 0)) ++wrong;
            }
    CHECK(wrong == 0);
}

TEST_CASE("T18: a thin torus from a million away") {
    Random random(18);
    Outcome outcome;
    for (int i = 0; i < 200; ++i) {
        const double turn = random.uniform(-3, 3);
        const Point target{std::cos(turn), random.uniform(-1e-4, 1e-4), std::sin(turn)};
        const Vector d = random.direction();
        compare(recentre(target - 1e6 * d, d).line, 1, 1e-4, outcome);
    }
    CHECK(outcome.wrong == 0);
    CHECK(outcome.worst <= 8);
}

TEST_CASE("T19: through the hole of a torus") {
    Span spans[2];
    CHECK(torus_spans({{0, 0, 0}, {0, 1, 0}}, 1, 0.25, spans) == 0);
    CHECK(torus_spans({{0.75 - 1e-13, 0, 0}, {0, 1, 0}}, 1, 0.25, spans) == 0);
    CHECK(torus_spans({{0.75 + 1e-13, 0, 0}, {0, 1, 0}}, 1, 0.25, spans) == 1);
}

TEST_CASE("T20: a torus that covers itself has no inner skin") {
    Span spans[2];
    // Along the axis of R = 0.5, r = 1: inside for |y| < sqrt(3)/2, through what would be the inner skin.
    REQUIRE(torus_spans({{0, 0, 0}, {0, 1, 0}}, 0.5, 1, spans) == 1);
    CHECK(spans[0].out == Approx(std::sqrt(0.75)).epsilon(1e-15));
    CHECK(spans[0].in == -spans[0].out);
    REQUIRE(torus_spans({{0, 0, 0}, {1, 0, 0}}, 0.5, 1, spans) == 1);
    CHECK(spans[0].out == Approx(1.5).epsilon(1e-15));
    // R = r: the tube meets itself in one point.
    REQUIRE(torus_spans({{0, 0, 0}, {1, 0, 0}}, 1, 1, spans) >= 1);
    CHECK(spans[0].in == Approx(-2).epsilon(1e-15));
    // Across the dimple at the top there are two pieces.
    CHECK(torus_spans({{0, 0.95, 0}, {1, 0, 0}}, 0.5, 1, spans) == 2);
}

}  // namespace lapidary::test
