// SPDX-License-Identifier: MIT
//
// Light through matter: white furnaces, cameras within, coloured shadows.

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <optional>
#include <random>
#include <string>

#include "kernel/prepare/world.h"
#include "kernel/render/render.h"
#include "support/catch.h"
#include "support/traced_scene.h"

using namespace lapidary;
using namespace lapidary::test;

namespace {

// A white floor at y = 0 under a light from straight above. Of white matter, diffuse light and highlight add up to all the
// light that arrives, so that a look at the floor measures the shadow.
std::string over_floor(const std::string& content, const std::string& light = "direct { direction(0,-1,0); }") {
    return "lights { " + light + " } objects { halfspace {} " + content + " }";
}

Colour shadow_at(TracedScene& scene, double x, double z = 0) {
    const Point origin{x - 10, 0.1, z};
    return scene.colour(origin, Point{x, 0, z} - origin);
}

Colour power(const Colour& colour, double exponent) {
    return {std::pow(colour.r, exponent), std::pow(colour.g, exponent), std::pow(colour.b, exponent)};
}

const std::string rose = "refraction(1.5); colour(0.9,0.4,0.6); ";
const Colour rose_colour{0.9, 0.4, 0.6};

std::string solid(const std::string& properties) { return "material { solid { " + properties + "} } "; }

}  // namespace

TEST_CASE("T71 Lossless glass under an even sky is invisible") {
    const std::string matter =
        GENERATE(as<std::string>{},
                 // nested, the innermost of air
                 "sphere { radius(0.5); priority(2); material { solid { refraction(1); } } } "
                 "sphere { radius(0.8); priority(1); material { solid { refraction(1.333); } } } "
                 "sphere { material { solid { refraction(1.5); } } } ",
                 // overlapping
                 "union { sphere { material { solid { refraction(1.5); } } } "
                 "cube { transform { scale(0.6); translate(0.7,0,0); } material { solid { refraction(2.42); } } } } ",
                 // textured
                 "cube { material { transform { scale(0.4); rotx(0.5); } noise { solid { refraction(1.5); } "
                 "solid { refraction(1.3); } solid { refraction(1); } } } } ",
                 // part mirror
                 "sphere { material { solid { refraction(1.5); reflection(0.3); } } } ");
    CAPTURE(matter);
    TracedScene scene("background(1,1,1); render { depth(20); cutoff(0.0001); } objects { " + matter + " }");
    std::mt19937 random(4);
    std::uniform_real_distribution<double> uniform(-1, 1);
    double least = 1, most = 0;
    for (int i = 0; i < 100; ++i) {
        const Point origin = i % 4 == 0 ? Point{0.1, 0.1, 0.1} : Point{uniform(random), uniform(random), -4};
        const Point aim{uniform(random), uniform(random), 0};
        const Colour colour = scene.colour(origin, aim - origin);
        least = std::min(least, colour.g), most = std::max(most, colour.g);
    }
    CHECK(least >= 1 - 1e-3);
    CHECK(most <= 1 + 1e-12);
}

TEST_CASE("Glass that absorbs is nowhere brighter than the sky") {
    TracedScene scene("background(1,1,1); render { depth(12); cutoff(0.001); } objects { sphere { " +
                      solid(rose + "depth(0.5);") +
                      "} cube { size(0.4,2,0.4); material { checkers { solid { refraction(1.3); colour(0.5,1,1); } solid { "
                      "refraction(2); } } } } }");
    std::mt19937 random(4);
    std::uniform_real_distribution<double> uniform(-1, 1);
    for (int i = 0; i < 100; ++i) {
        const Point origin{uniform(random), uniform(random), -4};
        CHECK(largest(scene.colour(origin, Vector{0.2 * uniform(random), 0.2 * uniform(random), 1})) <= 1 + 1e-12);
    }
}

TEST_CASE("A camera within matter sees through what is left of the way") {
    TracedScene scene(
        "background(1,1,1); render { depth(0); } objects { sphere { radius(3); " + solid(rose) +
        "} cube { size(1,1,0.5); transform { translate(0,0,2); } priority(1); } } lights { ambient { intensity(1); } }");
    // To the cube: 1.5 - 0.5 of the way in glass, then white, lit by 1.
    CHECK(largest_difference(scene.colour({0, 0, 0.5}, {0, 0, 1}), rose_colour) <= 1e-15);
    const auto events = scene.trace({0, 0, -1}, {0, 0, -1}).events;
    REQUIRE(events.size() == 1);
    CHECK(events[0].index_before == 1.5);
    CHECK(events[0].index_behind == 1);
    CHECK(largest_difference(events[0].transmittance, power(rose_colour, 2)) <= 1e-15);
    // Within the cube itself there is nothing to see but its inside.
    CHECK(largest(scene.colour({0, 0, 2}, {0, 0, 1})) <= 1);
}

