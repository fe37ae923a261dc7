// SPDX-License-Identifier: MIT
//
// Liquid in a glass (T31): where both touch there is one face, from the one to the other, though their sides are of two solids
// that came to their place by different ways. A sliver of air between them would mirror seventeen times as much.
#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <random>
#include <string>

#include "support/measurement.h"
#include "support/traced_scene.h"

namespace lapidary::test {
namespace {

constexpr double glass_index = 1.5, liquid_index = 1.333;

// A tube of glass about the y axis filled with liquid, and a wall far around them; all of that size, at that place on each axis.
std::string scene_of(double size, double place) {
    const std::string there_and_back =
        "rotate(1,2,3, 0.7); scale(3,3,3); rotate(-1,0.5,2, 1.9); rotx(0.3); inverse { rotx(0.3); } "
        "inverse { rotate(-1,0.5,2, 1.9); } inverse { scale(3,3,3); } inverse { rotate(1,2,3, 0.7); } ";
    return "background(1,1,1); render { depth(8); cutoff(0.01); } objects { union { subtraction { cylinder { radius(1); "
           "height(4); " +
           glass(glass_index) + " } } with { cylinder { radius(0.9); height(5); } } cylinder { radius(0.9); height(4); " +
           glass(liquid_index) + " transform { " + there_and_back + " } } " + wall +
           fmt::format("transform {{ scale({0}); translate({1}, {1}, {1}); }} }} }}", size, place);
}

void check_liquid(int rays) {
    struct Place {
        double size, offset;
    };
    const Place place = GENERATE(values<Place>({{1, 0}, {1, 1e3}, {1, 1e6}, {1e-6, 0}, {1e-6, 1e3}, {1e6, 0}}));
    const double size = place.size, offset = place.offset;
    CAPTURE(size, offset);
    TracedScene scene(scene_of(size, offset));
    const Point centre{offset, offset, offset};
    const double mirrored = std::pow((glass_index - liquid_index) / (glass_index + liquid_index), 2);  // 0.003474879854431
    Measurement direct({"T31", "from glass into liquid by one face", "", 0}),
        reflectance({"T31", "what that face mirrors, met at right angles", "relative", 1e-12});

    std::mt19937_64 random(31);
    std::uniform_real_distribution<double> uniform(-1, 1);
    int crossed = 0;
    for (int i = 0; i < rays; ++i) {
        // Every third one toward the axis, at right angles to it.
        const bool is_straight = i % 3 == 0;
        const double turn = std::numbers::pi * uniform(random), y = 1.5 * uniform(random);
        const double slope = is_straight ? 0 : 0.1 * uniform(random), aside = is_straight ? 0 : 0.8 * uniform(random);
        const Vector direction = normalize(Vector{std::cos(turn), slope, std::sin(turn)});
        const Vector from = Vector{0, y, 0} - 3 * direction + aside * Vector{-std::sin(turn), 0, std::cos(turn)};
        const auto path = direct.timed([&] { return scene.trace(centre + size * from, direction).main_path(); });

        // Where it enters the side of the glass, and meets the inner side next.
        const auto place_of = [&](std::size_t event) {
            const TwoPartVector p = path[event].point - centre;
            return (1 / size) * (p.hi + p.lo);
        };
        if (path.size() < 3 || std::fabs(place_of(0).y) > 1.99) continue;
        const Vector inner = place_of(1);
        if (std::fabs(std::hypot(inner.x, inner.z) - 0.9) > 1e-6) continue;
        ++crossed;
        direct.expect(path[1].index_before == glass_index && path[1].index_behind == liquid_index);
        if (is_straight) reflectance.record((1 - path[2].weight / path[1].weight) / mirrored - 1);
    }
    CHECK(crossed > 2 * rays / 3);
}

}  // namespace

TEST_CASE("T31 Liquid in a glass has one face with it, however both came to their place") { check_liquid(1700); }
TEST_CASE("T31 Liquid in a glass, in a million rays", "[.long]") { check_liquid(170000); }

}  // namespace lapidary::test
