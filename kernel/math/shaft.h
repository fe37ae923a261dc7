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

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "kernel/math/ball.h"
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
        low_sides_ = {side(1, from_low.x - slack, to_low.x - from_low.x), side(1, from_low.y - slack, to_low.y - from_low.y),
                      side(1, from_low.z - slack, to_low.z - from_low.z)};
        high_sides_ = {side(-1, from_high.x + slack, to_high.x - from_high.x),
                       side(-1, from_high.y + slack, to_high.y - from_high.y),
                       side(-1, from_high.z + slack, to_high.z - from_high.z)};
        from_ = {from_low, from_high, slack}, to_ = {to_low, to_high, slack};
        way_ = to_.middle - from_.middle;
        along_ = (1 / length_squared(way_)) * way_;
    }

    // Whether any way may meet a ball. None does where both ends lie behind one plane and the ball before it, as then all ways
    // lie behind it. Whichever plane that is: tried is the one across the shortest line from the middle way to the ball.
    bool may_meet(const Ball& ball) const {
        constexpr double least = 1e-200;  // of squares that have all of their digits
        const double part = std::clamp(dot(ball.centre - from_.middle, along_), 0.0, 1.0);
        const Vector normal = ball.centre - from_.middle - part * way_;
        const double squared = length_squared(normal), begin = dot(normal, ball.centre) - std::sqrt(squared) * ball.radius;
        return !(begin > std::max(from_.furthest(normal), to_.furthest(normal))) || squared < least;
    }

    // Whether any way may meet a box. What is no number counts as met.
    template <class Triple>
    bool may_meet(const Triple& low, const Triple& high) const {
        constexpr double rounding = 0x1p-40;
        const Part x0 = low_sides_[0].part_before(high[0]), x1 = high_sides_[0].part_before(low[0]);
        const Part y0 = low_sides_[1].part_before(high[1]), y1 = high_sides_[1].part_before(low[1]);
        const Part z0 = low_sides_[2].part_before(high[2]), z1 = high_sides_[2].part_before(low[2]);
        const Part part = common(common(common(x0, x1), common(y0, y1)), common(z0, z1));
        const double first = part.first > -rounding ? part.first : -rounding;
        const double last = part.last < 1 + rounding ? part.last : 1 + rounding;
        return !(first > last);
    }

private:
    struct Part {
        double first, last;
    };
    // Folded two by two, so that no choice waits for all before it. What is no number narrows nothing.
    static Part common(const Part& a, const Part& b) {
        return {a.first > b.first ? a.first : b.first, a.last < b.last ? a.last : b.last};
    }

    // A coordinate that runs evenly along the way has to be on one side of that of a box's corner: from some part of the way on,
    // or up to there.
    struct Side {
        double begin, inverse_slope;
        double unbounded;  // infinity where the part is the first, -infinity where it is the last

        // Chosen without branches.
        Part part_before(double corner) const {
            const double part = (corner - begin) * inverse_slope;
            return {unbounded < part ? unbounded : part, unbounded > part ? unbounded : part};
        }
    };

    // What runs toward its corner ends there, what comes from beyond it begins there; what stands still is on the right side
    // always or never. Low sides stay below the corner (1), high ones above it (-1).
    static Side side(double below, double begin, double slope) {
        const double inverse = slope != 0 ? 1 / slope : below * 1e300;
        return {begin, inverse, inverse * below > 0 ? -infinity : infinity};
    }
    static double size_of(const Bounds& box) { return largest_magnitude(box.low) + largest_magnitude(box.high); }

    // A box by its middle, widened.
    struct End {
        Vector middle, half;

        End() = default;
        End(const Vector& low, const Vector& high, double by)
            : middle(0.5 * (low + high)), half(0.5 * (high - low) + Vector{by, by, by}) {}

        // How far its points lie along a vector at most.
        double furthest(const Vector& along) const {
            return dot(along, middle) + std::fabs(along.x) * half.x + std::fabs(along.y) * half.y + std::fabs(along.z) * half.z;
        }
    };

    std::array<Side, 3> low_sides_, high_sides_;
    End from_, to_;
    Vector way_, along_;  // from middle to middle; and what tells the part of the way that a place is at
};

}  // namespace lapidary
