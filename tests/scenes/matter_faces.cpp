// SPDX-License-Identifier: MIT
//
// What faces show: the texture of the matter that they cut, their own material or the innards (section 6.3), relief; and
// what scenes of opaque matter are spared.

#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <random>
#include <string>

#include "kernel/render/medium.h"
#include "sdk/lapidary/noise.h"
#include "support/catch.h"
#include "support/traced_scene.h"

using namespace lapidary;
using namespace lapidary::test;

namespace {

// In light that comes from everywhere every face has the colour of its matter.
std::string evenly_lit(const std::string& objects) { return "lights { ambient { intensity(1); } } objects { " + objects + " }"; }

std::string paint(const std::string& colour) { return "material { solid { colour(" + colour + "); } } "; }

const Colour red{1, 0, 0}, green{0, 1, 0};
const std::string red_paint = paint("1,0,0"), green_paint = paint("0,1,0");

// A random unit vector.
Vector direction_from(std::mt19937& random) {
    std::uniform_real_distribution<double> uniform(-1, 1);
    for (;;) {
        const Vector v{uniform(random), uniform(random), uniform(random)};
        if (length(v) > 0.1 && length(v) < 1) return normalize(v);
    }
}

}  // namespace

TEST_CASE("Cut open, a solid shows at every point what was there before") {
    const std::string texture = GENERATE(
        as<std::string>{}, "sine { colour(1,0.5,0); colour2(0,0.25,1); bump(0); transform { scale(0.1); } } ",
        "checkers { solid { colour(1,0,0); } solid { colour(0,0,1); } transform { scale(0.3); rotx(0.4); } } ",
        "rings { solid { colour(1,0,0); } sine { colour(0,1,0); bump(0); transform { scale(0.05); } } transform { scale(0.2); "
        "rotz(0.4); } } ",
        "noise { solid { colour(1,0,0); } solid { colour(0,1,0); } solid { colour(0,0,1); } transform { scale(0.3); } } ",
        "turbulence { rings { solid { colour(1,0,0); } solid { colour(0,0,1); } axis(y); } transform { scale(0.2); } } ");
    CAPTURE(texture);
    const std::string place = "transform { rotate(1,2,3, 0.4); scale(1.5); translate(0.1,0.2,0.3); } ";
    const std::string body =
        "union { sphere {} cube { transform { scale(0.8); translate(0.4,0.1,0); } } material { " + texture + "} } ";
    TracedScene whole(evenly_lit("union { " + body + place + "} "));
    TracedScene cut(evenly_lit("union { subtraction { " + body +
                               "} with { cube { transform { translate(0.7,0.8,-0.9); } } "
                               "sphere { transform { scale(0.6); translate(-0.5,0,-0.7); } } } " +
                               place + "} "));
    const MaterialInstance* matter = nullptr;
    for (const MaterialInstance& instance : cut.world().materials)
        if (!instance.is_uniform()) matter = &instance;
    REQUIRE(matter);

    std::mt19937 random(2);
    int common = 0, on_cuts = 0, different = 0, wrong = 0;
    for (int i = 0; i < 1500; ++i) {
        const Point origin = Point{} + 6 * direction_from(random);
        const Vector way = Point{} + 0.9 * direction_from(random) - origin;
        const RaySample before = whole.sample(origin, way), after = cut.sample(origin, way);
        if (after.object == 0) continue;
        if (before.depth == after.depth) {
            ++common;
            different += !(before.colour == after.colour);
        } else {
            ++on_cuts;
            const Matter there = matter_beside(*matter, {after.position, 0}, -to_vector(after.normal));
            wrong += largest_difference(after.colour, there.colour) > 1e-9;
        }
    }
    CAPTURE(common, on_cuts);
    CHECK(common > 300);
    CHECK(on_cuts > 200);
    CHECK(different == 0);
    CHECK(wrong == 0);
}

