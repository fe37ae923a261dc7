// SPDX-License-Identifier: MIT
//
// Lines and the standard surfaces at every scale and distance, against 200-bit arithmetic on the same doubles. Bounds are
// in units of the rounding unit u = 2^-53; the names T01 … are those of the project's catalogue of numerical tests.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "kernel/math/roots.h"
#include "stress/exact.h"
#include "support/catch.h"
#include "support/measurement.h"

namespace lapidary::test {
namespace {

double error(double t, const Exact& truth) { return static_cast<double>(abs(Exact(t) - truth)); }
double relative_error(double t, const Exact& truth) { return static_cast<double>(abs((Exact(t) - truth) / truth)); }

bool is_everything(const Span& span) { return span.in == -infinity && span.out == infinity; }

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
    Measurement places({"T01", "unit ball from 1e7", "absolute", 1.9e-9}), residual({"T01", "hit on the ball", "u", 4});
    places.record(error(r.t(span.in), Exact("9999999.133974596215561353236277")));
    places.record(error(r.t(span.out), Exact("10000000.866025403784438646763723")));
    residual.record((length(r.line.at(span.in)) - 1) / u);
}

namespace {

// Balls at distances of 10 to 1e12, from directions of three lengths.
void check_far_balls(int rays) {
    Measurement places({"T02", "unit ball from 10 to 1e12", "u D / cos", 2}), residual({"T02", "hits on the ball", "u", 6}),
        lengths({"T07", "directions of 1e-150 to 1e150", "u", 4});
    Random random(2);
    std::vector<LocalLine> lines;
    for (int exponent = 1; exponent <= 12; ++exponent) {
        const double distance = std::pow(10, exponent);
        for (int i = 0; i < rays; ++i) {
            const AimedRay ray = aim(random, distance, std::sqrt(random.uniform(0, 1)));
            const Recentred r = recentre(ray.origin, ray.direction);
            const Span span = ball_span(r.line, 1);
            lines.push_back(r.line);
            const auto roots = quadratic_roots(sphere_polynomial(ray.origin, ray.direction, 1));
            if (roots.empty()) continue;
            const double half = static_cast<double>(roots[1] - roots[0]) / 2;
            if (span.is_empty()) {
                places.expect(half * half <= 2e-13);
                continue;
            }
            places.record(error(r.t(span.in), roots[0]) * half / (distance * u));
            places.record(error(r.t(span.out), roots[1]) * half / (distance * u));
            residual.record((length(r.line.at(span.in)) - 1) / u);
            // Stretching the direction shortens every t by the same factor.
            for (double stretch : {1e-150, 1e150}) {
                const Span stretched = ball_span({r.line.closest, stretch * r.line.direction}, 1);
                lengths.record((stretched.out * stretch / span.out - 1) / u);
                lengths.record((stretched.in * stretch / span.in - 1) / u);
            }
        }
    }
    places.time(lines, [](const LocalLine& line) { return ball_span(line, 1); });
}

}  // namespace

TEST_CASE("T02, T07: a unit ball from any distance, with directions of any length") { check_far_balls(300); }
TEST_CASE("T02, T07: a unit ball from any distance, in a quarter of a million rays", "[.long]") { check_far_balls(20000); }

TEST_CASE("T03: balls and rods of any size down to the smallest numbers and up to the largest") {
    Measurement balls({"T03", "balls of 1e-308 to 1e307", "u r", 2}), rods({"T03", "rods of 1e-308 to 1e307", "u r", 8});
    const double across = std::sqrt(0.75);
    for (double radius : {1e-12, 1e-150, 1e-300, 4e-308, 1e150, 1e300, 8e307}) {
        const Span span = ball_span({{0, 0, 0}, {0, 0, 1}}, radius);
        balls.expect(span.in < span.out);
        balls.record((span.out / radius - 1) / u);
        balls.record((ball_span({{0.5 * radius, 0, 0}, {0, 0, 1}}, radius).out / radius - across) / u);
        balls.expect(ball_span({{radius, 0, 0}, {0, 0, 1}}, radius).is_empty());
        balls.expect(ball_span({{0, -1.5 * radius, 0}, {0, 0, 1}}, radius).is_empty());
        rods.record((tube_span({{0.5 * radius, 0, 0}, {0, 0, 1}}, radius).out / radius - across) / u);
        if (radius >= 1) continue;
        // From one unit away: both ends are there, and in order.
        const Recentred r = recentre({0, 0, -1}, {0, 0, 1});
        const Span seen = ball_span(r.line, radius);
        balls.expect(seen.in < seen.out);
        balls.record((r.t(seen.in) - (1 - radius)) / u);
    }
}

TEST_CASE("T04: the horizon of a planet") {
    const double radius = 6371000, eye = radius + 2;
    const double dip = std::acos(radius / eye);
    CHECK(dip * 180 / std::numbers::pi == Approx(0.04539925944965114).epsilon(1e-9));
    CHECK(eye * std::sin(dip) == Approx(5048.16838070997786).epsilon(1e-9));
    Measurement horizon({"T04", "horizon of a planet, eye at 2", "u D / cos", 2});
    std::vector<LocalLine> lines;
    for (double delta : {-1e-9, 1e-9}) {
        const Point origin{0, eye, 0};
        const Vector direction{std::cos(dip + delta), -std::sin(dip + delta), 0};
        const Recentred r = recentre(origin, direction);
        lines.push_back(r.line);
        const auto roots = quadratic_roots(sphere_polynomial(origin, direction, radius));
        const Span span = ball_span(r.line, radius);
        horizon.expect(span.is_empty() == roots.empty());
        horizon.expect(span.is_empty() == (delta < 0));
        if (span.is_empty()) continue;
        const double cosine = static_cast<double>(roots[1] - roots[0]) / 2 / radius;
        horizon.record(error(r.t(span.in), roots[0]) * cosine / (u * eye));
    }
    horizon.time(lines, [&](const LocalLine& line) { return ball_span(line, radius); });
}

TEST_CASE("T06: from the centre of a ball") {
    Random random(6);
    Measurement centre({"T06", "from the centre of a ball", "u", 2});
    std::vector<LocalLine> lines;
    for (int i = 0; i < 10000; ++i) {
        const Vector d = random.magnitude(-3, 3) * random.direction();
        const LocalLine& line = lines.emplace_back(LocalLine{{0, 0, 0}, d});
        const Span span = ball_span(line, 1);
        centre.expect(span.in == -span.out);
        centre.record(relative_error(span.out, 1 / sqrt(dot(ExactVector(d), ExactVector(d)))) / u);
    }
    centre.time(lines, [](const LocalLine& line) { return ball_span(line, 1); });
}

TEST_CASE("T08: rays that almost touch a ball") {
    Random random(8);
    Measurement tangents({"T08", "tangents of a ball, from 10 to 1e9", "", 0});
    int decided = 0;
    std::vector<LocalLine> lines;
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
                lines.push_back(recentre(ray.origin, ray.direction).line);
                tangents.expect(ball_span(lines.back(), 1).is_empty() == (impact > 1));
            }
    CHECK(decided > 1500);
    tangents.time(lines, [](const LocalLine& line) { return ball_span(line, 1); });
}

