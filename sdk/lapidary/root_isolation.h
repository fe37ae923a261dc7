// SPDX-License-Identifier: MIT
//
// Where along a line a smooth function of space passes from one range of its values to another: the first place,
// found without ever stepping over one.
//
// Let |f''| <= K. On an interval of half width r about its middle m,
//
//     f stays within f(m) -+ (|f'(m)| r + K r^2 / 2),          so it may be seen to keep its range, and
//     f' keeps its sign where |f'(m)| > K r,                   so the ends alone tell whether it changes.
//
// An interval that is neither is halved, the nearer half first. Near a simple crossing this ends after a few halvings;
// where the function only touches the end of a range, it ends when K r^2 / 2 is less than rounding makes of f itself: what
// would cross and cross back within is thinner than the function's values can express, and counts as not crossed.
// Where a line runs in the very end of a range for a while (noise is 0 all along some edges of its lattice), no halving
// shows anything; after thousands of them in one step the ends of what is left decide, of whatever is narrower than a
// thousandth of the step. So f is never lost where it leaves its range and comes back, anywhere in between having gone
// further than
//
//     lost_depth(K, step) = 3 K (step / 2048)^2
//
// beyond: an interval that is neither has |f'(m)| <= K r and |f(m)| <= 3/2 K r^2, hence |f| <= 3 K r^2 all over it, where f is
// measured from the range's end.
#pragma once

#include <cmath>

#include "kernel/math/vector.h"

namespace lapidary {

struct Slope {
    double value = 0;  // of a function along a line
    double slope = 0;  // its derivative by t
};

// `function(t)` gives a Slope; `range_of(value)`, a rising step function, numbers the range that a value falls in.
template <class Function, class RangeOf>
class FirstChange {
public:
    // How deep f may be in another range for a while, at most, without being found there.
    static double lost_depth(double curvature, double step) {
        const double r = step * always_halved;
        return 3 * curvature * r * r + 2 * rounding;
    }

    FirstChange(const Function& function, double curvature, const RangeOf& range_of)
        : function_(function), curvature_(curvature), range_of_(range_of) {}

    // The first t in from < t <= to whose range is not that of `from`; infinity where there is none. The t found is the
    // first double on the far side. Intervals begin no wider than `step`.
    double find(double from, double to, double step) {
        const auto range = range_of_(function_(from).value);
        for (double a = from; a < to;) {
            halvings_left_ = most_halvings;
            narrow_ = step * always_halved;
            const double b = std::fmin(a + step, to);
            if (!(b > a)) return infinity;  // the step is lost in rounding: the line is too far out
            const double t = find_within(a, b, range);
            if (t < infinity) return t;
            a = b;
        }
        return infinity;
    }

private:
    // Above the rounding of a value of about 1.
    static constexpr double rounding = 0x1p-50;
    // In a step; a simple crossing or a touch takes less than two hundred.
    static constexpr int most_halvings = 4096;
    // Half of an interval that is halved whatever it cost before, as a part of the step.
    static constexpr double always_halved = 0x1p-11;

    template <class Range>
    double find_within(double a, double b, Range range) {
        const double middle = a + (b - a) / 2, r = (b - a) / 2;
        const Slope at_middle = function_(middle);
        const double bend = curvature_ * r * r / 2;
        const double reach = std::fabs(at_middle.slope) * r + bend + rounding;
        if (range_of_(at_middle.value - reach) == range && range_of_(at_middle.value + reach) == range) return infinity;

        const bool monotone = std::fabs(at_middle.slope) > curvature_ * r;
        const bool exhausted = --halvings_left_ < 0 && r <= narrow_;
        if (monotone || bend < rounding || !(a < middle && middle < b) || exhausted)
            return range_of_(function_(b).value) == range ? infinity : bisect(a, b, range);

        const double t = find_within(a, middle, range);
        return t < infinity ? t : find_within(middle, b, range);
    }

    // Down to two neighbouring doubles.
    template <class Range>
    double bisect(double a, double b, Range range) const {
        for (;;) {
            const double middle = a + (b - a) / 2;
            if (!(a < middle && middle < b)) return b;
            (range_of_(function_(middle).value) == range ? a : b) = middle;
        }
    }

    const Function& function_;
    double curvature_;
    const RangeOf& range_of_;
    int halvings_left_ = most_halvings;
    double narrow_ = 0;
};

}  // namespace lapidary