TEST_CASE("A camera within textured matter knows the region that it stands in") {
    TracedScene scene(
        "background(1,1,1); objects { cube { size(4,4,4); material { checkers { solid { refraction(1.5); colour(0.5,1,1); }"
        " solid { refraction(1.5); colour(1,0.5,1); } } } } }");
    const auto events = scene.trace({0.25, 0.5, 0.5}, {1, 0, 0}).events;
    REQUIRE(events.size() >= 4);
    CHECK(events[0].point.rounded().x == 1);
    CHECK(events[0].transmittance.r == Approx(std::pow(0.5, 0.75)));
    CHECK(events[0].transmittance.g == 1);
}

TEST_CASE("The shadow of coloured glass has its colour") {
    TracedScene scene(over_floor("sphere { transform { translate(0,3,0); } " + solid(rose) + "} "));
    for (const double x : {0.0, 0.3, -0.5, 0.8, 0.99, 1.01, -2.0}) {
        CAPTURE(x);
        const double chord = std::fabs(x) < 1 ? 2 * std::sqrt(1 - x * x) : 0;
        CHECK(largest_difference(shadow_at(scene, x), power(rose_colour, chord)) <= 1e-13);
    }
}

TEST_CASE("Opaque parts of glass faces keep their share of the light") {
    TracedScene scene(over_floor("sphere { transform { translate(0,3,0); } " + solid(rose + "opacity(0.25); ") + "} "));
    CHECK(largest_difference(shadow_at(scene, 0), 0.75 * 0.75 * power(rose_colour, 2)) <= 1e-14);

    // Faces within a union count, in a merge there are none.
    const std::string pair = "{ sphere { transform { translate(0,3,0); } } sphere { transform { translate(0,4,0); } } " +
                             solid(rose + "opacity(0.25); ") + "} ";
    TracedScene united(over_floor("union " + pair)), merged(over_floor("merge " + pair));
    CHECK(largest_difference(shadow_at(united, 0), 0.75 * 0.75 * 0.75 * power(rose_colour, 3)) <= 1e-14);
    CHECK(largest_difference(shadow_at(merged, 0), 0.75 * 0.75 * power(rose_colour, 3)) <= 1e-14);
}

TEST_CASE("The shadow of textured glass is the product over its pieces") {
    const std::string cells =
        "cube { size(2,1.5,2); transform { translate(0,3.5,0); } material { checkers { solid { refraction(1.5); "
        "colour(0.5,1,0.9); OPACITY }"
        " solid { refraction(1.2); colour(1,0.25,0.8); OPACITY } } } } ";
    const auto with_opacity = [&](const std::string& opacity) {
        std::string text = cells;
        for (std::size_t found; (found = text.find("OPACITY")) != std::string::npos;) text.replace(found, 7, opacity);
        return over_floor(text);
    };
    // The cells move with the cube, which reaches from y = -1.5 to 1.5 in their space: through 0.5 of one kind, 1 of the
    // other, 1 and 0.5.
    TracedScene clear(with_opacity("")), covered(with_opacity("opacity(0.1); "));
    for (const double x : {0.5, -0.5, 1.25}) {
        const Colour expected{std::pow(0.5, 1.5), std::pow(0.25, 1.5), std::pow(0.9 * 0.8, 1.5)};
        CAPTURE(x);
        CHECK(largest_difference(shadow_at(clear, x, 0.5), expected) <= 1e-13);
        // Two faces and three boundaries.
        CHECK(largest_difference(shadow_at(covered, x, 0.5), std::pow(0.9, 5) * expected) <= 1e-13);
    }
}

TEST_CASE("Matter that is opaque in places keeps light out there only") {
    TracedScene scene(
        over_floor("cube { size(2,0.25,2); transform { translate(0,3.25,0); } material { transform { translate(0,-0.25,0); } "
                   "checkers { solid { refraction(1.5); } solid {} } } } "));
    CHECK(shadow_at(scene, 0.5, 0.5) == Colour::white());
    CHECK(is_black(shadow_at(scene, 1.5, 0.5)));
    CHECK(is_black(shadow_at(scene, -0.5, 0.5)));
    CHECK(shadow_at(scene, -0.5, -0.5) == Colour::white());
}