TEST_CASE("6.3 A cut face shows the cutter's own material, else that of what it cuts") {
    const auto seen = [](const std::string& objects) { return TracedScene(evenly_lit(objects)).colour({0, 0, -5}, {0, 0, 1}); };
    const std::string die = "cube { " + red_paint + "} ";
    const std::string placed = "transform { scale(0.5); translate(0,0,-1); } ";

    CHECK(seen("subtraction { " + die + "} with { sphere { " + placed + green_paint + "} } ") == green);
    CHECK(seen("subtraction { " + die + "} with { sphere { " + placed + "} } ") == red);
    // A material around the operand counts as its own; one around the whole is a default only.
    CHECK(seen("subtraction { " + die + "} with { union { sphere { " + placed + "} " + green_paint + "} } ") == green);
    CHECK(seen("subtraction { cube {} } with { sphere { " + placed + green_paint + "} } ") == green);
    CHECK(seen("union { subtraction { cube {} } with { sphere { " + placed + "} } " + red_paint + "} ") == red);
    // The right operand of an intersection is a cutter, too.
    const std::string within = "transform { scale(0.5); } ";
    CHECK(seen("intersection { " + die + "} with { sphere { " + within + green_paint + "} } ") == green);
    CHECK(seen("intersection { " + die + "} with { sphere { " + within + "} } ") == red);
    // The innards are the medium at the very place.
    CHECK(seen("subtraction { union { cube { " + green_paint + "} cube { transform { translate(2,0,0); } " + red_paint +
               "} } } with { cube { transform { scale(0.5); translate(1.2,0,-1); } } } ") == green);
}

TEST_CASE("6.3 Where faces coincide the left operand's is seen") {
    const auto seen = [](const std::string& objects) {
        return TracedScene(evenly_lit(objects)).colour({0.25, 0.25, -5}, {0, 0, 1});
    };
    const std::string operation = GENERATE(as<std::string>{}, "union", "intersection");
    const std::string a = "cube { " + red_paint + "} ";
    const std::string b =
        "cube { size(0.5,0.5,0.5); transform { rotx(0.3); rotx(-0.3); translate(0,0,-0.5); } " + green_paint + "} ";
    CHECK(seen(operation + " { " + a + "} with { " + b + "} ") == red);
    CHECK(seen(operation + " { " + b + "} with { " + a + "} ") == green);
    CHECK(seen(a + b) == red);
    CHECK(seen(b + a) == green);
}

TEST_CASE("Scenes of opaque matter never enter the march, nor send rays that nothing asks for") {
    TracedScene scene(
        "lights { ambient {} direct { direction(1,-1,1); } } objects { subtraction { cube { material { checkers { noise { solid "
        "{} solid {} solid {} } "
        "sine { bump(2); } transform { scale(0.2); } } } } } with { sphere { radius(1.2); } } halfspace { transform { "
        "translate(0,-1,0); } } }");
    std::mt19937 random(2);
    for (int i = 0; i < 300; ++i) {
        const Point origin = Point{} + 6 * direction_from(random);
        (void)scene.colour(origin, Point{} - origin + 0.5 * direction_from(random));
    }
    CHECK_FALSE(scene.world().features.transparency);
    CHECK(scene.statistics().march_steps == 0);
    CHECK(scene.statistics().refracted_rays == 0);
    CHECK(scene.statistics().mirrored_rays == 0);
    CHECK(scene.statistics().shadow_rays > 0);
}

namespace {

// The shading normal by its definition, from differences of a height over the world.
Vector bent(const Vector& n, const Point& p, const std::function<double(const Point&)>& height) {
    constexpr double step = 1e-6;
    const auto slope = [&](const Vector& axis) { return (height(p + step * axis) - height(p - step * axis)) / (2 * step); };
    const Vector g{slope({1, 0, 0}), slope({0, 1, 0}), slope({0, 0, 1})};
    return normalize(n - (g - dot(g, n) * n));
}

}  // namespace

