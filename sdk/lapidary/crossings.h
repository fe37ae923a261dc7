// SPDX-License-Identifier: MIT
//
// Where a line meets the families of surfaces that textures are cut along: planes and shells at equal distances, in closed form.
//
// Each function gives the first t > from. Families are endless, so none needs an upper end; whoever asks compares.
// What rounding does to the position at `from` can put it on the wrong side of a surface that it lies on; so the search
// begins one surface early and takes the first t that truly lies beyond. Surfaces that a double can no longer
// tell apart (beyond 2^53) are not met.
#pragma once

#include <cmath>

#include "kernel/interfaces/material.h"

namespace lapidary {

// The open cell between two consecutive boundaries has one matter throughout, so any t between tells it.
inline double between(double from, double to) {
    if (to < infinity) return from + (to - from) / 2;
    return from + (std::fabs(from) > 1 ? std::fabs(from) : 1);
}

// Where coordinate + t slope = k + offset, for an integer k.
inline double next_integer(double coordinate, double slope, double from, double offset = 0) {
    if (slope == 0) return infinity;
    const double start = coordinate - offset;
    const double step = slope > 0 ? 1 : -1;
    double k = std::floor(fused_multiply_add(from, slope, start)) + (slope > 0 ? 0 : 1);
    for (int tries = 0; tries < 4; ++tries, k += step) {
        const double t = (k - start) / slope;
        if (t > from) return t;
    }
    return infinity;
}

// Where |origin + t direction| = k + offset, for an integer k; the line in two dimensions (one component of both zero)
// meets cylinders, in three spheres. A radius of 0 is no surface.
//
// About its point closest to the centre, origin + t0 direction at the distance m, the line meets the radius r at
//
//     t0 -+ sqrt((r - m)(r + m) / d.d)
//
// where r > m: falling radii on the way in, rising ones on the way out. A radius that is only touched is not crossed.
inline double next_shell(const Vector& origin, const Vector& direction, double from, double offset = 0) {
    const double dd = dot(direction, direction);
    if (!(dd > 0)) return infinity;
    const double t0 = -dot(origin, direction) / dd;
    const double m = length(origin + t0 * direction);
    const auto half_chord = [&](double r) { return std::sqrt((r - m) * (r + m) / dd); };
    const auto first_radius = [&](double r) { return std::floor(r - offset) + offset; };

    if (from < t0) {
        double radius = first_radius(length(origin + from * direction)) + 1;
        for (int tries = 0; tries < 4 && radius > m && radius > 0; ++tries, radius -= 1) {
            const double t = t0 - half_chord(radius);
            if (t > from) return t;
        }
    }
    double radius = first_radius(from < t0 ? m : length(origin + from * direction));
    for (int tries = 0; tries < 4; ++tries, radius += 1) {
        if (!(radius > m) || !(radius > 0)) continue;
        const double t = t0 + half_chord(radius);
        if (t > from) return t;
    }
    return infinity;
}

// How far a coordinate is from the nearest integer + offset.
inline double distance_to_integer(double coordinate, double offset = 0) {
    const double start = coordinate - offset;
    return std::fabs(start - std::round(start));
}

}  // namespace lapidary
