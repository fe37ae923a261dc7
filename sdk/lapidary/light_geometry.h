// SPDX-License-Identifier: MIT
//
// What lights have in common: falling off with the square of the distance, and balls and discs of light sampled by the
// solid angle that they fill.
#pragma once

#include <cmath>
#include <limits>
#include <numbers>

#include "kernel/interfaces/light.h"
#include "kernel/math/bounds.h"
#include "kernel/math/vector.h"

namespace lapidary {

// intensity / d^2 without squaring d, and never beyond the largest finite number: what is next to a light is as bright
// as numbers allow.
inline double inverse_square(double intensity, double distance) {
    const double light = intensity / distance / distance;
    return light < std::numeric_limits<double>::max() ? light : std::numeric_limits<double>::max();
}

// The box around a ball; around a point, where the radius is 0.
inline Bounds ball_bounds(const Point& centre, double radius) {
    const Vector half{radius, radius, radius};
    return {centre - half, centre + half};
}

// A sample as a place in the unit disc, equal areas for equal areas, the middle for (1/2, 1/2): the square's concentric
// squares become circles (Shirley and Chiu), so that neighbours stay neighbours.
struct DiscPoint {
    double radius, angle;
};

inline DiscPoint disc_point(const LightSample& sample) {
    const double a = 2 * sample.u - 1, b = 2 * sample.v - 1;
    if (a == 0 && b == 0) return {0, 0};
    constexpr double eighth_turn = std::numbers::pi / 4;
    if (std::fabs(a) > std::fabs(b)) return {a, eighth_turn * (b / a)};
    return {b, eighth_turn * (2 - a / b)};
}

// A unit vector about a unit axis, within the cone whose half-angle has 1 - cos = `versine`: equal solid angles for
// equal areas of the sample. The middle of the sample is the axis itself.
inline Vector direction_in_cone(const Vector& axis, double versine, const LightSample& sample) {
    const DiscPoint p = disc_point(sample);
    const double own_versine = p.radius * p.radius * versine;
    const double sine = p.radius * std::sqrt(versine * (2 - p.radius * p.radius * versine));

    // Two directions across the axis, continuous but for one place (Duff et al.).
    const double sign = std::copysign(1.0, axis.z), f = -1 / (sign + axis.z), g = axis.x * axis.y * f;
    const Vector across{1 + sign * axis.x * axis.x * f, sign * g, -sign * axis.x};
    const Vector upward{g, sign + axis.y * axis.y * f, -axis.y};
    return normalize((1 - own_versine) * axis + (sine * std::cos(p.angle)) * across + (sine * std::sin(p.angle)) * upward);
}

// Light from a point at the end of `to_centre`. A point at the light's own place gets none of it: there is no direction to it.
inline Illumination point_light(const Heading& to_centre, const Colour& colour, double intensity) {
    // Chosen instead of returned early, so that a loop over points stays vector instructions.
    constexpr double most = std::numeric_limits<double>::max();
    const bool apart = to_centre.distance > 0;
    const double inverse = to_centre.inverse_distance < most ? to_centre.inverse_distance : most;
    const double falling_off = intensity * inverse * inverse, light = falling_off < most ? falling_off : most;
    return {to_centre.direction, apart ? to_centre.distance : infinity, colour * (apart ? light : 0)};
}

inline Illumination point_light(const Vector& to_centre, const Colour& colour, double intensity) {
    return point_light(heading_along(to_centre), colour, intensity);
}

// Light from a ball of radius r > 0 about the end of `to_centre`, which sends `intensity` in every direction as a point
// light would. From the distance d it fills the cone with sin a = r/d; its surface has the radiance intensity/(pi r^2),
// and the cone holds 2 pi (1 - cos a) of solid angle:
//
//     intensity/(pi r^2) 2 pi (1 - cos a) = intensity/d^2 * 2/(1 + cos a),
//
// which for r = 0 is the point light's intensity/d^2. From within, the ball's surface is all around.
inline Illumination ball_light(const Vector& to_centre, double radius, const Colour& colour, double intensity,
                               const LightSample& sample) {
    const double distance = heading_along(to_centre).distance;
    if (!(distance > 0)) return {};
    const Vector axis = normalize(to_centre);
    if (distance <= radius) {
        const Vector direction = direction_in_cone(axis, 2, sample);
        const double middle = distance * dot(axis, direction);
        const double chord = std::sqrt(std::fmax(0, (radius - distance) * (radius + distance) + middle * middle));
        return {direction, middle + chord, colour * (4 * inverse_square(intensity, radius))};
    }
    const double sine = radius / distance, cosine = std::sqrt((1 - sine) * (1 + sine));
    const double versine = sine * sine / (1 + cosine);
    const Vector direction = direction_in_cone(axis, versine, sample);
    // The sample's own sine within the cone decides how deep before the centre the surface is met.
    const Vector offset = cross(axis, direction);
    const double half_chord = std::sqrt(std::fmax(0, sine * sine - dot(offset, offset)));
    return {direction, distance * (dot(axis, direction) - half_chord),
            colour * (2 / (1 + cosine) * inverse_square(intensity, distance))};
}

}  // namespace lapidary
