// SPDX-License-Identifier: MIT
//
// Lines and the standard surfaces at every scale and distance, against 200-bit arithmetic on the same doubles. Bounds are
// in units of the rounding unit u = 2^-53; the names T01 … are those of the project's catalogue of numerical tests.

#include <algorithm>
#include <cmath>

#include "kernel/math/roots.h"
#include "stress/exact.h"
#include "support/catch.h"

namespace lapidary::test {
namespace {

double error(double t, const Exact& truth) { return static_cast<double>(abs(Exact(t) - truth)); }
double relative_error(double t, const Exact& truth) { return static_cast<double>(abs((Exact(t) - truth) / truth)); }

struct AimedRay {
    Point origin;
    Vector direction;
};
// A ray from a distance that passes the origin at about `impact`.
AimedRay aim(Random& random, double distance, double impact) {
    const Vector d = random.direction();
    const Vector across = normalize(cross(d, random.direction()));
    return {to_point(impact * across) - distance * d, d};
}

}  // namespace

TEST_CASE("T01: a unit ball from ten million away") {
    const Recentred r = recentre({-1e7, 0.5, 0}, {1, 0, 0});
    const Span span = ball_span(r.line, 1);
    CHECK(error(r.t(span.in), Exact("9999999.133974596215561353236277")) <= 1.9e-9);
    CHECK(error(r.t(span.out), Exact("10000000.866025403784438646763723")) <= 1.9e-9);
    CHECK(std::fabs(length(r.line.at(span.in)) - 1) <= 4 * u);
}

TEST_CASE("T02, T07: a unit ball from any distance, with directions of any length") {
    Random random(2);
    const double stretch = GENERATE(1.0, 1e-150, 1e150);
    double worst = 0, worst_residual = 0;
    int misses = 0;
    for (int exponent = 1; exponent <= 12; ++exponent) {
        const double distance = std::pow(10, exponent);
        for (int i = 0; i < 300; ++i) {
            const AimedRay ray = aim(random, distance, std::sqrt(random.uniform(0, 1)));
            const Recentred r = recentre(ray.origin, ray.direction);
            // Stretching the direction shortens every t by the same factor.
            const Span stretched = ball_span({r.line.closest, stretch * r.line.direction}, 1);
            const Span span{stretched.in * stretch, stretched.out * stretch};
            const auto roots = quadratic_roots(sphere_polynomial(ray.origin, ray.direction, 1));
            if (roots.empty()) continue;
            const double half = static_cast<double>(roots[1] - roots[0]) / 2;
            if (span.is_empty()) {
                if (half * half > 2e-13) ++misses;
                continue;
            }
            worst = std::max(worst, error(r.t(span.in), roots[0]) * half / (distance * u));
            worst = std::max(worst, error(r.t(span.out), roots[1]) * half / (distance * u));
            worst_residual = std::max(worst_residual, std::fabs(length(r.line.at(span.in)) - 1) / u);
        }
    }
    CHECK(misses == 0);
    CHECK(worst <= 2);
    CHECK(worst_residual <= 6);
}

TEST_CASE("T03: balls and rods of any size down to the smallest numbers and up to the largest") {
    for (double radius : {1e-12, 1e-150, 1e-300, 4e-308, 1e150, 1e300, 8e307}) {
        CAPTURE(radius);
        const Span span = ball_span({{0, 0, 0}, {0, 0, 1}}, radius);
        CHECK(span.in < span.out);
        CHECK(std::fabs(span.out / radius - 1) <= 2 * u);
        CHECK(ball_span({{0.5 * radius, 0, 0}, {0, 0, 1}}, radius).out / radius == Approx(std::sqrt(0.75)).epsilon(1e-15));
        CHECK(ball_span({{radius, 0, 0}, {0, 0, 1}}, radius).is_empty());
        CHECK(ball_span({{0, -1.5 * radius, 0}, {0, 0, 1}}, radius).is_empty());
        CHECK(tube_span({{0.5 * radius, 0, 0}, {0, 0, 1}}, radius).out / radius == Approx(std::sqrt(0.75)).epsilon(1e-15));
    }
}

TEST_CASE("T04: the horizon of a planet") {
    const double radius = 6371000, eye = radius + 2;
    const double dip = std::acos(radius / eye);
    for (double delta : {-1e-9, 1e-9}) {
        const Point origin{0, eye, 0};
        const Vector direction{std::cos(dip + delta), -std::sin(dip + delta), 0};
        const Recentred r = recentre(origin, direction);
        const auto roots = quadratic_roots(sphere_polynomial(origin, direction, radius));
        const Span span = ball_span(r.line, radius);
        CAPTURE(delta);
        CHECK(span.is_empty() == roots.empty());
        CHECK(span.is_empty() == (delta < 0));
        if (span.is_empty()) continue;
        const double cosine = static_cast<double>(roots[1] - roots[0]) / 2 / radius;
        CHECK(error(r.t(span.in), roots[0]) <= 2 * u * radius / cosine);
    }
}

TEST_CASE("T06: from the centre of a ball") {
    Random random(6);
    for (int i = 0; i < 1000; ++i) {
        const Vector d = random.magnitude(-3, 3) * random.direction();
        const Span span = ball_span({{0, 0, 0}, d}, 1);
        CHECK(span.in == -span.out);
        CHECK(relative_error(span.out, 1 / sqrt(dot(ExactVector(d), ExactVector(d)))) <= 4 * u);
    }
}

TEST_CASE("T08: rays that almost touch a ball") {
    Random random(8);
    int wrong = 0, decided = 0;
    for (double distance : {10.0, 1e4, 1e7, 1e9})
        for (int exponent = -16; exponent <= -6; ++exponent)
            for (int i = 0; i < 60; ++i) {
                const double offset = std::pow(10, exponent) * (i % 2 ? 1 : -1);
                const AimedRay ray = aim(random, distance, 1 + offset);
                // How far from the centre the ray that the doubles describe truly passes.
                const ExactVector o(ray.origin), d(ray.direction);
                const Exact along = dot(o, d), impact = sqrt(dot(o, o) - along * along / dot(d, d));
                if (abs(impact - 1) < 1e-14) continue;
                ++decided;
                const Span span = ball_span(recentre(ray.origin, ray.direction).line, 1);
                if (span.is_empty() != (impact > 1)) ++wrong;
            }
    CHECK(decided > 1500);
    CHECK(wrong == 0);
}

TEST_CASE("T10: rays in the planes of slabs") {
    for (double zero : {0.0, -0.0}) {
        CHECK(slab_span(1, zero, -1, 1).is_empty());
        CHECK(slab_span(-1, zero, -1, 1).is_empty());
        const Span inside = slab_span(0.5, zero, -1, 1);
        CHECK((inside.in == -infinity && inside.out == infinity));
    }
    // From a face, along the slowest of directions.
    for (double d : {0x1p-1022, 0x1p-1074, -0x1p-1074, 1e-200}) {
        const Span span = slab_span(1, d, -1, 1);
        CHECK_FALSE(std::isnan(span.in));
        CHECK_FALSE(std::isnan(span.out));
    }
    const Span infinite = slab_span(3, -2, -infinity, infinity);
    CHECK((infinite.in == -infinity && infinite.out == infinity));
}

TEST_CASE("T11: thin boxes keep their thickness") {
    struct Case {
        double thickness, place;
    };
    for (const Case& c : {Case{1e-13, 1}, Case{1e-7, 1e6}}) {
        const Span span = slab_span(-1, 1, c.place - c.thickness / 2, c.place + c.thickness / 2);
        CHECK(span.in < span.out);
        CHECK(std::fabs((span.out - span.in) - c.thickness) <= 4 * u * (c.place + 1));
    }
}

TEST_CASE("T12: rods along rays nearly parallel to their axis") {
    Random random(12);
    struct Case {
        double offset, bound;
    };
    for (const Case& c : {Case{0, 1e-15}, Case{100, 5e-14}, Case{1e6, 5e-10}}) {
        double worst = 0;
        for (int exponent = 3; exponent <= 12; ++exponent)
            for (int i = 0; i < 100; ++i) {
                // From beside the axis toward it, at a small angle.
                const double angle = std::pow(10, -exponent), turn = random.uniform(-3, 3);
                const double aside = random.uniform(-0.5, 0.5);
                const Vector d{std::sin(angle) * std::cos(turn), std::cos(angle), std::sin(angle) * std::sin(turn)};
                const Point o{-c.offset * std::cos(turn) - aside * std::sin(turn), 0,
                              -c.offset * std::sin(turn) + aside * std::cos(turn)};
                const Span span = tube_span({o, d}, 1);  // as it comes: the tube does not rely on recentring
                const auto roots = quadratic_roots(cylinder_polynomial(o, d, 1));
                REQUIRE(roots.size() == 2);
                worst = std::max(worst, relative_error(span.out - span.in, roots[1] - roots[0]));
            }
        CAPTURE(c.offset);
        CHECK(worst <= c.bound);
    }
}

TEST_CASE("T13: rods along rays exactly parallel to their axis") {
    const double below = std::nextafter(1, 0), above = std::nextafter(1, 2);
    for (double sense : {1.0, -1.0}) {
        const Span inside = tube_span({{below, 0, 0}, {0, sense, 0}}, 1);
        CHECK((inside.in == -infinity && inside.out == infinity));
        CHECK(tube_span({{1, 0, 0}, {0, sense, 0}}, 1).is_empty());
        CHECK(tube_span({{0, 0, above}, {0, sense, -0.0}}, 1).is_empty());
    }
}

TEST_CASE("Random lines through rods of any size") {
    Random random(120);
    double worst = 0;
    int wrong = 0;
    for (int i = 0; i < 3000; ++i) {
        const double radius = random.magnitude(-6, 6);
        LocalLine line = random.line(2);
        line = {to_point(radius * to_vector(line.closest)), random.magnitude(-20, 20) * line.direction};
        const Span span = tube_span(line, radius);
        const auto roots = quadratic_roots(cylinder_polynomial(line.closest, line.direction, radius));
        if (span.is_empty() != roots.empty()) {
            ++wrong;
            continue;
        }
        if (roots.empty()) continue;
        // Across the surface: the cosine there is the half-chord's share of the radius.
        const double speed = std::hypot(line.direction.x, line.direction.z) / radius;
        const double cosine = static_cast<double>(roots[1] - roots[0]) / 2 * speed;
        worst = std::max({worst, error(span.in, roots[0]) * speed * cosine, error(span.out, roots[1]) * speed * cosine});
    }
    CHECK(wrong == 0);
    CHECK(worst / u <= 8);
}

namespace {

struct ConeOutcome {
    int wrong = 0;
    double worst = 0;
};

// Counts lines whose spans differ from what the polynomial says, and measures how far their ends are off across the
// surface, as a part of `size`.
void compare_cone(const LocalLine& line, double slope, double apex, double size, ConeOutcome& outcome) {
    Span spans[2];
    const int count = double_cone_spans(line, slope, apex, spans);
    const Polynomial p = cone_polynomial(line.closest, line.direction, slope, apex);
    const auto roots = quadratic_roots(p);
    const bool steep = p[2] < 0;
    const int expected = roots.empty() ? (steep ? 1 : 0) : (steep ? 2 : 1);
    if (count != expected) {
        ++outcome.wrong;
        return;
    }
    if (roots.empty()) return;
    if (steep && !(spans[0].in == -infinity && spans[1].out == infinity)) ++outcome.wrong;
    const double found[2] = {steep ? spans[0].out : spans[0].in, steep ? spans[1].in : spans[0].out};
    for (int i = 0; i < 2; ++i) {
        const ExactVector q = at(line.closest, line.direction, roots[i]);
        const ExactVector normal{q.x, Exact(slope) * slope * (apex - q.y), q.z};
        const Exact cosine = abs(dot(normal, line.direction)) / sqrt(dot(normal, normal));
        // Far along the line, the places of the line themselves are that much coarser.
        const double scale = std::max(size, static_cast<double>(abs(roots[i])));
        outcome.worst = std::max(outcome.worst, error(found[i], roots[i]) * static_cast<double>(cosine) / scale);
    }
}

}  // namespace

TEST_CASE("T14: cones near their apex") {
    Random random(14);
    SECTION("past it, as closely as doubles tell") {
        ConeOutcome outcome;
        for (int exponent = -15; exponent <= 0; ++exponent)
            for (int i = 0; i < 200; ++i) {
                const Vector offset = std::pow(10, exponent) * random.direction();
                compare_cone({{offset.x, 1 + offset.y, offset.z}, random.direction()}, 0.5, 1, length(offset), outcome);
            }
        CHECK(outcome.wrong == 0);
        CHECK(outcome.worst / u <= 16);
    }
    SECTION("exactly through it") {
        for (int i = 0; i < 100; ++i) {
            const Vector d = random.direction();
            Span spans[2];
            const bool steep = std::fabs(d.y) > std::hypot(d.x, d.z);
            CHECK(double_cone_spans({{0, 0, 0}, d}, 1, 0, spans) == (steep ? 1 : 0));
        }
    }
    SECTION("along a generator, and parallel to one") {
        Span spans[2];
        CHECK(double_cone_spans({{0, 0, 0}, {1, 1, 0}}, 1, 0, spans) == 0);
        REQUIRE(double_cone_spans({{-0.5, -0.5, 0}, {1, -1, 0}}, 1, 0, spans) == 1);
        CHECK(spans[0].in == 0);
        CHECK(spans[0].out == infinity);
        REQUIRE(double_cone_spans({{-0.5, -0.5, 0}, {-1, 1, 0}}, 1, 0, spans) == 1);
        CHECK(spans[0].in == -infinity);
        CHECK(spans[0].out == 0);
    }
}

TEST_CASE("T15: needles and discs of cones") {
    Random random(15);
    for (double angle : {1e-6, 0.1, 1.5, 1.5707963267948966 - 1e-6}) {
        CAPTURE(angle);
        const double slope = std::tan(angle);
        ConeOutcome outcome;
        for (int i = 0; i < 1000; ++i) {
            const double y = random.uniform(-1, 1), turn = random.uniform(-3, 3), part = random.uniform(-1.2, 1.2);
            const double rho = slope * (1 - y) * part;
            compare_cone({{rho * std::cos(turn), y, rho * std::sin(turn)}, random.direction()}, slope, 1, 1, outcome);
        }
        CHECK(outcome.wrong == 0);
        CHECK(outcome.worst / u <= 16);
    }
}

TEST_CASE("Cones that are almost cylinders keep their radius") {
    // Radii 1 and 1 - 1e-12 over a height of 2: the apex is 2e12 away.
    const double slope = 0.5e-12, apex = 1 + (1 - 1e-12) / slope;
    ConeOutcome outcome;
    Random random(150);
    for (int i = 0; i < 1000; ++i) compare_cone(random.line(1.2), slope, apex, 1, outcome);
    CHECK(outcome.wrong == 0);
    CHECK(outcome.worst / u <= 16);
}

}  // namespace lapidary::test
