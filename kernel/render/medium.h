// SPDX-License-Identifier: MIT
//
// Matter along a ray: what a material is at a point, where it changes abruptly, and how much light a stretch of it lets
// through.
#pragma once

#include <cmath>

#include "kernel/export.h"
#include "kernel/prepare/world.h"

namespace lapidary {

// A place where matter is asked for.
struct MatterSite {
    TwoPartPoint point;
    double footprint = 0;  // about the width of a pixel there, in world units
};

// The matter of a material just off a surface, on the side that `toward` points to (of a length near 1). A solid texture colours
// matter, not surfaces: sampling it inside keeps a checker from speckling on a face that lies on the checker's own boundary.
// The step is about a millionth of a pixel, and above the rounding of the point.
LAPIDARY_API Matter matter_beside(const MaterialInstance& instance, const MatterSite& site, const Vector& toward);

// Where that is: the site's place from the centre of the material's space, and its footprint there. `inverse` leads there
// where that space is turned or stretched. One that keeps shapes scales all lengths alike.
template <bool identity, bool keeps_shapes>
Point point_beside(const TwoPartVector& from_centre, double footprint, const Vector& toward, const Matrix3& inverse,
                   double scale) {
    const auto to_local = [&inverse](const Vector& v) { return identity ? v : multiply(v, inverse); };
    const Point p = to_point(to_local(from_centre.hi) + to_local(from_centre.lo));
    const double step = 1e-6 * footprint + 0x1p-40 * largest_magnitude(p);
    if constexpr (keeps_shapes)
        return p + step * (1 / scale) * to_local(toward);
    else
        return p + step * normalize(to_local(toward));
}

// The ray in a material's space: the same t as in the world.
inline MaterialLine material_line(const MaterialInstance& instance, const TwoPartPoint& origin, const Vector& direction) {
    return {instance.placement().to_local(origin), instance.placement().to_local(direction)};
}

// The first boundary within a material between t0 and t1. One that cannot be told from an end of the stretch, where the ray
// has just left it or a face lies upon it, is none.
LAPIDARY_API Crossing next_crossing(const Material& material, const MaterialLine& line, double t0, double t1);

// The point of a ray at a crossing, on the boundary to the rounding of the point itself, however far the ray has come.
LAPIDARY_API TwoPartPoint crossing_point(const MaterialInstance& instance, const TwoPartPoint& origin, const Vector& direction,
                                         double t);

// The fraction of light that a transparent material lets through from t0 to t1: Beer-Lambert, colour^(length / depth),
// integrated where the material varies. Exactly 1 for what does not absorb, at any length.
LAPIDARY_API Colour transmittance(const MaterialInstance& instance, const MaterialLine& line, double t0, double t1);

}  // namespace lapidary