TEST_CASE("T10: rays in the planes of slabs") {
    Measurement planes({"T10", "rays in the planes of slabs", "", 0});
    for (double zero : {0.0, -0.0}) {
        planes.expect(slab_span(1, zero, -1, 1).is_empty());
        planes.expect(slab_span(-1, zero, -1, 1).is_empty());
        planes.expect(is_everything(slab_span(0.5, zero, -1, 1)));
    }
    // From a face, along the slowest of directions.
    for (double d : {0x1p-1022, 0x1p-1074, -0x1p-1074, 1e-200}) {
        const Span span = slab_span(1, d, -1, 1);
        planes.expect(!std::isnan(span.in) && !std::isnan(span.out));
    }
    planes.expect(is_everything(slab_span(3, -2, -infinity, infinity)));
}

TEST_CASE("T11: thin boxes keep their thickness") {
    struct Case {
        double thickness, place;
    };
    Measurement thin({"T11", "slabs of 1e-13 at 1, 1e-7 at 1e6", "u (D + 1)", 4});
    for (const Case& c : {Case{1e-13, 1}, Case{1e-7, 1e6}}) {
        const Span span = slab_span(-1, 1, c.place - c.thickness / 2, c.place + c.thickness / 2);
        thin.expect(span.in < span.out);
        thin.record(((span.out - span.in) - c.thickness) / (u * (c.place + 1)));
    }
}

