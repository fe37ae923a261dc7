// SPDX-License-Identifier: MIT
//
// Light through matter whose index and colour change from region to region of a texture, against the same solids built of
// pieces, and against closed forms.

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "support/catch.h"
#include "support/traced_scene.h"

using namespace lapidary;
using namespace lapidary::test;

namespace {

// A world to look at through glass: a wall whose colour changes smoothly, evenly lit.
const std::string surroundings =
    "subtraction { material { sine { colour(1,0.8,0.1); colour2(0,0.3,1); bump(0); transform { scale(5); rotz(0.4); roty(1); } } "
    "} "
    "sphere { radius(60); } } with { sphere { radius(50); } } ";

TracedScene scene_of(const std::string& matter, int depth) {
    return TracedScene(
        fmt::format("lights {{ ambient {{ intensity(1); }} }} render {{ depth({}); cutoff(0.0001); }} objects {{ {} {} }}", depth,
                    matter, surroundings));
}

struct Comparison {
    int rays = 0, different = 0;
    double worst = 0;
};

// Rays from all around toward a ball about the origin.
template <class Visit>
void for_each_ray(int count, double radius, Visit visit) {
    std::mt19937_64 random(11);
    std::uniform_real_distribution<double> uniform(-1, 1);
    const auto in_ball = [&] {
        for (;;) {
            const Vector v{uniform(random), uniform(random), uniform(random)};
            if (length(v) < 1 && length(v) > 0.01) return v;
        }
    };
    for (int i = 0; i < count; ++i) {
        const Point origin = to_point(8 * normalize(in_ball()));
        const Point aim = to_point(radius * in_ball());
        visit(origin, aim - origin);
    }
}

Comparison compare(TracedScene& a, TracedScene& b, int count, double radius, double tolerance) {
    Comparison result;
    for_each_ray(count, radius, [&](const Point& origin, const Vector& direction) {
        const double apart = largest_difference(a.colour(origin, direction), b.colour(origin, direction));
        ++result.rays;
        result.different += !(apart <= tolerance);
        result.worst = std::max(result.worst, apart);
    });
    return result;
}

struct Media {
    std::string even, odd;
};

const Media glass_and_air{"solid { refraction(1.5); }", "solid { refraction(1); }"};
const Media two_glasses{"solid { refraction(1.5); colour(0.9,0.5,0.7); }",
                        "solid { refraction(1.3); colour(0.6,0.8,1); depth(2); }"};

// The cells of a checkers between -n and n, as cubes.
std::string checkers_of_cubes(const Media& media, int n) {
    std::string all = "union { ";
    for (int x = -n; x < n; ++x)
        for (int y = -n; y < n; ++y)
            for (int z = -n; z < n; ++z)
                all += fmt::format("cube {{ size(0.5,0.5,0.5); transform {{ translate({},{},{}); }} material {{ {} }} }} ",
                                   x + 0.5, y + 0.5, z + 0.5, (x + y + z) % 2 == 0 ? media.even : media.odd);
    return all + "} ";
}

}  // namespace

TEST_CASE("A cube of checkers looks like the same cube built of cubes") {
    const Media media = GENERATE(as<Media>{}, glass_and_air, two_glasses);
    const std::string place = GENERATE(as<std::string>{}, "", "transform { rotate(1,2,3, 0.8); translate(0.3,0.1,-0.2); } ");
    CAPTURE(media.even, place);
    TracedScene textured =
        scene_of("union { cube { material { checkers { " + media.even + media.odd + " } } } " + place + " } ", 6);
    TracedScene built = scene_of("union { " + checkers_of_cubes(media, 1) + place + " } ", 6);
    const Comparison comparison = compare(textured, built, 1500, 1.5, 1e-9);
    CAPTURE(comparison.worst);
    CHECK(comparison.different == 0);
    CHECK(textured.statistics().march_steps > 1000);
    CHECK(built.statistics().march_steps == 0);
}

