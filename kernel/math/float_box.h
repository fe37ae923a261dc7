// SPDX-License-Identifier: MIT
//
// A box in half the room: floats relative to an anchor, rounded outward. It holds all that the box of doubles does, and little
// more where the anchor is in it or near to it.
#pragma once

#include <algorithm>
#include <limits>

#include "kernel/math/bounds.h"
#include "kernel/math/outward.h"

namespace lapidary {

struct FloatBox {
    float low_x, low_y, low_z, high_x, high_y, high_z;

    FloatBox() : FloatBox(Bounds::empty(), {}) {}
    FloatBox(const Bounds& box, const Point& anchor)
        : low_x(below(box.low.x - anchor.x)),
          low_y(below(box.low.y - anchor.y)),
          low_z(below(box.low.z - anchor.z)),
          high_x(above(box.high.x - anchor.x)),
          high_y(above(box.high.y - anchor.y)),
          high_z(above(box.high.z - anchor.z)) {}

    // To the rounding of its corners.
    Bounds around(const Point& anchor) const {
        return {{anchor.x + double{low_x}, anchor.y + double{low_y}, anchor.z + double{low_z}},
                {anchor.x + double{high_x}, anchor.y + double{high_y}, anchor.z + double{high_z}}};
    }

private:
    // What lies beyond all floats stays outside: the largest one is below it. So do the ends of an empty box, which have no
    // margin.
    static float below(double v) { return std::min(std::numeric_limits<float>::max(), float_below(v)); }
    static float above(double v) { return std::max(-std::numeric_limits<float>::max(), float_above(v)); }
};

}  // namespace lapidary
