// SPDX-License-Identifier: MIT
//
// A ball that holds something, relative to an anchor. As it is, it holds everything.
#pragma once

#include "kernel/math/vector.h"

namespace lapidary {

struct Ball {
    Vector centre;
    double radius = infinity;

    // Widened by many times what rounding may do to its place and to all that is computed from it.
    static Ball around(const Point& centre, double radius, const Point& anchor) {
        constexpr double rounding = 0x1p-40;
        const Vector at = centre - anchor;
        return {at, radius + rounding * (radius + largest_magnitude(centre) + largest_magnitude(at))};
    }
};

}  // namespace lapidary
