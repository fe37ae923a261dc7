// SPDX-License-Identifier: MIT
//
// Roots near the origin of a ray, to full relative precision.
//
// A leaf answers about the line's point closest to its centre. Where that point is far off, t = anchor + end carries the
// rounding of the anchor, u |anchor|: beside a large surface (an eye above a planet) more than t itself. There the root is found
// anew, by Newton's method from where it was, on the surface's equation
//
//     f(o + t d) = 0,   f < 0 inside,
//
// evaluated in two-part arithmetic at a point that is taken into the surface's space in two parts, too. The slope only steers and
// is an ordinary double: what the iteration comes to rest at is decided by f alone, to about u^2 |anchor| / cos of the angle.
//
// The place met is then o + t d, from the ray's own origin: from the point closest to the centre it would be off by u |anchor|.
#pragma once

#include <cmath>
#include <span>

#include "kernel/export.h"
#include "kernel/interfaces/object.h"
#include "kernel/math/transform.h"
#include "kernel/render/ray.h"

namespace lapidary {

// Whether the rounding of t = anchor + end is worth removing: it is at most 64 half-ulp of t elsewhere.
inline bool is_near_root(double t, double anchor) { return std::fabs(t) < 0x1p-6 * std::fabs(anchor); }

// Which way the line passes a surface.
enum class Passing { in, out, either };

// Of the roots of the surfaces, in the space of `placement`, the one that t stands for; t where there is none.
LAPIDARY_API double near_root(const Ray& ray, const Transform& placement, std::span<const Surface> surfaces, double t,
                              double anchor, Passing passing);

// How far an end of a span may be from the root that it stands for, in parts of the anchor: far more than its rounding. A root
// farther off is another one.
constexpr double most_rounding = 0x1p-30;

// Whether an end of a span is to be found anew. One at 0, of a leaf that the ray departs from, is exact as it is.
inline bool is_near_end(double t, double anchor, bool departing) { return is_near_root(t, anchor) && !(departing && t == 0); }

// The same for both ends of a span.
inline void find_near_ends(Span& span, const Ray& ray, const Transform& placement, std::span<const Surface> surfaces,
                           double anchor, bool departing) {
    if (is_near_end(span.in, anchor, departing)) span.in = near_root(ray, placement, surfaces, span.in, anchor, Passing::in);
    if (is_near_end(span.out, anchor, departing)) span.out = near_root(ray, placement, surfaces, span.out, anchor, Passing::out);
}

}  // namespace lapidary
