// SPDX-License-Identifier: MIT
//
// Lines and tori, T16 to T20: counts and places of crossings against the quartic in 200-bit arithmetic.

#include <algorithm>
#include <cmath>

#include "kernel/math/roots.h"
#include "stress/exact.h"
#include "support/catch.h"
#include "support/measurement.h"

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

// Whether the spans of a line are those of the quartic, and how far their ends are off across the surface, in units of
// u (R + r). Returns how many ends were compared.
int compare(const LocalLine& line, double major, double minor, Measurement& measured) {
    Span spans[2];
    const int count = torus_spans(line, major, minor, spans);
    const auto truth = crossings(line, major, minor);
    measured.expect(truth.size() == 2 * static_cast<std::size_t>(count));
    if (truth.size() != 2 * static_cast<std::size_t>(count)) return 0;
    for (int i = 0; i < 2 * count; ++i) {
        const double t = i % 2 ? spans[i / 2].out : spans[i / 2].in;
        const ExactVector p = at(line.closest, line.direction, truth[i]);
        const Exact rho = sqrt(p.x * p.x + p.z * p.z), outward = (rho - major) / rho;
        const ExactVector normal{p.x * outward, p.y, p.z * outward};
        const Exact across = abs(dot(normal, ExactVector(line.direction))) / minor;
        measured.record(static_cast<double>(abs(Exact(t) - truth[i]) * across / (major + minor)) / u);
    }
    return 2 * count;
}

// What a line through a torus costs.
void time(const std::vector<LocalLine>& lines, double major, double minor, Measurement& measured) {
    measured.time(lines, [&](const LocalLine& line) {
        Span spans[2];
        torus_spans(line, major, minor, spans);
        return spans[0];
    });
}

}  // namespace

TEST_CASE("T16: through a torus along its equator") {
    Measurement equator({"T16", "torus along its equator", "u t", 2});
    const Recentred r = recentre({-3, 0, 0}, {1, 0, 0});
    Span spans[2];
    REQUIRE(torus_spans(r.line, 1, 0.25, spans) == 2);
    const double ends[]{spans[0].in, spans[0].out, spans[1].in, spans[1].out}, truth[]{1.75, 2.25, 3.75, 4.25};
    for (int i = 0; i < 4; ++i) equator.record((r.t(ends[i]) - truth[i]) / (u * truth[i]));
}

TEST_CASE("Random lines through tori of all proportions and sizes") {
    struct Case {
        const char* what;
        double major, minor;
    };
    Random random(16);
    for (const Case& c :
         {Case{"torus", 1, 0.25}, Case{"thick torus", 1, 0.9}, Case{"thin torus", 1, 1e-4}, Case{"huge torus", 3e7, 1e6},
          Case{"tiny torus", 2e-9, 1e-9}, Case{"horn torus", 1, 1}, Case{"spindle torus", 0.5, 1},
          Case{"torus, almost a ball", 1e-3, 1}, Case{"spindle torus, almost a horn", 0.999, 1},
          Case{"torus of 1e150", 1e150, 1e149}, Case{"torus of 1e-151", 3e-151, 1e-151}}) {
        Measurement measured({"T16", c.what, "u (R + r) / cos", 8});
        const double size = c.major + c.minor;
        int ends = 0;
        std::vector<LocalLine> lines;
        for (int i = 0; i < 100; ++i) {
            // Through or just past a random place of the tube, so that thin rings are met.
            const double turn = random.uniform(-3.2, 3.2), part = random.uniform(-3.2, 3.2);
            const double depth = random.uniform(0, 1.1) * c.minor / size;
            const double rho = c.major / size + depth * std::cos(part);
            const Point place{rho * std::cos(turn), depth * std::sin(part), rho * std::sin(turn)};
            const LocalLine line = recentre(place, random.direction()).line;
            lines.push_back({to_point(size * to_vector(line.closest)), size * line.direction});
            ends += compare(lines.back(), c.major, c.minor, measured);
        }
        CHECK(ends > 100);
        time(lines, c.major, c.minor, measured);
    }
}