TEST_CASE("T12: rods along rays nearly parallel to their axis") {
    Random random(12);
    struct Case {
        const char* what;
        double offset, bound;
    };
    for (const Case& c :
         {Case{"rods, nearly parallel, from beside", 0, 1e-15}, Case{"rods, nearly parallel, from 100", 100, 5e-14},
          Case{"rods, nearly parallel, from 1e6", 1e6, 5e-10}}) {
        Measurement chords({"T12", c.what, "of the chord", c.bound});
        std::vector<LocalLine> lines;
        for (int exponent = 3; exponent <= 12; ++exponent)
            for (int i = 0; i < 100; ++i) {
                // From beside the axis toward it, at a small angle.
                const double angle = std::pow(10, -exponent), turn = random.uniform(-3, 3);
                const double aside = random.uniform(-0.5, 0.5);
                const Vector d{std::sin(angle) * std::cos(turn), std::cos(angle), std::sin(angle) * std::sin(turn)};
                const Point o{-c.offset * std::cos(turn) - aside * std::sin(turn), 0,
                              -c.offset * std::sin(turn) + aside * std::cos(turn)};
                lines.push_back({o, d});  // as it comes: the tube does not rely on recentring
                const Span span = tube_span(lines.back(), 1);
                const auto roots = quadratic_roots(cylinder_polynomial(o, d, 1));
                REQUIRE(roots.size() == 2);
                chords.record(relative_error(span.out - span.in, roots[1] - roots[0]));
            }
        chords.time(lines, [](const LocalLine& line) { return tube_span(line, 1); });
    }
}

TEST_CASE("T13: rods along rays exactly parallel to their axis") {
    const double below = std::nextafter(1, 0), above = std::nextafter(1, 2);
    Measurement parallel({"T13", "rods, exactly parallel", "", 0});
    for (double sense : {1.0, -1.0}) {
        parallel.expect(is_everything(tube_span({{below, 0, 0}, {0, sense, 0}}, 1)));
        parallel.expect(tube_span({{1, 0, 0}, {0, sense, 0}}, 1).is_empty());
        parallel.expect(tube_span({{0, 0, above}, {0, sense, -0.0}}, 1).is_empty());
    }
}

TEST_CASE("Random lines through rods of any size") {
    Random random(120);
    Measurement rods({"T12", "random rods of 1e-6 to 1e6", "u r / cos", 8});
    for (int i = 0; i < 3000; ++i) {
        const double radius = random.magnitude(-6, 6);
        LocalLine line = random.line(2);
        line = {to_point(radius * to_vector(line.closest)), random.magnitude(-20, 20) * line.direction};
        const Span span = tube_span(line, radius);
        const auto roots = quadratic_roots(cylinder_polynomial(line.closest, line.direction, radius));
        rods.expect(span.is_empty() == roots.empty());
        if (roots.empty() || span.is_empty()) continue;
        // Across the surface: the cosine there is the half-chord's share of the radius.
        const double speed = std::hypot(line.direction.x, line.direction.z) / radius;
        const double cosine = static_cast<double>(roots[1] - roots[0]) / 2 * speed;
        rods.record(error(span.in, roots[0]) * speed * cosine / u);
        rods.record(error(span.out, roots[1]) * speed * cosine / u);
    }
}

