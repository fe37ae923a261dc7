// SPDX-License-Identifier: MIT
//
// What holds all straight ways from one box to another: their convex hull.
//
// The points that lie the part u of the way along fill a box, too,
//
//     (1 - u) from + u to,       0 <= u <= 1,
//
// so that a third box is met where, for some u, it overlaps that one in x, in y and in z. Each of the six conditions is linear in
// u: it holds on one side of a bound. The box is met where the bounds leave some u over.
#pragma once

#include <array>
#include <cstdint>

#include "kernel/math/bounds.h"

namespace lapidary {

// Among boxes that are given relative to an anchor.
class ShaftAmongBoxes {
public:
    // Both ends are finite; boxes are not further than `reach` from the anchor, or infinite. What rounding may do to the ends of
    // ways, to the corners of boxes and to their differences is allowed for.
    ShaftAmongBoxes(const Bounds& from, const Bounds& to, const Point& anchor, double reach) {
        const double slack = 0x1p-46 * (size_of(from) + size_of(to) + largest_magnitude(anchor) + reach);
        const Vector from_low = from.low - anchor, from_high = from.high - anchor;
        const Vector to_low = to.low - anchor, to_high = to.high - anchor;
        add(Corner::high, 0, from_low.x - slack, to_low.x - from_low.x);
        add(Corner::high, 1, from_low.y - slack, to_low.y - from_low.y);
        add(Corner::high, 2, from_low.z - slack, to_low.z - from_low.z);
        add(Corner::low, 0, from_high.x + slack, to_high.x - from_high.x);
        add(Corner::low, 1, from_high.y + slack, to_high.y - from_high.y);
        add(Corner::low, 2, from_high.z + slack, to_high.z - from_high.z);
    }

    // Whether any way may meet a box. What is no number counts as met.
    template <class Triple>
    bool may_meet(const Triple& low, const Triple& high) const {
        constexpr double rounding = 0x1p-40;
        const std::array<double, 6> corners{low[0], low[1], low[2], high[0], high[1], high[2]};
        double first = -rounding, last = 1 + rounding;
        for (std::size_t i = 0; i < first_count_; ++i) {
            const double bound = firsts_[i].at(corners);
            first = bound > first ? bound : first;
        }
        for (std::size_t i = 0; i < last_count_; ++i) {
            const double bound = lasts_[i].at(corners);
            last = bound < last ? bound : last;
        }
        return !(first > last);
    }

private:
    enum class Corner : std::uint8_t { low = 0, high = 3 };
    // The part of the way at which a coordinate that runs evenly comes to that of a box's corner.
    struct Bound {
        double begin = 0, inverse_slope = 0;
        std::size_t corner = 0;
        double at(const std::array<double, 6>& corners) const { return (corners[corner] - begin) * inverse_slope; }
    };

    // What runs toward its corner ends there, what comes from beyond it begins there; what stands still is on the right side
    // always or never.
    void add(Corner corner, std::size_t axis, double begin, double slope) {
        const double side = corner == Corner::high ? 1 : -1;  // low sides stay below the high corner, high ones above the low
        const double inverse = slope != 0 ? 1 / slope : side * 1e300;
        const Bound bound{begin, inverse, static_cast<std::size_t>(corner) + axis};
        (inverse * side > 0 ? lasts_[last_count_++] : firsts_[first_count_++]) = bound;
    }
    static double size_of(const Bounds& box) { return largest_magnitude(box.low) + largest_magnitude(box.high); }

    std::array<Bound, 6> firsts_, lasts_;
    std::size_t first_count_ = 0, last_count_ = 0;
};

}  // namespace lapidary
