// SPDX-License-Identifier: MIT
//
// An axis-parallel box that may reach to infinity. The empty box has low > high.
#pragma once

#include <algorithm>

#include "kernel/math/vector.h"

namespace lapidary {

struct Bounds {
    Point low{infinity, infinity, infinity};
    Point high{-infinity, -infinity, -infinity};

    static Bounds empty() { return {}; }
    static Bounds everything() { return {{-infinity, -infinity, -infinity}, {infinity, infinity, infinity}}; }
    // The cube |x|, |y|, |z| <= half.
    static Bounds cube(double half) { return {{-half, -half, -half}, {half, half, half}}; }
    // The box |x| <= hx, |y| <= hy, |z| <= hz.
    static Bounds box(double hx, double hy, double hz) { return {{-hx, -hy, -hz}, {hx, hy, hz}}; }

    bool is_empty() const { return !(low.x <= high.x && low.y <= high.y && low.z <= high.z); }
    bool is_finite() const {
        return low.x > -infinity && low.y > -infinity && low.z > -infinity && high.x < infinity && high.y < infinity &&
               high.z < infinity;
    }
    bool contains(const Point& p) const {
        return p.x >= low.x && p.x <= high.x && p.y >= low.y && p.y <= high.y && p.z >= low.z && p.z <= high.z;
    }
    bool overlaps(const Bounds& o) const {
        return low.x <= o.high.x && o.low.x <= high.x && low.y <= o.high.y && o.low.y <= high.y && low.z <= o.high.z &&
               o.low.z <= high.z;
    }
    Point centre() const { return {0.5 * low.x + 0.5 * high.x, 0.5 * low.y + 0.5 * high.y, 0.5 * low.z + 0.5 * high.z}; }
    Vector diagonal() const { return high - low; }
};

// The smallest box around both.
inline Bounds unite(const Bounds& a, const Bounds& b) {
    return {{std::min(a.low.x, b.low.x), std::min(a.low.y, b.low.y), std::min(a.low.z, b.low.z)},
            {std::max(a.high.x, b.high.x), std::max(a.high.y, b.high.y), std::max(a.high.z, b.high.z)}};
}

inline Bounds unite(const Bounds& a, const Point& p) { return unite(a, Bounds{p, p}); }

// What both boxes share, possibly empty.
inline Bounds intersect(const Bounds& a, const Bounds& b) {
    return {{std::max(a.low.x, b.low.x), std::max(a.low.y, b.low.y), std::max(a.low.z, b.low.z)},
            {std::min(a.high.x, b.high.x), std::min(a.high.y, b.high.y), std::min(a.high.z, b.high.z)}};
}

}  // namespace lapidary
