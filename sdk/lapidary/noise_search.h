// SPDX-License-Identifier: MIT
//
// Where along a line noise passes from one range of its values to another.
#pragma once

#include <cmath>

#include "kernel/interfaces/material.h"
#include "lapidary/noise.h"
#include "lapidary/root_isolation.h"

namespace lapidary {

// A line that meets no change within so many cells of the lattice is taken to meet none. Only an endless line, and ranges at
// the very ends of noise's values, come so far.
inline constexpr double noise_search_limit = 0x1p16;

// The first t in from < t < to; `range_of(value)`, a rising step function, numbers the range that a value falls in.
template <class RangeOf>
Crossing next_change_of_noise(const MaterialLine& line, double from, double to, const RangeOf& range_of) {
    const double speed = length(line.direction);
    const bool one_range = range_of(-noise_bound) == range_of(noise_bound);
    if (one_range || !(speed > 0) || !(speed < infinity)) return {};

    const auto noise_along = [&](double t) {
        const NoiseSample sample = noise_with_gradient(line.at(t));
        return Slope{sample.value, dot(sample.gradient, line.direction)};
    };
    FirstChange search(noise_along, noise_curvature_bound * speed * speed, range_of);
    const double t = search.find(from, std::fmin(to, from + noise_search_limit / speed), 0.25 / speed);
    if (!(t < to)) return {};
    // Where noise touches a level with no slope, nothing but the line itself tells a direction.
    const Vector gradient = noise_with_gradient(line.at(t)).gradient;
    return {t, Normal(gradient == Vector{} ? line.direction : gradient)};
}

}  // namespace lapidary