TEST_CASE("Relief bends the shading normal by the slope of its height") {
    // A ball, seen from outside at steep angles, so that nothing is bent back to the horizon.
    const bool is_noise = GENERATE(false, true);
    CAPTURE(is_noise);
    // From the world to the texture: p = q scaled by 0.5, turned about z by 0.6, moved by 0.2 along x.
    const std::string place = "transform { scale(0.5); rotz(0.6); translate(0.2,0,0); } ";
    const auto to_texture = [](const Point& p) {
        const double x = p.x - 0.2, c = std::cos(0.6), s = std::sin(0.6);
        return Point{(c * x + s * p.y) / 0.5, (c * p.y - s * x) / 0.5, p.z / 0.5};
    };
    TracedScene scene(evenly_lit(is_noise ? "sphere { material { solid { bump(0.2); relief(\"noise\", 3); " + place + "} } } "
                                          : "sphere { material { sine { bump(0.2); " + place + "} } } "));
    const auto height = [&](const Point& p) {
        const Point q = to_texture(p);
        return 0.2 * (is_noise ? noise({3 * q.x, 3 * q.y, 3 * q.z}) : std::sin(q.x));
    };
    std::mt19937 random(6);
    double worst = 0, most_bent = 0;
    for (int i = 0; i < 300; ++i) {
        const Vector outward = direction_from(random);
        const RaySample sample = scene.sample(Point{} + 3 * outward, -outward);
        REQUIRE(sample.object == 1);
        const Vector n = to_vector(sample.position);
        worst = std::max(worst, length(to_vector(sample.normal) - bent(n, sample.position, height)));
        most_bent = std::max(most_bent, length(to_vector(sample.normal) - n));
    }
    CHECK(most_bent > 0.1);
    CHECK(worst < 1e-8);
}

TEST_CASE("No mirror direction points below the surface, however strong the relief and flat the view") {
    TracedScene scene(
        "lights { ambient { intensity(1); } } render { depth(1); } objects { halfspace { material { sine { reflection(0.9); "
        "bump(20); "
        "transform { scale(0.1); } } } } " +
        wall + "}");
    std::mt19937 random(8);
    std::uniform_real_distribution<double> uniform(-1, 1);
    int mirrored = 0;
    for (int i = 0; i < 500; ++i) {
        const Vector direction =
            normalize(Vector{uniform(random), -std::pow(10, -4 * std::fabs(uniform(random))), uniform(random)});
        const TracedRay ray = scene.trace(Point{uniform(random), 0, 0} - 2 * direction, direction);
        REQUIRE(ray.events.size() == 2);
        CHECK(dot(ray.sample.normal, direction) <= 1e-15);  // never away from the viewer
        const PathEvent& event = ray.events[1];
        ++mirrored;
        CHECK(event.direction.y >= 0);
        CHECK(event.point.rounded().y >= 0);
        CHECK(std::fabs(length(event.direction) - 1) <= 1e-15);
    }
    CHECK(mirrored == 500);
}

TEST_CASE("No refracted direction points above the surface, however strong the relief and flat the view") {
    TracedScene scene(
        "lights { ambient { intensity(1); } } render { depth(1); cutoff(0); } objects { cube { size(40,1,40); transform { "
        "translate(0,-1,0); } "
        "material { sine { refraction(1.5); bump(20); transform { scale(0.1); } } } } " +
        wall + "}");
    std::mt19937 random(8);
    std::uniform_real_distribution<double> uniform(-1, 1);
    int refracted = 0;
    for (int i = 0; i < 500; ++i) {
        const Vector direction =
            normalize(Vector{uniform(random), -std::pow(10, -4 * std::fabs(uniform(random))), uniform(random)});
        for (const PathEvent& event : scene.trace(Point{uniform(random), 0, 0} - 2 * direction, direction).events) {
            if (event.branch == 2) CHECK(event.direction.y >= 0);
            if (event.branch == 3) CHECK(event.direction.y <= 0);
            refracted += event.branch == 3;
        }
    }
    CHECK(refracted > 300);
}