TEST_CASE("A ball of rings looks like the same ball built of shells") {
    const Media media = GENERATE(as<Media>{}, glass_and_air, two_glasses);
    const std::string place = GENERATE(as<std::string>{}, "", "transform { rotate(1,2,3, 0.8); translate(0.3,0.1,-0.2); } ");
    CAPTURE(media.even, place);
    TracedScene textured =
        scene_of("union { sphere { radius(3); material { rings { " + media.even + media.odd + " } } } " + place + " } ", 6);
    TracedScene built =
        scene_of(fmt::format("union {{ sphere {{ radius(1); material {{ {} }} }} sphere {{ radius(2); material {{ {} }} }} "
                             "sphere {{ radius(3); material {{ {} }} }} {} }} ",
                             media.even, media.odd, media.even, place),
                 6);
    const Comparison comparison = compare(textured, built, 1500, 3, 1e-9);
    CAPTURE(comparison.worst);
    CHECK(comparison.different == 0);
}

TEST_CASE("In rings a ray keeps n r sin = const, shell by shell") {
    // A ball of radius 4: shells of 1.5 and 1.3 by turns, the innermost 1.5.
    TracedScene scene(
        "render { depth(30); cutoff(0.1); } objects { sphere { radius(4); material { rings { solid { refraction(1.5); } "
        "solid { refraction(1.3); } } } } " +
        wall + "}");
    const auto index_in = [](int shell) { return shell >= 4 ? 1.0 : shell % 2 == 0 ? 1.5 : 1.3; };
    for (const double b : {0.0, 0.3, 0.9, 1.2, 1.4, 1.6, 2.5, 2.8, 3.8, 3.95}) {
        CAPTURE(b);
        // Inward through shell k to radius k, unless n k < b: then it turns there, or is turned back at the shell within.
        const auto path = scene.trace({-9, b, 0}, {1, 0, 0}).main_path();
        int shell = 4;
        double turned = 0, worst = 0;  // the angle about the centre
        std::size_t i = 0;
        const auto meet = [&](int radius) {
            REQUIRE(i < path.size());
            const Point p = path[i++].point.rounded();
            worst = std::max(worst, std::fabs(length(p) - radius));
            const double angle = std::atan2(p.y, -p.x);
            worst = std::max(worst, std::fabs(std::remainder(angle - turned, 2 * std::numbers::pi)));
        };
        turned = std::asin(b / 4);
        meet(4);
        for (shell = 3; shell > 0 && index_in(shell) * shell > b && index_in(shell - 1) * shell > b; --shell) {
            turned += std::asin(b / (index_in(shell) * shell)) - std::asin(b / (index_in(shell) * (shell + 1)));
            meet(shell);
        }
        // In this shell the way is a chord, or ends at the shell within, by which it is totally reflected.
        const double half_chord = std::acos(b / (index_in(shell) * (shell + 1)));
        if (shell > 0 && index_in(shell) * shell > b) {
            turned += half_chord - std::acos(b / (index_in(shell) * shell));
            meet(shell);
            turned += half_chord - std::acos(b / (index_in(shell) * shell));
        } else {
            turned += 2 * half_chord;
        }
        for (++shell;; ++shell) {
            meet(shell);
            if (shell == 4) break;
            turned += std::asin(b / (index_in(shell) * shell)) - std::asin(b / (index_in(shell) * (shell + 1)));
        }
        CHECK(i + 1 == path.size());  // and the wall
        CHECK(worst <= 1e-13);
    }
}

TEST_CASE("Textured glass looks like glass built of pieces, in a hundred thousand rays", "[.long]") {
    TracedScene checkers =
        scene_of("union { cube { material { checkers { " + two_glasses.even + two_glasses.odd + " } } } } ", 6);
    TracedScene cubes = scene_of(checkers_of_cubes(two_glasses, 1), 6);
    const Comparison of_checkers = compare(checkers, cubes, 50000, 1.5, 1e-9);
    CAPTURE(of_checkers.worst);
    CHECK(of_checkers.different == 0);

    TracedScene rings = scene_of("sphere { radius(3); material { rings { " + two_glasses.even + two_glasses.odd + " } } } ", 6);
    TracedScene shells =
        scene_of(fmt::format("sphere {{ radius(1); material {{ {0} }} }} sphere {{ radius(2); material {{ {1} }} }} "
                             "sphere {{ radius(3); material {{ {0} }} }} ",
                             two_glasses.even, two_glasses.odd),
                 6);
    const Comparison of_rings = compare(rings, shells, 50000, 3, 1e-9);
    CAPTURE(of_rings.worst);
    CHECK(of_rings.different == 0);
}
