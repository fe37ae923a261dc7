// SPDX-License-Identifier: MIT
//
// A law of paths: what a stretch of a path ends in is what it began in. A boundary that is missed, met twice or met from the
// wrong side breaks it, whatever the texture.

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <random>
#include <string>

#include "support/catch.h"
#include "support/traced_scene.h"

using namespace lapidary;
using namespace lapidary::test;

namespace {

struct Stretches {
    int checked = 0, broken = 0;
};

// The index before each face is that which the path came to at the face before it: behind it for a path that went through,
// before it for one that was mirrored.
void check_stretches(const TracedRay& ray, Stretches& stretches, bool mirrored_too = true) {
    std::map<std::uint64_t, const PathEvent*> last;  // of each branch so far
    for (const PathEvent& event : ray.events) {
        double began_in = 1;  // the camera stands in empty space
        if (const auto same = last.find(event.branch); same != last.end())
            began_in = same->second->index_behind;
        else if (const auto parent = last.find(event.branch / 2); parent != last.end())
            began_in = event.branch % 2 == 1 ? parent->second->index_behind : parent->second->index_before;
        const bool is_fresh_from_mirror = event.branch % 2 == 0 && !last.contains(event.branch);
        last[event.branch] = &event;
        if (is_fresh_from_mirror && !mirrored_too) continue;
        ++stretches.checked;
        stretches.broken += event.index_before != began_in;
    }
}

Stretches stretches_in(TracedScene& scene, int rays, const Point& centre, double size, double distance) {
    std::mt19937_64 random(17);
    std::uniform_real_distribution<double> uniform(-1, 1);
    const auto in_ball = [&] {
        for (;;) {
            const Vector v{uniform(random), uniform(random), uniform(random)};
            if (length(v) < 1 && length(v) > 0.01) return v;
        }
    };
    Stretches stretches;
    for (int i = 0; i < rays; ++i) {
        const Point origin = centre + distance * size * normalize(in_ball());
        const Point aim = centre + size * in_ball();
        check_stretches(scene.trace(origin, aim - origin), stretches);
    }
    return stretches;
}

std::string glass_of(double index) { return fmt::format("solid {{ refraction({}); }} ", index); }
const std::string a = glass_of(1.5), b = glass_of(1.25), c = glass_of(1.75), air = glass_of(1);

const std::string settings = "render { depth(6); cutoff(0.001); } ";

struct Setting {
    double scale, offset, distance;  // how far away the camera is, in sizes of the scene
};

}  // namespace

// The same content in another size, place and distance from the camera.
Stretches check_content(const std::string& content, const Setting& setting) {
    TracedScene scene(
        settings + fmt::format("objects {{ union {{ {} transform {{ rotate(1,2,3, 0.8); scale({}); translate({},{},0); }} }} }}",
                               content, setting.scale, setting.offset, setting.offset));
    return stretches_in(scene, 100, {setting.offset, setting.offset, 0}, 2 * setting.scale, setting.distance);
}

Setting any_setting() {
    return GENERATE(Setting{1, 0, 8}, Setting{1e-6, 0, 8}, Setting{1e6, 0, 8}, Setting{1, 1e6, 8}, Setting{1, 0, 1e5},
                    Setting{1e3, 1e9, 1e4});
}

TEST_CASE("Every stretch of a path ends in the matter that it began in") {
    const std::string texture =
        GENERATE(as<std::string>{}, "checkers { " + a + air + "} ", "rings { " + a + b + "} ", "rings { " + a + b + "axis(y); } ",
                 "checkers { rings { " + a + b + "transform { scale(0.4); } } " + c + "transform { rotx(0.5); roty(0.3); } } ",
                 "noise { " + a + b + c + "transform { scale(0.5); } } ",
                 "noise { " + a + b + b + "band(0.1,0.1); transform { scale(0.5); } } ",
                 "turbulence { amount(0.4); octaves(3); rings { " + a + b + "} } ",
                 "turbulence { amount(0.4); octaves(2); checkers { " + a + b + "} } ");
    const Setting setting = any_setting();
    CAPTURE(texture, setting.scale, setting.offset, setting.distance);
    const Stretches stretches = check_content(
        "intersection { cube { size(2,2,2); } } with { sphere { radius(2.5); } } material { " + texture + "} ", setting);
    CAPTURE(stretches.checked);
    CHECK(stretches.checked > 400);
    CHECK(stretches.broken == 0);
}

TEST_CASE("Every stretch ends in the matter that it began in, in solids built of pieces") {
    const auto made_of = [](const std::string& matter) { return "material { " + matter + "} "; };
    const std::string content = GENERATE_COPY(
        // nested, one of the shells of air
        "sphere { " + made_of(a) + "} sphere { radius(1.5); " + made_of(air) + "} sphere { radius(2); " + made_of(b) + "} ",
        // side by side, with gaps and overlaps
        "cube { " + made_of(a) + "} cube { size(0.5,1,1); transform { rotx(0.7); rotx(-0.7); translate(1.5,-0.5,0); } " +
            made_of(b) + "} sphere { radius(1); transform { translate(0,1.5,0); } " + made_of(c) + "} ",
        // liquid in a glass
        "subtraction { cylinder { radius(1); height(3); " + made_of(a) +
            "} } with { cylinder { radius(0.9); height(4); } } "
            "cylinder { radius(0.9); height(2); transform { roty(1); } " +
            made_of(b) + "} ",
        // a glass ring, cut, with a core
        "subtraction { torus { radii(1.5,0.5); " + made_of(a) + "} } with { halfspace { transform { rotz(1); } } } sphere { " +
            made_of(c) + "} ",
        // a cone in a ball, of the same glass as the empty space
        "cone { " + made_of(air) + "} sphere { radius(2); " + made_of(b) + "} ");
    const Setting setting = any_setting();
    CAPTURE(content, setting.scale, setting.offset, setting.distance);
    const Stretches stretches = check_content(content, setting);
    CAPTURE(stretches.checked);
    CHECK(stretches.checked > 200);
    CHECK(stretches.broken == 0);
}

TEST_CASE("Through the edges of a texture rays go on into the region behind") {
    const std::string texture =
        GENERATE(as<std::string>{}, "checkers { " + a + b + "} ", "rings { " + a + b + "} ", "rings { " + a + b + "axis(y); } ",
                 "noise { " + a + b + c + "} ", "checkers { rings { " + a + b + "} " + c + "} ");
    TracedScene scene(settings + "objects { cube { size(2,2,2); material { " + texture + "} } } ");
    // Mirrored in an edge, a ray may go on in the region beside it: that is right, and left out.
    Stretches stretches;
    for (int x = -4; x <= 4; ++x)
        for (int y = -4; y <= 4; ++y)
            for (const Vector& direction :
                 {Vector{0.25, 0.25, 1}, Vector{0.5, -0.25, 1}, Vector{-0.5, -0.5, 0.5}, Vector{1, 0.5, -0.5}}) {
                const Point aim{x / 2.0, y / 2.0, 0};
                check_stretches(scene.trace(aim - 8 * direction, direction), stretches, false);
            }
    CAPTURE(texture, stretches.checked);
    CHECK(stretches.checked > 1000);
    CHECK(stretches.broken == 0);
}
