// SPDX-License-Identifier: MIT
#include "kernel/render/camera_rays.h"

#include <cmath>

namespace lapidary {

namespace {

// What stands to the right of a view with the given up; zero where the view runs along it.
Vector right_of(const Vector& up, const Vector& forward) {
    const Vector right = cross(normalize(up), forward);
    constexpr double shortest = 1e-12;  // below, the direction would be made of rounding errors
    return length(right) > shortest ? normalize(right) : Vector{};
}

}  // namespace

CameraRays::CameraRays(const Camera& camera, int width, int height)
    : projection_(camera.projection),
      location_(camera.location),
      picture_width_(width),
      picture_height_(height),
      focus_(camera.focus),
      lens_radius_(camera.aperture / 2),
      has_lens_(camera.aperture > 0 && camera.points != 1) {
    orient(camera);
    measure_screen(camera);
    if (has_lens_ && camera.points > 1) lens_points_ = even_disc_points(camera.points);
}

void CameraRays::orient(const Camera& camera) {
    const Vector view = camera.screen_centre - camera.location;
    forward_ = normalize(view);
    if (forward_ == Vector{}) forward_ = {0, 0, 1};
    screen_distance_ = dot(view, forward_);
    if (!(screen_distance_ > 0)) screen_distance_ = 1;

    // Looking straight along up, +z is up; where z is the view itself, +y.
    right_ = right_of(camera.up, forward_);
    if (right_ == Vector{}) right_ = right_of({0, 0, 1}, forward_);
    if (right_ == Vector{}) right_ = right_of({0, 1, 0}, forward_);
    up_ = normalize(cross(forward_, right_));
}

void CameraRays::measure_screen(const Camera& camera) {
    const double aspect = picture_width_ / picture_height_;
    const bool perspective = projection_ == Camera::Projection::perspective;
    const double unit = perspective ? screen_distance_ : 1;

    if (camera.angle) {
        screen_width_ = 2 * std::tan(*camera.angle / 2) * (perspective ? 1 : screen_distance_);
        screen_height_ = screen_width_ / aspect;
    } else if (camera.screen_width) {
        screen_width_ = *camera.screen_width / unit;
        screen_height_ = camera.screen_height_given ? camera.screen_height / unit : screen_width_ / aspect;
    } else {
        screen_height_ = camera.screen_height / unit;
        screen_width_ = screen_height_ * aspect;
    }
    if (perspective) pixel_footprint_ = std::atan(screen_height_ / picture_height_);
}

Ray CameraRays::ray(double x, double y, DiscPoint lens) const {
    Ray ray;
    if (projection_ == Camera::Projection::perspective) {
        ray.origin = location_;
        ray.direction = forward_ + aside(x, y);
    } else {
        ray.origin = TwoPartPoint(location_, aside(x, y));
        ray.direction = forward_;
    }
    if (has_lens_) {
        const Vector offset = (lens_radius_ * lens.x) * right_ + (lens_radius_ * lens.y) * up_;
        ray.origin.offset = ray.origin.offset + offset;
        ray.direction = focus_ * ray.direction - offset;
    }
    ray.direction = normalize(ray.direction);
    return ray;
}

void CameraRays::rays(const Places& places, int count, RayPacket& packet) const {
    packet.clear();
    packet.key = places.key;
    if (projection_ == Camera::Projection::perspective && !has_lens_) {
        for (int i = 0; i < batch_size; ++i) {
            const int lane = i < count ? i : 0;
            packet.anchor.set(i, location_), packet.offset.set(i, Vector{});
            packet.direction.set(i, normalize(forward_ + aside(places.x[lane], places.y[lane])));
        }
        packet.departure.fill({});
        packet.count = count;
        return;
    }
    for (int i = 0; i < count; ++i) {
        Ray one = ray(places.x[i], places.y[i], places.lens[static_cast<std::size_t>(i)]);
        one.key = places.key[static_cast<std::size_t>(i)];
        packet.add(one);
    }
    packet.fill_up();
}

DiscPoint CameraRays::lens_point(SampleKey key) const {
    if (!has_lens_) return {};
    if (lens_points_.empty()) return disc_from_square(sample_pair(key, dimension_pair::lens));

    // Every round through the points begins elsewhere, or else each lens point would see its own part of the pixel only.
    const auto count = static_cast<std::uint32_t>(lens_points_.size());
    const std::uint32_t round = key.sample / count;
    const std::uint32_t begin = round == 0 ? 0 : sampling::hash(key.pixel, round) % count;
    return lens_points_[(key.sample % count + begin) % count];
}

}  // namespace lapidary
