// SPDX-License-Identifier: MIT
//
// Reflection and refraction of rays at a smooth face.
#pragma once

#include <cmath>

#include "kernel/math/vector.h"

namespace lapidary {

// Takes the drift of rounding out of a vector that is of unit length but for rounding: one Newton step.
inline Vector renormalize(const Vector& v) { return (1.5 - 0.5 * dot(v, v)) * v; }

inline constexpr double largest_whole_exponent = 128;

inline bool is_small_whole(double exponent) {
    return exponent >= 0 && exponent <= largest_whole_exponent && exponent == std::floor(exponent);
}

// cosine^exponent, by repeated squaring.
inline double whole_power(double cosine, int exponent) {
    double power = 1;
    for (int n = exponent; n > 0; n >>= 1, cosine *= cosine)
        if (n & 1) power *= cosine;
    return power;
}

// Since ln c <= c - 1, c^e <= exp(e (c - 1)): whether that is below the smallest number.
inline bool power_vanishes(double cosine, double exponent) { return exponent * (1 - cosine) > 746; }

// cosine^exponent for a cosine from 0 on: how bright a highlight is.
inline double highlight(double cosine, double exponent) {
    if (power_vanishes(cosine, exponent)) return 0;
    return is_small_whole(exponent) ? whole_power(cosine, static_cast<int>(exponent)) : std::pow(cosine, exponent);
}

// The direction mirrored at a plane with unit normal n.
inline Vector mirror(const Vector& direction, const Normal& n) {
    return renormalize(direction - 2 * dot(direction, n) * to_vector(n));
}

// Where light goes behind a face.
struct Refraction {
    Vector direction;  // without meaning at total reflection
    bool is_total = false;
};

// The refracted direction (Snell's law), for a unit direction, a unit normal against it and eta = index before / index behind.
// The sine is taken from the cross product: near the critical angle 1 - eta^2 sin^2 factored as (1 - eta s)(1 + eta s) keeps
// digits that 1 - eta^2 (1 - c^2) loses.
inline Refraction refract(const Vector& direction, const Normal& n, double eta) {
    const double sine = length(cross(direction, to_vector(n)));
    const double squared_cosine = (1 - eta * sine) * (1 + eta * sine);
    const double cosine = -dot(direction, n);
    const Vector refracted = renormalize(eta * direction + (eta * cosine - std::sqrt(squared_cosine)) * to_vector(n));
    return {{refracted.x, refracted.y, refracted.z}, !(squared_cosine > 0)};
}

// The part of unpolarised light that is reflected at a face between two indices (Fresnel), for a unit direction and a unit
// normal against it: nothing between equal indices; all beyond the critical angle, where the root is no number. Only the result
// is chosen, so that loops over lanes become vector instructions.
inline double fresnel_reflectance(const Vector& direction, const Normal& n, double index_before, double index_behind) {
    const double sine = index_before / index_behind * length(cross(direction, to_vector(n)));
    const double cosine = std::fabs(dot(direction, n)), cosine_behind = std::sqrt((1 - sine) * (1 + sine));
    const double perpendicular =
        (index_before * cosine - index_behind * cosine_behind) / (index_before * cosine + index_behind * cosine_behind);
    const double parallel =
        (index_behind * cosine - index_before * cosine_behind) / (index_behind * cosine + index_before * cosine_behind);
    const double reflected = 0.5 * (perpendicular * perpendicular + parallel * parallel);
    const double most = index_before == index_behind ? 0 : 1;
    return reflected < most ? reflected : most;
}

}  // namespace lapidary
