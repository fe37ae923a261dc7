// SPDX-License-Identifier: MIT
//
// Camera rays against 200-bit arithmetic: the plane that is sharp, the size of blur, extreme fields of view
// (T85 to T88 of the numerics notes).

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <numbers>
#include <random>
#include <set>

#include "kernel/render/camera_rays.h"
#include "support/catch.h"
#include "support/measurement.h"

using namespace lapidary;

namespace {

using Precise = boost::multiprecision::number<boost::multiprecision::cpp_bin_float<200, boost::multiprecision::digit_base_2>>;

struct PrecisePoint {
    Precise x, y, z;
};

// Where a ray meets the plane z = `depth`, its origin taken in both parts.
PrecisePoint at_depth(const Ray& ray, const Precise& depth) {
    const PrecisePoint origin{Precise(ray.origin.anchor.x) + ray.origin.offset.x,
                              Precise(ray.origin.anchor.y) + ray.origin.offset.y,
                              Precise(ray.origin.anchor.z) + ray.origin.offset.z};
    const Precise t = (depth - origin.z) / ray.direction.z;
    return {origin.x + t * ray.direction.x, origin.y + t * ray.direction.y, depth};
}

double distance(const PrecisePoint& a, const PrecisePoint& b) {
    return static_cast<double>(Precise(hypot(Precise(a.x - b.x), Precise(a.y - b.y))));
}

Camera lens(double radius, double focus) {
    Camera camera;
    camera.aperture = 2 * radius;
    camera.focus = focus;
    camera.points = 0;
    return camera;
}

}  // namespace

TEST_CASE("T85: all lens rays of a place meet in one point of the sharp plane") {
    struct Case {
        double radius, focus;
    };
    std::mt19937 random(85);
    std::uniform_real_distribution<double> uniform(0, 1);
    for (const auto& [radius, focus] : {Case{0.1, 10}, Case{1e-9, 1e9}, Case{1e-10, 1e-9}, Case{100, 1}}) {
        const CameraRays camera(lens(radius, focus), 640, 480);
        test::Measurement apart({"T85", "lens rays of a place, in the sharp plane", "u of the way", 4});
        for (int i = 0; i < 1000; ++i) {
            const double x = 640 * uniform(random), y = 480 * uniform(random);
            const PrecisePoint centre = at_depth(camera.ray(x, y), focus);
            const PrecisePoint off = at_depth(camera.ray(x, y, disc_from_square({uniform(random), uniform(random)})), focus);
            // Four roundings of a direction, over the way from the lens; a wide lens is itself part of the way.
            apart.record(distance(centre, off) / (0x1p-53 * std::max(focus, radius)));
        }
    }
}

TEST_CASE("T87: the blur in the sharp plane is the lens seen from the object through it") {
    const CameraRays camera(lens(0.1, 10), 640, 480);
    struct Case {
        double depth, blur;
    };
    test::Measurement measured({"T87", "radius of the blur", "length", 1e-12});
    for (const auto& [depth, blur] : {Case{5, 0.1}, Case{20, 0.05}, Case{1e12, 0.099999999999}}) {
        // The ray through the lens's edge that meets the axis at `depth` crosses the sharp plane at the blur's radius.
        const Ray edge = camera.ray(320, 240, {1, 0});
        const Precise x = at_depth(edge, depth).x;          // where a ray aimed at the axis in focus arrives
        const Precise magnified = x * 10 / Precise(depth);  // seen back through the lens's centre
        measured.record(static_cast<double>(Precise(abs(magnified))) - blur);
    }
}

TEST_CASE("T88: extreme fields of view keep unit directions and distinct neighbours") {
    test::Measurement unit({"T88", "length of a direction less 1", "u", 9}),
        exact({"T88", "direction in an extreme field of view", "component", 1e-14}),
        distinct({"T88", "distinct neighbours", "", 0});
    for (const double degrees : {1e-9, 179.9999}) {
        Camera description;
        description.screen_centre = {0.3, -0.2, 0.93};
        description.angle = degrees * std::numbers::pi / 180;
        const CameraRays camera(description, 640, 480);
        const Precise width = 2 * tan(Precise(*description.angle) / 2);
        const Precise height = width * 480 / 640;
        for (int j = 0; j < 480; j += 31) {
            std::set<std::tuple<double, double, double>> directions;
            for (int i = 0; i < 640; ++i) {
                const Vector d = camera.ray(i + 0.5, j + 0.5).direction;
                unit.record((length(d) - 1) / 0x1p-53);
                directions.insert({d.x, d.y, d.z});

                // The same direction from the same axes, in 200 bits.
                const Precise right = ((i + Precise(0.5)) / 640 - Precise(0.5)) * width;
                const Precise up = (Precise(0.5) - (j + Precise(0.5)) / 480) * height;
                const auto component = [&](double f, double r, double u) -> Precise { return f + right * r + up * u; };
                const Precise x = component(camera.forward().x, camera.right().x, camera.up().x);
                const Precise y = component(camera.forward().y, camera.right().y, camera.up().y);
                const Precise z = component(camera.forward().z, camera.right().z, camera.up().z);
                const Precise size = sqrt(x * x + y * y + z * z);
                exact.record(static_cast<double>(Precise(x / size - d.x)));
                exact.record(static_cast<double>(Precise(y / size - d.y)));
                exact.record(static_cast<double>(Precise(z / size - d.z)));
            }
            distinct.expect(directions.size() == 640);
        }
    }
}

TEST_CASE("a camera far away keeps a small lens") {
    Camera description = lens(1e-9, 1);
    description.location = {1e9, -1e9, 1e9};
    description.screen_centre = {1e9, -1e9, 1e9 + 1};
    const CameraRays camera(description, 64, 48);
    const Ray ray = camera.ray(32, 24, {1, 0});
    CHECK(ray.origin.offset.x == 1e-9);
    CHECK(ray.direction.x == Approx(-1e-9));
}
