// SPDX-License-Identifier: MIT
#include "kernel/render/sampler.h"

#include <cmath>
#include <numbers>

namespace lapidary {

DiscPoint disc_from_square(SamplePair square) {
    const double a = 2 * square.u - 1;
    const double b = 2 * square.v - 1;
    if (a == 0 && b == 0) return {};

    // In the two quarters left and right the square's a is the circle's radius, above and below its b.
    const bool sideways = std::fabs(a) > std::fabs(b);
    const double radius = sideways ? a : b;
    const double angle = sideways ? std::numbers::pi / 4 * (b / a) : std::numbers::pi / 2 - std::numbers::pi / 4 * (a / b);
    return {radius * std::cos(angle), radius * std::sin(angle)};
}

std::vector<DiscPoint> even_disc_points(int count) {
    const double golden_angle = std::numbers::pi * (3 - std::sqrt(5.0));
    std::vector<DiscPoint> points(static_cast<std::size_t>(count));  // the first stays at the centre
    for (int i = 1; i < count; ++i) {
        const double radius = std::sqrt((i + 0.5) / count);
        points[static_cast<std::size_t>(i)] = {radius * std::cos(i * golden_angle), radius * std::sin(i * golden_angle)};
    }
    return points;
}

}  // namespace lapidary
