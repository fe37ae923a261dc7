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
      focus_(camera.focus),
      lens_radius_(camera.aperture / 2),
      has_lens_(camera.aperture > 0 && camera.points != 1) {
    orient(camera);
    measure_screen(camera, width, height);
    if (has_lens_ && camera.points > 1) lens_points_ = even_disc_points(camera.points);
}

void CameraRays::orient(const Camera& camera) {
    const Vector view = camera.screen_centre - camera.location;
    view_.forward = normalize(view);
    if (view_.forward == Vector{}) view_.forward = {0, 0, 1};
    screen_distance_ = dot(view, view_.forward);
    if (!(screen_distance_ > 0)) screen_distance_ = 1;

    // Looking straight along up, +z is up; where z is the view itself, +y.
    view_.right = right_of(camera.up, view_.forward);
    if (view_.right == Vector{}) view_.right = right_of({0, 0, 1}, view_.forward);
    if (view_.right == Vector{}) view_.right = right_of({0, 1, 0}, view_.forward);
    view_.up = normalize(cross(view_.forward, view_.right));
}

void CameraRays::measure_screen(const Camera& camera, double picture_width, double picture_height) {
    const double aspect = picture_width / picture_height;
    const bool perspective = projection_ == Camera::Projection::perspective;
    const double unit = perspective ? screen_distance_ : 1;

    double width = 0, height = 0;
    if (camera.angle) {
        width = 2 * std::tan(*camera.angle / 2) * (perspective ? 1 : screen_distance_);
        height = width / aspect;
    } else if (camera.screen_width) {
        width = *camera.screen_width / unit;
        height = camera.screen_height_given ? camera.screen_height / unit : width / aspect;
    } else {
        height = camera.screen_height / unit;
        width = height * aspect;
    }
    view_.middle_x = picture_width / 2, view_.middle_y = picture_height / 2;
    view_.pixel_width = width / picture_width, view_.pixel_height = height / picture_height;
    if (perspective) pixel_footprint_ = std::atan(view_.pixel_height);
}

Ray CameraRays::ray(double x, double y, DiscPoint lens) const {
    Ray ray;
    if (projection_ == Camera::Projection::perspective) {
        ray.origin = location_;
        ray.direction = view_.forward + view_.aside(x, y);
    } else {
        ray.origin = TwoPartPoint(location_, view_.aside(x, y));
        ray.direction = view_.forward;
    }
    if (has_lens_) {
        const Vector offset = (lens_radius_ * lens.x) * view_.right + (lens_radius_ * lens.y) * view_.up;
        ray.origin.offset = ray.origin.offset + offset;
        ray.direction = focus_ * ray.direction - offset;
    }
    ray.direction = heading_along(ray.direction).direction;
    return ray;
}

// ray() for all lanes; what they share is read once, so that the loop becomes vector instructions. Where lengths cannot leave the
// doubles nothing has to be scaled, and the bits are those of heading_along().
template <bool is_moderate>
void CameraRays::direct_through_pinhole(const Places& __restrict places, VectorLanes& __restrict direction) const {
    const View view = view_;
    for (int i = 0; i < batch_size; ++i) {
        const Vector way = view.forward + view.aside(places.x[i], places.y[i]);
        direction.set(i, is_moderate ? (1 / length(way)) * way : heading_along(way).direction);
    }
}

void CameraRays::rays_through_pinhole(const Places& places, RayPacket& packet) const {
    constexpr double moderate = 1e100;
    if (view_.middle_x * view_.pixel_width < moderate && view_.middle_y * view_.pixel_height < moderate)
        direct_through_pinhole<true>(places, packet.direction);
    else
        direct_through_pinhole<false>(places, packet.direction);
    for (int i = 0; i < batch_size; ++i) packet.anchor.set(i, location_), packet.offset.set(i, Vector{});
}

void CameraRays::rays(const Places& places, int count, RayPacket& packet) const {
    packet.clear();
    packet.key = places.key;
    if (projection_ == Camera::Projection::perspective && !has_lens_) {
        rays_through_pinhole(places, packet);
        packet.departure.fill({});
        packet.count = count;
    } else {
        for (int i = 0; i < count; ++i) {
            Ray one = ray(places.x[i], places.y[i], places.lens[static_cast<std::size_t>(i)]);
            one.key = places.key[static_cast<std::size_t>(i)];
            packet.add(one);
        }
    }
    packet.fill_up();
}

namespace {

// sign (aside - at forward), coordinate by coordinate: vectors that are put together and then copied wait for themselves.
void set_plane(Vector& normal, double sign, const Vector& aside, double at, const Vector& forward) {
    normal.x = sign * (aside.x - at * forward.x);
    normal.y = sign * (aside.y - at * forward.y);
    normal.z = sign * (aside.z - at * forward.z);
}

}  // namespace

// At distance 1 the rectangle has left, right, bottom and top. What is to the right of its left edge is p with
//
//     (p - L) . (right - left forward) > 0,
//
// and so on: no difference of close numbers is taken, however small the rectangle is. It is a little larger than was asked for.
std::optional<Beam> CameraRays::beam(double x0, double y0, double x1, double y1) const {
    std::optional<Beam> found;  // the same one in every return, so that it is made where it is wanted
    if (projection_ != Camera::Projection::perspective || has_lens_) return found;
    constexpr double part_of_pixel = 1.0 / 64, rounding = 0x1p-44;
    const double left = view_.to_right(x0 - part_of_pixel), right = view_.to_right(x1 + part_of_pixel);
    const double bottom = view_.to_top(y1 + part_of_pixel), top = view_.to_top(y0 - part_of_pixel);
    const double margin = rounding * (1 + std::fabs(left) + std::fabs(right) + std::fabs(bottom) + std::fabs(top));
    const Vector& forward = view_.forward;
    Beam& beam = found.emplace();
    beam.eye = location_;
    set_plane(beam.inward[0], 1, view_.right, left - margin, forward);
    set_plane(beam.inward[1], -1, view_.right, right + margin, forward);
    set_plane(beam.inward[2], 1, view_.up, bottom - margin, forward);
    set_plane(beam.inward[3], -1, view_.up, top + margin, forward);
    const double middle = 0.5 * (left + right), level = 0.5 * (bottom + top);
    beam.middle = forward + middle * view_.right + level * view_.up;
    beam.half_width = (0.5 * (right - left) + margin) * view_.right;
    beam.half_height = (0.5 * (top - bottom) + margin) * view_.up;
    set_plane(beam.to_right, 1, view_.right, middle, forward), set_plane(beam.to_top, 1, view_.up, level, forward);
    return found;
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
