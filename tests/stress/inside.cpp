// SPDX-License-Identifier: MIT
//
// Rays that start inside (T43), solids without end (T44), and matter that a ray never leaves (T45).
#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <string>

#include "stress/exact.h"
#include "support/measurement.h"
#include "support/solids.h"
#include "support/traced_scene.h"

using namespace lapidary;
using namespace lapidary::test;

namespace {

struct Ball {
    Point centre;
    double radius;
};

// Three that overlap, in a space whose middle is far from the origin by `offset`.
std::array<Ball, 3> overlapping(double offset) {
    return {Ball{{offset, offset, offset}, 1}, Ball{{offset + 0.5, offset, offset}, 0.875},
            Ball{{offset + 0.25, offset + 0.5, offset}, 1.125}};
}

void check_start_sets(int eyes) {
    const double offset = GENERATE(0.0, 1e3, 1e6);
    const bool turned = GENERATE(false, true);
    CAPTURE(offset, turned);
    SolidMaker maker(43);
    Random random(43);
    const std::array<Ball, 3> balls = overlapping(offset);
    std::vector<SceneNodePtr> nodes;
    for (const Ball& ball : balls) {
        Factors factors = turned ? maker.there_and_back(3) : Factors{};
        factors.push_back(translate(ball.centre.x, ball.centre.y, ball.centre.z));
        nodes.push_back(maker.leaf("sphere", factors, {{"radius", {ball.radius}}}));
    }
    SpansThrough through(nodes);
    Measurement measured({"T43", "balls that hold the eye", "", 0});
    int decided = 0;
    for (int i = 0; i < eyes; ++i) {
        // Half of the eyes are close to a surface.
        Point eye = Point{offset, offset, offset} + 1.5 * random.uniform(0, 1) * random.direction();
        if (i % 2 == 0) {
            const Ball& ball = balls[static_cast<std::size_t>(i / 2) % 3];
            const double off = (i % 4 == 0 ? 1 : -1) * random.magnitude(-16, -2);
            eye = ball.centre + (ball.radius + off) * random.direction();
        }
        const Ray ray = ray_from(eye, random.direction());
        for (std::size_t k = 0; k < 3; ++k) {
            const ExactVector from_centre{Exact(eye.x) - balls[k].centre.x, Exact(eye.y) - balls[k].centre.y,
                                          Exact(eye.z) - balls[k].centre.z};
            const Exact depth = balls[k].radius - sqrt(dot(from_centre, from_centre));
            // What rounding makes of a chain of rotations is not the eye's doing.
            if (abs(depth) < (turned ? 32 : 8) * u) continue;
            ++decided;
            const std::vector<Span> spans = through(ray, k);
            measured.expect((!spans.empty() && spans[0].in == 0) == (depth > 0));
        }
    }
    CHECK(decided > 2 * eyes);
}

}  // namespace

TEST_CASE("T43 an eye inside overlapping balls is in those that hold it") { check_start_sets(2000); }
TEST_CASE("T43 an eye inside overlapping balls, in a million rays", "[.long]") { check_start_sets(170000); }

TEST_CASE("T43 an eye is in the medium of highest priority that holds it") {
    const std::array<Ball, 3> balls = overlapping(0);
    const std::array<double, 3> indices{1.25, 1.5, 1.75};
    // All orders of priority; equal ones leave the decision to the order of writing.
    for (const std::array<int, 3>& priorities :
         {std::array{0, 0, 0}, {1, 2, 3}, {1, 3, 2}, {2, 1, 3}, {2, 3, 1}, {3, 1, 2}, {3, 2, 1}, {0, 1, 1}}) {
        std::string text = "render { depth(1); } lights { ambient { } } objects { " + wall;
        for (std::size_t i = 0; i < 3; ++i)
            text +=
                fmt::format("sphere {{ radius({}); priority({}); {} transform {{ translate({}, {}, {}); }} }} ", balls[i].radius,
                            priorities[i], glass(indices[i]), balls[i].centre.x, balls[i].centre.y, balls[i].centre.z);
        CAPTURE(text);
        TracedScene scene(text + "}");
        Random random(43);
        Measurement measured({"T43", "the medium that the eye is in", "", 0});
        int nested = 0;
        for (int i = 0; i < 200; ++i) {
            const Point eye = to_point(1.5 * random.uniform(0, 1) * random.direction());
            int owner = -1, held = 0;
            for (int k = 0; k < 3; ++k) {
                const Ball& ball = balls[static_cast<std::size_t>(k)];
                if (length(eye - ball.centre) >= ball.radius) continue;
                ++held;
                if (owner < 0 || priorities[static_cast<std::size_t>(k)] > priorities[static_cast<std::size_t>(owner)]) owner = k;
            }
            nested += held > 1;
            const TracedRay traced = scene.trace(eye, random.direction());
            REQUIRE_FALSE(traced.events.empty());
            // The wall is opaque: no indices are read there.
            const double index = owner < 0 ? 1 : indices[static_cast<std::size_t>(owner)];
            measured.expect(owner < 0 || traced.events[0].index_before == index);
        }
        CHECK(nested > 50);
    }
}

