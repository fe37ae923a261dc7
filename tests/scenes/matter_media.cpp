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
void check_stretches(const TracedRay& ray, Stretches& stretches) {
    std::map<std::uint64_t, const PathEvent*> last;  // of each branch so far
    for (const PathEvent& event : ray.events) {
        double began_in = 1;  // the camera stands in empty space
        if (const auto same = last.find(event.branch); same != last.end())
            began_in = same->second->index_behind;
        else if (const auto parent = last.find(event.branch / 2); parent != last.end())
            began_in = event.branch % 2 == 1 ? parent->second->index_behind : parent->second->index_before;
        ++stretches.checked;
        stretches.broken += event.index_before != began_in;
        last[event.branch] = &event;
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

TEST_CASE("Every stretch of a path ends in the matter that it began in") {
    const std::string texture =
        GENERATE(as<std::string>{}, "checkers { " + a + air + "} ", "rings { " + a + b + "} ", "rings { " + a + b + "axis(y); } ",
                 "checkers { rings { " + a + b + "transform { scale(0.4); } } " + c + "transform { rotx(0.5); roty(0.3); } } ",
                 "noise { " + a + b + c + "transform { scale(0.5); } } ",
                 "noise { " + a + b + b + "band(0.1,0.1); transform { scale(0.5); } } ",
                 "turbulence { amount(0.4); octaves(3); rings { " + a + b + "} } ",
                 "turbulence { amount(0.4); octaves(2); checkers { " + a + b + "} } ");
    const Setting setting = GENERATE(Setting{1, 0, 8}, Setting{1e-6, 0, 8}, Setting{1e6, 0, 8}, Setting{1, 1e6, 8},
                                     Setting{1, 0, 1e5}, Setting{1e3, 1e9, 1e4});
    CAPTURE(texture, setting.scale, setting.offset, setting.distance);
    TracedScene scene(
        settings +
        fmt::format("objects {{ union {{ intersection {{ cube {{ size(2,2,2); }} }} with {{ sphere {{ radius(2.5); }} }} "
                    "material {{ {} }} transform {{ rotate(1,2,3, 0.8); scale({}); translate({},{},0); }} }} }}",
                    texture, setting.scale, setting.offset, setting.offset));
    const Stretches stretches =
        stretches_in(scene, 100, {setting.offset, setting.offset, 0}, 2 * setting.scale, setting.distance);
    CAPTURE(stretches.checked);
    CHECK(stretches.checked > 400);
    CHECK(stretches.broken == 0);
}