TEST_CASE("What is opaque keeps light out behind, before and within glass") {
    const std::string glass_ball = "sphere { transform { translate(0,3,0); } " + solid(rose) + "} ";
    const std::string opaque =
        GENERATE(as<std::string>{}, "cube { size(0.5,0.1,0.5); transform { translate(0,5,0); } } ",
                 "cube { size(0.5,0.1,0.5); transform { translate(0,1,0); } } ",
                 "cube { size(0.5,0.1,0.5); transform { translate(0,3,0); } priority(1); } ",
                 "intersection { plane { transform { translate(0,1,0); } } } with { cube { size(0.5,9,0.5); } } ",
                 "intersection { plane { transform { translate(0,3,0); } } } with { cube { size(0.5,9,0.5); } } ");
    CAPTURE(opaque);
    TracedScene scene(over_floor(glass_ball + opaque));
    CHECK(is_black(shadow_at(scene, 0)));
    CHECK(largest_difference(shadow_at(scene, 0.8), power(rose_colour, 1.2)) <= 1e-13);
}

TEST_CASE("Light within glass is absorbed from where it starts, and what lies beyond it does not matter") {
    TracedScene scene(over_floor("sphere { transform { translate(0,3,0); } " + solid(rose) +
                                     "} cube { size(0.5,0.1,0.5); transform { translate(0,6,0); } } ",
                                 "point { location(0,3.5,0); intensity(12.25); }"));
    CHECK(largest_difference(shadow_at(scene, 0), power(rose_colour, 1.5)) <= 1e-13);
}

TEST_CASE("A face returns its shares of lit, mirrored and refracted light") {
    // Glass without end: what enters is absorbed. Looked at along the light, so that S = 1 and D = 0.
    TracedScene scene(
        "background(1,1,1); lights { ambient { intensity(0.5); } direct { direction(0,-1,0); intensity(2); } } objects { "
        "halfspace { "
        "material { solid { refraction(1.5); colour(0.5,0.25,0); opacity(0.3); reflection(0.2); shininess(40); } } } }");
    const Colour seen = scene.colour({0, 3, 0}, {0, -1, 0});
    const auto expected = [](double m) {
        const double highlight = 2, local = 0.5 * m + highlight, mirrored = 1, fresnel = 0.04;
        const double surface = 0.3 * local + 0.7 * (highlight + fresnel * mirrored);
        return 0.8 * surface + 0.2 * mirrored;
    };
    CHECK(largest_difference(seen, {expected(0.5), expected(0.25), expected(0)}) <= 1e-15);

    TracedScene metal(
        "background(1,1,1); lights { ambient { intensity(0.5); } } objects { halfspace { material { solid { colour(0.5,0.25,0); "
        "reflection(0.2); } } } }");
    CHECK(largest_difference(metal.colour({0, 3, 0}, {0, -1, 0}), {0.4, 0.3, 0.2}) <= 1e-15);
}

TEST_CASE("Paths that are too deep or count too little return the background") {
    const std::string mirrors =
        "objects { halfspace { material { solid { reflection(0.5); colour(0,0,0); } } } "
        "halfspace { transform { rotx(180deg); translate(0,2,0); } material { solid { reflection(0.5); colour(0,0,0); } } } }"
        "background(1,1,1); lights { ambient {} } ";
    const auto seen = [&](const std::string& settings) {
        return TracedScene(mirrors + settings).colour({0, 1, 0}, {0, -1, 0}).g;
    };
    CHECK(seen("render { depth(0); }") == 0.5);
    CHECK(seen("render { depth(3); }") == 0.0625);
    CHECK(seen("render { depth(50); cutoff(0.1); }") == 0.0625);  // 1/8 still counts enough
    CHECK(seen("render { depth(50); cutoff(0); }") == std::pow(0.5, 51));
}

TEST_CASE("Paths that count too little for the error asked for end sooner") {
    const auto seen = [](const std::string& settings, std::optional<double> error, std::optional<int> samples = {}) {
        const auto built = build(
            "camera { location(0, 1, 0); look_at(0, 0, 0); } background(1,1,1); lights { ambient {} } objects { "
            "halfspace { material { solid { reflection(0.5); colour(0,0,0); } } } "
            "halfspace { transform { rotx(180deg); translate(0,2,0); } material { solid { reflection(0.5); colour(0,0,0); } } } "
            "} "
            "render { depth(50); " +
            settings + " }");
        REQUIRE(built->scene);
        const auto world = prepare_world(*built->scene, built->messages);
        Frame frame(4, 4, {});
        RenderOptions options;
        options.error = error, options.samples = samples;
        REQUIRE(render(*world, *built->scene, frame, options).complete);
        return frame.pixel(Layer::colour, 1, 2)[1];
    };
    // The n-th path counts for 2^-n, and the first that is left out for the background.
    CHECK(seen("", 0.004) == 0x1p-11f);
    CHECK(seen("", 0.001) == 0x1p-11f);
    CHECK(seen("", 0.1) == 0x1p-6f);
    CHECK(seen("error(0.4);", {}) == 0x1p-4f);
    CHECK(seen("cutoff(0.2);", 0.1) == 0x1p-3f);
    CHECK(seen("error(0.4);", {}, 1) == 0x1p-11f);
}
