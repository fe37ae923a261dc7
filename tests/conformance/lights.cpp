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

// Lights of every kind, so many of each.
template <typename Check>
void for_random_lights(int count, Random& random, Check check) {
    for (const std::string& keyword : registry().keywords(PluginKind::light)) {
        const Plugin& p = plugin(PluginKind::light, keyword);
        for (int i = 0; i < count; ++i) {
            const auto light = random_light(p, random);
            CAPTURE(keyword, describe(dynamic_cast<const void*>(light.get()), p.schema()));
            check(*light);
        }
    }
}

}  // namespace

TEST_CASE("every light is finite everywhere") {
    Random random(91);
    for_random_lights(40, random, [&](const Light& light) {
        for (const Point& place : places(random)) {
            check_illumination(light, place, {});
            check_illumination(light, place, {random.uniform(0, 1), random.uniform(0, 1)});
            check_illumination(light, place, {0, 0});
        }
    });
}

TEST_CASE("every light without extent is the same for every sample, and asked twice") {
    Random random(92);
    for_random_lights(40, random, [&](const Light& light) {
        const Point place = to_point(10 * random.direction());
        const LightSample sample{random.uniform(0, 1), random.uniform(0, 1)};
        const Illumination first = light.toward(place, sample), second = light.toward(place, sample);
        CHECK((first.direction == second.direction && first.distance == second.distance && first.radiance == second.radiance));
        if (light.has_extent()) return;
        const Illumination other = light.toward(place, {});
        CHECK((first.direction == other.direction && first.distance == other.distance && first.radiance == other.radiance));
    });
}

// Boxes of any size, many of them where light fades out.
TEST_CASE("no light comes into a box that it says it does not reach") {
    Random random(93);
    for_random_lights(400, random, [&](const Light& light) {
        for (int j = 0; j < 20; ++j) {
            const Point middle = to_point(random.magnitude(-2, 2) * random.direction());
            const double size = random.magnitude(-3, 2);
            const Vector half{size * random.uniform(0, 1), size * random.uniform(0, 1), size * random.uniform(0, 1)};
            if (light.may_reach({middle - half, middle + half})) continue;
            for (int k = 0; k < 20; ++k) {
                const auto corner_or_inside = [&] { return k < 10 ? random.below(2) * 2.0 - 1 : random.uniform(-1, 1); };
                const Vector within{half.x * corner_or_inside(), half.y * corner_or_inside(), half.z * corner_or_inside()};
                CAPTURE(middle.x, middle.y, middle.z, size, within.x, within.y, within.z);
                const LightSample sample{random.uniform(0, 1), random.uniform(0, 1)};
                CHECK(is_black(light.toward(middle + within, sample).radiance));
            }
        }
    });
}

TEST_CASE("a spot reaches what its cone meets, and not what lies far beside it") {
    const auto spot = plugin(PluginKind::light, "spot").create_light();  // along z, 30 degrees to each side
    const auto box = [](const Point& middle, double half) {
        return Bounds{middle - Vector{half, half, half}, middle + Vector{half, half, half}};
    };
    CHECK(spot->may_reach(box({0, 0, 5}, 1)));
    CHECK(spot->may_reach(box({0, 0, 0}, 1)));
    CHECK(spot->may_reach(box({4, 0, 5}, 1)));
    CHECK(spot->may_reach(Bounds::everything()));
    CHECK_FALSE(spot->may_reach(box({8, 0, 5}, 1)));
    CHECK_FALSE(spot->may_reach(box({0, 0, -5}, 1)));
}

}  // namespace lapidary::test
