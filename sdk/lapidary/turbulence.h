// SPDX-License-Identifier: MIT
//
// Turbulence: octaves of the absolute value of noise, each twice as fine and half as high as the one before,
//
//     T(p) = sum over i < n of |noise(2^i p)| / 2^i.
#pragma once

#include <cmath>

#include "lapidary/noise.h"

namespace lapidary {

// A cap on how much of what finer octaves add is worth having; 2^64 is far beyond what coordinates can express.
inline constexpr int most_octaves = 64;

inline Point scaled(const Point& p, double s) { return {s * p.x, s * p.y, s * p.z}; }

// The sum of the first `count` of n octaves, the rest replaced by their mean.
inline double turbulence(const Point& p, int n, int count) {
    double sum = 0, scale = 1;
    for (int i = 0; i < count; ++i, scale *= 2) sum += std::fabs(noise(scaled(p, scale))) / scale;
    // The heights of octaves count … n - 1 add up to 2 (2^-count - 2^-n).
    const double rest = 2 * (std::ldexp(1, -count) - std::ldexp(1, -n));
    return count < n ? sum + mean_absolute_noise * rest : sum;
}

inline double turbulence(const Point& p, int n) { return turbulence(p, n, n); }

// T with its gradient (of one side, where an octave passes 0).
inline NoiseSample turbulence_with_gradient(const Point& p, int n) {
    NoiseSample sum;
    double scale = 1;
    for (int i = 0; i < n; ++i, scale *= 2) {
        const NoiseSample octave = noise_with_gradient(scaled(p, scale));
        sum.value += std::fabs(octave.value) / scale;
        sum.gradient = sum.gradient + std::copysign(1, octave.value) * octave.gradient;
    }
    return sum;
}

// T at p, and how far from it T can be within `radius` of p along the unit vector `direction` and against it. An octave of
// frequency f and height 1/f has a slope of at most |noise'| + |noise''| f r / 2 there, and no more than noise's steepest.
struct TurbulenceReach {
    double value = 0, reach = 0;
};

inline TurbulenceReach turbulence_reach(const Point& p, const Vector& direction, double radius, int n) {
    TurbulenceReach sum;
    double scale = 1;
    for (int i = 0; i < n; ++i, scale *= 2) {
        const NoiseSample octave = noise_with_gradient(scaled(p, scale));
        const double slope = std::fabs(dot(octave.gradient, direction)) + noise_curvature_bound * scale * radius / 2;
        sum.value += std::fabs(octave.value) / scale;
        sum.reach += std::fmin(slope, noise_slope_bound) * radius;
    }
    return sum;
}

}  // namespace lapidary