TEST_CASE("T17: planes that touch a torus at its crown") {
    Random random(17);
    Measurement crown({"T17", "planes at the crown of a torus", "", 0});
    std::vector<LocalLine> lines;
    for (int exponent = -14; exponent <= -6; ++exponent)
        for (double side : {-1.0, 1.0})
            for (int i = 0; i < 225; ++i) {
                const double y = 0.25 * (1 + side * std::pow(10, exponent));
                const double turn = random.uniform(-3, 3), aside = random.uniform(-0.9, 0.9);
                lines.push_back({{-aside * std::sin(turn), y, aside * std::cos(turn)}, {std::cos(turn), 0, std::sin(turn)}});
                Span spans[2];
                crown.expect(torus_spans(lines.back(), 1, 0.25, spans) == (side < 0 ? 2 : 0));
            }
    time(lines, 1, 0.25, crown);
}

TEST_CASE("T18: a thin torus from a million away") {
    Random random(18);
    Measurement local({"T18", "thin torus from 1e6, on its surface", "u (R + r) / cos", 8}),
        places({"T18", "thin torus from 1e6", "u D / cos", 2});
    constexpr double far = 1e6, minor = 1e-4;
    std::vector<LocalLine> lines;
    for (int i = 0; i < 200; ++i) {
        const double turn = random.uniform(-3, 3);
        const Point target{std::cos(turn), random.uniform(-minor, minor), std::sin(turn)};
        const Vector d = random.direction();
        const Point eye = target - far * d;
        const Recentred r = recentre(eye, d);
        lines.push_back(r.line);
        compare(r.line, 1, minor, local);
        // Against the ray from the eye itself.
        const auto truth = sign_changes(torus_polynomial(eye, d, 1, minor), far - 4, far + 4);
        Span spans[2];
        const int count = torus_spans(r.line, 1, minor, spans);
        places.expect(truth.size() == 2 * static_cast<std::size_t>(count));
        if (truth.size() != 2 * static_cast<std::size_t>(count)) continue;
        for (int k = 0; k < 2 * count; ++k) {
            const ExactVector p = at(eye, d, truth[k]);
            const Exact rho = sqrt(p.x * p.x + p.z * p.z), outward = (rho - 1) / rho;
            const Exact cosine = abs(dot({p.x * outward, p.y, p.z * outward}, d)) / minor;
            const double t = r.t(k % 2 ? spans[k / 2].out : spans[k / 2].in);
            places.record(static_cast<double>(abs(Exact(t) - truth[k]) * cosine) / (u * far));
        }
    }
    time(lines, 1, minor, local);
}

TEST_CASE("T19: through the hole of a torus") {
    Measurement hole({"T19", "hole of a torus", "", 0});
    Span spans[2];
    hole.expect(torus_spans({{0, 0, 0}, {0, 1, 0}}, 1, 0.25, spans) == 0);
    hole.expect(torus_spans({{0.75 - 1e-13, 0, 0}, {0, 1, 0}}, 1, 0.25, spans) == 0);
    hole.expect(torus_spans({{0.75 + 1e-13, 0, 0}, {0, 1, 0}}, 1, 0.25, spans) == 1);
}

TEST_CASE("T20: a torus that covers itself has no inner skin") {
    Measurement skins({"T20", "horn and spindle torus", "u R", 8});
    Span spans[2];
    // Along the axis of R = 0.5, r = 1: inside for |y| < sqrt(3)/2, through what would be the inner skin.
    REQUIRE(torus_spans({{0, 0, 0}, {0, 1, 0}}, 0.5, 1, spans) == 1);
    skins.record((spans[0].out - std::sqrt(0.75)) / u);
    skins.expect(spans[0].in == -spans[0].out);
    REQUIRE(torus_spans({{0, 0, 0}, {1, 0, 0}}, 0.5, 1, spans) == 1);
    skins.record((spans[0].out - 1.5) / u);
    // R = r: the tube meets itself in one point.
    REQUIRE(torus_spans({{0, 0, 0}, {1, 0, 0}}, 1, 1, spans) >= 1);
    skins.record((spans[0].in + 2) / u);
    // Across the dimple at the top there are two pieces.
    skins.expect(torus_spans({{0, 0.95, 0}, {1, 0, 0}}, 0.5, 1, spans) == 2);
}

}  // namespace lapidary::test