namespace {

// Whether the spans of a line are those that the polynomial tells, and how far their ends are off across the surface, in
// rounding units of `size`.
void compare_cone(const LocalLine& line, double slope, double apex, double size, Measurement& measured) {
    Span spans[2];
    const int count = double_cone_spans(line, slope, apex, spans);
    const Polynomial p = cone_polynomial(line.closest, line.direction, slope, apex);
    const auto roots = quadratic_roots(p);
    const bool steep = p[2] < 0;
    const int expected = roots.empty() ? (steep ? 1 : 0) : (steep ? 2 : 1);
    measured.expect(count == expected);
    if (roots.empty() || count != expected) return;
    if (steep) measured.expect(spans[0].in == -infinity && spans[1].out == infinity);
    const double found[2] = {steep ? spans[0].out : spans[0].in, steep ? spans[1].in : spans[0].out};
    for (int i = 0; i < 2; ++i) {
        const ExactVector q = at(line.closest, line.direction, roots[i]);
        const ExactVector normal{q.x, Exact(slope) * slope * (apex - q.y), q.z};
        const Exact cosine = abs(dot(normal, line.direction)) / sqrt(dot(normal, normal));
        // Far along the line, the places of the line themselves are that much coarser.
        const double scale = std::max(size, static_cast<double>(abs(roots[i])));
        measured.record(error(found[i], roots[i]) * static_cast<double>(cosine) / (scale * u));
    }
}

}  // namespace

TEST_CASE("T14: cones near their apex") {
    Random random(14);
    SECTION("past it, as closely as doubles tell") {
        Measurement past({"T14", "past an apex, by 1e-15 to 1", "u of the way", 16});
        std::vector<LocalLine> lines;
        for (int exponent = -15; exponent <= 0; ++exponent)
            for (int i = 0; i < 200; ++i) {
                const Vector offset = std::pow(10, exponent) * random.direction();
                lines.push_back({{offset.x, 1 + offset.y, offset.z}, random.direction()});
                compare_cone(lines.back(), 0.5, 1, length(offset), past);
            }
        past.time(lines, [](const LocalLine& line) {
            Span spans[2];
            double_cone_spans(line, 0.5, 1, spans);
            return spans[0];
        });
    }
    SECTION("exactly through it") {
        Measurement through({"T14", "through an apex", "", 0});
        for (int i = 0; i < 100; ++i) {
            const Vector d = random.direction();
            Span spans[2];
            const bool steep = std::fabs(d.y) > std::hypot(d.x, d.z);
            through.expect(double_cone_spans({{0, 0, 0}, d}, 1, 0, spans) == (steep ? 1 : 0));
        }
    }
    SECTION("along a generator, and parallel to one") {
        Measurement along({"T14", "along a generator", "", 0});
        Span spans[2];
        along.expect(double_cone_spans({{0, 0, 0}, {1, 1, 0}}, 1, 0, spans) == 0);
        along.expect(double_cone_spans({{-0.5, -0.5, 0}, {1, -1, 0}}, 1, 0, spans) == 1 && spans[0].in == 0 &&
                     spans[0].out == infinity);
        along.expect(double_cone_spans({{-0.5, -0.5, 0}, {-1, 1, 0}}, 1, 0, spans) == 1 && spans[0].in == -infinity &&
                     spans[0].out == 0);
    }
}

TEST_CASE("T15: needles and discs of cones") {
    Random random(15);
    Measurement measured({"T15", "cones of 1e-6 to 90deg - 1e-6", "u of the way", 16});
    for (double angle : {1e-6, 0.1, 1.5, 1.5707963267948966 - 1e-6}) {
        const double slope = std::tan(angle);
        for (int i = 0; i < 1000; ++i) {
            const double y = random.uniform(-1, 1), turn = random.uniform(-3, 3), part = random.uniform(-1.2, 1.2);
            const double rho = slope * (1 - y) * part;
            compare_cone({{rho * std::cos(turn), y, rho * std::sin(turn)}, random.direction()}, slope, 1, 1, measured);
        }
    }
}

TEST_CASE("Cones that are almost cylinders keep their radius") {
    // Radii 1 and 1 - 1e-12 over a height of 2: the apex is 2e12 away.
    const double slope = 0.5e-12, apex = 1 + (1 - 1e-12) / slope;
    Measurement measured({"T15", "cones that are almost cylinders", "u of the way", 16});
    Random random(150);
    for (int i = 0; i < 1000; ++i) compare_cone(random.line(1.2), slope, apex, 1, measured);
}

}  // namespace lapidary::test
