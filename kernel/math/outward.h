// SPDX-License-Identifier: MIT
//
// Doubles as floats, rounded outward: a box or a range kept as floats holds all that the doubles hold.
#pragma once

#include <cmath>

namespace lapidary {

// At most v, and at least v; infinities that lie outward stay what they are. The margin is twice what rounding to nearest can
// take away.
inline float float_below(double v) { return static_cast<float>(v - (0x1p-23 * std::fabs(v) + 0x1p-148)); }
inline float float_above(double v) { return static_cast<float>(v + (0x1p-23 * std::fabs(v) + 0x1p-148)); }

}  // namespace lapidary
