// SPDX-License-Identifier: MIT
//
// What holds for every light: finite wherever it is asked, with directions of unit length, and gentle with numbers that
// square beyond the range of doubles.

#include <cmath>

#include "conformance/instances.h"
#include "kernel/interfaces/light.h"
#include "support/catch.h"

namespace lapidary::test {
namespace {

constexpr double u = 0x1p-53;

std::vector<Point> places(Random& random) {
    std::vector<Point> all{{0, 0, 0}, {0, 0, 1}, {0, 0, -1}, {1e-160, 0, 0}, {1e155, -1e155, 1e155}, {0x1p-1074, 0, 0}};
    for (int i = 0; i < 50; ++i) all.push_back(to_point(random.magnitude(-8, 8) * random.direction()));
    return all;
}

void check_illumination(const Light& light, const Point& place, const LightSample& sample) {
    const Illumination lit = light.toward(place, sample);
    CAPTURE(place.x, place.y, place.z, sample.u, sample.v);
    CHECK(is_finite(lit.radiance));
    CHECK((lit.radiance.r >= 0 && lit.radiance.g >= 0 && lit.radiance.b >= 0));
    if (is_black(lit.radiance)) return;
    CHECK(lit.distance > 0);
    if (light.is_ambient())
        CHECK(lit.direction == Vector{0, 0, 0});
    else
        CHECK(std::fabs(length(lit.direction) - 1) <= 4 * u);
}

}  // namespace

TEST_CASE("every light is finite everywhere") {
    Random random(91);
    for (const std::string& keyword : registry().keywords(PluginKind::light)) {
        const Plugin& p = plugin(PluginKind::light, keyword);
        for (int i = 0; i < 40; ++i) {
            const auto light = random_light(p, random);
            CAPTURE(keyword, describe(dynamic_cast<const void*>(light.get()), p.schema()));
            for (const Point& place : places(random)) {
                check_illumination(*light, place, {});
                check_illumination(*light, place, {random.uniform(0, 1), random.uniform(0, 1)});
                check_illumination(*light, place, {0, 0});
            }
        }
    }
}

TEST_CASE("every light without extent is the same for every sample, and asked twice") {
    Random random(92);
    for (const std::string& keyword : registry().keywords(PluginKind::light)) {
        const Plugin& p = plugin(PluginKind::light, keyword);
        for (int i = 0; i < 40; ++i) {
            const auto light = random_light(p, random);
            CAPTURE(keyword, describe(dynamic_cast<const void*>(light.get()), p.schema()));
            const Point place = to_point(10 * random.direction());
            const LightSample sample{random.uniform(0, 1), random.uniform(0, 1)};
            const Illumination first = light->toward(place, sample), second = light->toward(place, sample);
            CHECK(
                (first.direction == second.direction && first.distance == second.distance && first.radiance == second.radiance));
            if (light->has_extent()) continue;
            const Illumination other = light->toward(place, {});
            CHECK((first.direction == other.direction && first.distance == other.distance && first.radiance == other.radiance));
        }
    }
}

}  // namespace lapidary::test