TEST_CASE("T44 below the ground, the horizon is where it is") {
    Measurement depths({"T44", "way out of a half-space", "u, relative", 8}), met({"T44", "what is met at the horizon", "", 0});
    for (const char* matter : {"", "material { solid { refraction(1.5); } } "}) {
        CAPTURE(matter);
        TracedScene scene(
            std::string("background(0.25, 0.5, 0.75); lights { ambient { } point { location(1, 5, 2); intensity(9); } "
                        "direct { direction(1, -1, 1); } } objects { halfspace { ") +
            matter + "} }");
        for (const double slope : {1e-3, 1e-9, 1e-17, 1e-100, 1e-300}) {
            // The way out is 1 / sin(elevation) away.
            const RaySample up = scene.sample({0, -1, 0}, {1, slope, 0});
            depths.record((up.depth / (std::hypot(1, slope) / slope) - 1) / u);
            met.expect(is_finite(up.colour));
            met.expect(std::fabs(up.normal.y) == 1);
        }
        // Level or downward: never out.
        for (const double slope : {0.0, -0.0, -1e-300, -1e-17, -1e-3, -1.0})
            for (const Vector& direction : {Vector{1, slope, 0}, Vector{-0.0, slope, -1}}) {
                const RaySample level = scene.sample({0, -1, 0}, direction);
                met.expect(level.object == 0);
                met.expect(level.depth == infinity);
                met.expect(is_finite(level.colour));
            }
        // From above, level or upward: never in. Downward: in.
        for (const double slope : {0.0, -0.0, 1e-300, 1e-17, 1.0}) {
            met.expect(scene.sample({0, 1, 0}, {1, slope, 0}).object == 0);
            met.expect(scene.colour({0, 1, 0}, {1, slope, 0}) == Colour{0.25, 0.5, 0.75});
        }
        const RaySample down = scene.sample({0, 1, 0}, {1, -1e-17, 0});
        met.expect(down.depth == Approx(1e17).epsilon(1e-15));
        met.expect(is_finite(down.colour));
    }
}

TEST_CASE("T45 matter without end lets through everything or nothing") {
    struct Case {
        std::string colour;
        Colour passed;
    };
    const Colour sky{0.25, 0.5, 0.75};
    for (const Case& c : {Case{"1, 1, 1", sky}, Case{"0.5, 0.5, 0.5", {0, 0, 0}}, Case{"1, 0.999999, 0", {0.25, 0, 0}},
                          Case{"0, 0, 0", {0, 0, 0}}}) {
        CAPTURE(c.colour);
        const std::string matter = "material { solid { refraction(1); colour(" + c.colour + "); } } ";
        const std::string halves = "halfspace { } halfspace { transform { scale(1, -1, 1); } } ";
        const std::string head = "background(0.25, 0.5, 0.75); lights { ambient { } } objects { ";
        // All of space; all of it but a ball, which is the complement of the ball; all but the complement of all.
        for (const std::string& everywhere : {"merge { " + halves + matter + "} ", "union { " + halves + matter + "} ",
                                              "subtraction { merge { " + halves + "} sphere { } " + matter + "} ",
                                              "subtraction { merge { " + halves + "} subtraction { merge { " + halves +
                                                  "} merge { " + halves + "} } " + matter + "} "}) {
            CAPTURE(everywhere);
            TracedScene scene(head + everywhere + "}");
            Random random(45);
            Measurement measured({"T45", "matter without end", "", 0});
            for (int i = 0; i < 100; ++i) {
                const Point eye = to_point(3 * random.direction());
                const Vector away = i % 2 == 0 ? to_vector(eye) : random.direction();
                const Colour colour = scene.colour(eye, away);
                measured.expect(colour == c.passed);
            }
            CHECK(scene.colour({0, -1, 0}, {1, 0, 0}) == c.passed);  // level
            CHECK(scene.colour({0, 0, 0}, {0, 0, 1}) == c.passed);   // in the face, or in the ball
        }
    }
}
