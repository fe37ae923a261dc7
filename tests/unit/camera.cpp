// SPDX-License-Identifier: MIT
//
// Camera rays: the view of section 10 of the scene language.

#include "kernel/render/camera_rays.h"

#include <numbers>

#include "support/catch.h"

using namespace lapidary;

namespace {

void check_same(const Vector& a, const Vector& b, double tolerance = 1e-15) {
    INFO(a.x << ' ' << a.y << ' ' << a.z << " and " << b.x << ' ' << b.y << ' ' << b.z);
    CHECK(length(a - b) <= tolerance);
}

Camera looking(const Point& from, const Point& to, const Vector& up = {0, 1, 0}) {
    Camera camera;
    camera.location = from;
    camera.screen_centre = to;
    camera.up = up;
    return camera;
}

}  // namespace

TEST_CASE("the default camera looks along +z, x to the right, y up") {
    const CameraRays camera(Camera{}, 640, 480);
    check_same(camera.right(), {1, 0, 0});
    check_same(camera.up(), {0, 1, 0});
    check_same(camera.forward(), {0, 0, 1});
    check_same(camera.ray(320, 240).direction, {0, 0, 1});
    // The screen is 1 high and 4/3 wide, one unit away.
    check_same(camera.ray(640, 240).direction, normalize(Vector{2.0 / 3, 0, 1}));
    check_same(camera.ray(320, 0).direction, normalize(Vector{0, 0.5, 1}));
    CHECK(camera.ray(0, 0).origin.rounded() == Point{0, 0, 0});
}

TEST_CASE("pixels are sampled at ((i+u)/W - 1/2) w to the right and (1/2 - (j+v)/H) h up") {
    Camera description = looking({1, 2, 3}, {1, 2, 5});
    description.screen_width = 3;
    description.screen_height = 5;
    description.screen_height_given = true;
    const CameraRays camera(description, 7, 11);
    check_same(camera.ray(2.25, 9.5).direction, normalize(Vector{(2.25 / 7 - 0.5) * 3, (0.5 - 9.5 / 11) * 5, 2}));
}

TEST_CASE("a width alone sets the height by the resolution's aspect") {
    Camera description;
    description.screen_width = 2;
    const CameraRays camera(description, 200, 100);
    check_same(camera.ray(200, 0).direction, normalize(Vector{1, 0.5, 1}));
}

TEST_CASE("an angle is the horizontal field of view") {
    Camera description = looking({0, 0, 0}, {0, 0, 7});
    description.angle = std::numbers::pi / 2;
    const CameraRays camera(description, 200, 100);
    check_same(camera.ray(200, 50).direction, normalize(Vector{1, 0, 1}));
    check_same(camera.ray(100, 0).direction, normalize(Vector{0, 0.5, 1}));
}

TEST_CASE("looking straight along up, +z is up; where z is the view itself, +y") {
    const CameraRays down(looking({0, 5, 0}, {0, 4, 0}), 100, 100);
    check_same(down.up(), {0, 0, 1});
    check_same(down.right(), {1, 0, 0});
    const CameraRays up(looking({0, 0, 0}, {0, 1, 0}), 100, 100);
    check_same(up.up(), {0, 0, 1});
    check_same(up.right(), {-1, 0, 0});
    const CameraRays along_z(looking({0, 0, 0}, {0, 0, 1}, {0, 0, 3}), 100, 100);
    check_same(along_z.up(), {0, 1, 0});
    const CameraRays rolled(looking({0, 0, 0}, {0, 0, 1}, {1, 0, 0}), 100, 100);
    check_same(rolled.up(), {1, 0, 0});
    check_same(rolled.right(), {0, -1, 0});
}

TEST_CASE("a camera without a view looks along +z instead of nowhere") {
    const CameraRays camera(looking({1, 1, 1}, {1, 1, 1}), 10, 10);
    check_same(camera.ray(5, 5).direction, {0, 0, 1});
}

TEST_CASE("orthographic rays are parallel, a pixel's width apart") {
    Camera description = looking({0, 0, -5}, {0, 0, 0});
    description.projection = Camera::Projection::orthographic;
    description.screen_height = 10;
    const CameraRays camera(description, 100, 50);
    const Ray corner = camera.ray(0, 0);
    check_same(corner.direction, {0, 0, 1});
    check_same(to_vector(corner.origin.rounded()), {-10, 5, -5}, 1e-14);
    CHECK(camera.pixel_footprint() == 0);
}

TEST_CASE("without an aperture, or with one lens point, rays are a pinhole's bit for bit") {
    Camera pinhole = looking({0.1, 0.2, 0.3}, {3, 1, 4});
    pinhole.points = 0;
    pinhole.aperture = 0;
    Camera centre = pinhole;
    centre.aperture = 0.5;
    centre.points = 1;
    const CameraRays a(pinhole, 64, 48), b(centre, 64, 48);
    CHECK_FALSE(a.has_lens());
    CHECK_FALSE(b.has_lens());
    for (int i = 0; i < 64; ++i) {
        const SampleKey key = sample_key(i, 7, static_cast<std::uint32_t>(i));
        const Ray ra = a.ray(i, 7.3, a.lens_point(key)), rb = b.ray(i, 7.3, b.lens_point(key));
        CHECK(ra.direction == rb.direction);
        CHECK(ra.origin.rounded() == Point{0.1, 0.2, 0.3});
        CHECK(rb.origin.rounded() == Point{0.1, 0.2, 0.3});
    }
}

TEST_CASE("lens points calculated beforehand are taken in turn, the centre first") {
    Camera description;
    description.points = 5;
    const CameraRays camera(description, 64, 48);
    CHECK(camera.lens_points() == 5);
    CHECK(camera.lens_point(sample_key(3, 4, 0)).x == 0);
    for (std::uint32_t round = 0; round < 4; ++round) {
        double x = 0, y = 0;
        for (std::uint32_t i = 0; i < 5; ++i) {
            const DiscPoint p = camera.lens_point(sample_key(3, 4, 5 * round + i));
            x += p.x, y += p.y;
        }
        double all_x = 0, all_y = 0;
        for (const DiscPoint& p : even_disc_points(5)) all_x += p.x, all_y += p.y;
        CHECK(x == Approx(all_x));
        CHECK(y == Approx(all_y));
    }
}

TEST_CASE("a new lens point for every ray fills the lens evenly") {
    Camera description;
    description.points = 0;
    const CameraRays camera(description, 64, 48);
    CHECK(camera.lens_points() == 0);
    double r2 = 0;
    constexpr std::uint32_t count = 4096;
    for (std::uint32_t i = 0; i < count; ++i) {
        const DiscPoint p = camera.lens_point(sample_key(1, 1, i));
        r2 += (p.x * p.x + p.y * p.y) / count;
    }
    CHECK(r2 == Approx(0.5).margin(1e-3));
}
