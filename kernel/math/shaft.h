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
#include <cmath>

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
        below_ = {Side(from_low.x, to_low.x, slack), Side(from_low.y, to_low.y, slack), Side(from_low.z, to_low.z, slack)};
        above_ = {Side(-from_high.x, -to_high.x, slack), Side(-from_high.y, -to_high.y, slack),
                  Side(-from_high.z, -to_high.z, slack)};
    }

    // Whether any way may meet a box. What is no number counts as met.
    template <class Corner>
    bool may_meet(const Corner& low, const Corner& high) const {
        constexpr double rounding = 0x1p-40;
        Part part{-rounding, 1 + rounding};
        for (std::size_t i = 0; i < 3; ++i) below_[i].limit(high[i], part), above_[i].limit(-double{low[i]}, part);
        return !(part.first > part.last);
    }

private:
    // From which part of the way to which.
    struct Part {
        double first, last;
    };
    // A coordinate that runs evenly along the way, and has to stay at or below a limit.
    struct Side {
        double begin = 0, slope = 0, inverse_slope = 0;

        Side() = default;
        Side(double from, double to, double slack) : begin(from - slack), slope(to - from), inverse_slope(1 / slope) {}
        void limit(double most, Part& part) const {
            const double room = most - begin, bound = room * inverse_slope;
            if (slope > 0 && bound < part.last) part.last = bound;
            if (slope < 0 && bound > part.first) part.first = bound;
            if (slope == 0 && room < 0) part.last = -infinity;
        }
    };

    static double size_of(const Bounds& box) { return largest_magnitude(box.low) + largest_magnitude(box.high); }

    std::array<Side, 3> below_, above_;
};

}  // namespace lapidary
