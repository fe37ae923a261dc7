// SPDX-License-Identifier: MIT
//
// The lines of a packet of rays in a leaf's own space: what LineThroughSolid does for one ray, in the same order, for all
// lanes.
//
// The line is first brought next to the leaf's centre in the world, in two parts, and only then taken into the leaf's space:
// from there the textbook formulas keep their digits at any distance.
#pragma once

#include <cmath>

#include "kernel/csg/ray_packet.h"
#include "kernel/math/transform.h"

namespace lapidary {

// t in the world = anchor + t along the local line.
struct PlacedLines {
    LineBatch lines;
    Lanes anchor;
};

// One more step along the lines, to their points closest to the leaf's centre.
inline void bring_nearer(PlacedLines& placed) {
    LineBatch& lines = placed.lines;
    for (int i = 0; i < batch_size; ++i) {
        const double x = lines.closest_x[i], y = lines.closest_y[i], z = lines.closest_z[i];
        const double dx = lines.direction_x[i], dy = lines.direction_y[i], dz = lines.direction_z[i];
        const double step = -(x * dx + y * dy + z * dz) / (dx * dx + dy * dy + dz * dz);
        lines.closest_x[i] = fused_multiply_add(step, dx, x);
        lines.closest_y[i] = fused_multiply_add(step, dy, y);
        lines.closest_z[i] = fused_multiply_add(step, dz, z);
        placed.anchor[i] += step;
    }
}

// Nothing overlaps: that is what lets the loop become vector instructions. (The matrix and the centre are references, as single
// numbers of a copy would be waited for until the vectors that it is written in have arrived.)
template <bool identity, bool keeps_shapes>
void place_lines_by(const Transform& placement, const RayPacket& __restrict rays, PlacedLines& __restrict placed) {
    const TwoPartPoint& centre = placement.centre();
    const Matrix3& m = placement.inverse_linear();
    const double squared_scale = placement.squared_scale();
    LineBatch& lines = placed.lines;
    for (int i = 0; i < batch_size; ++i) {
        const TwoPart x = two_difference(rays.anchor.x[i], centre.anchor.x);
        const TwoPart y = two_difference(rays.anchor.y[i], centre.anchor.y);
        const TwoPart z = two_difference(rays.anchor.z[i], centre.anchor.z);
        const double lo_x = x.lo + (rays.offset.x[i] - centre.offset.x);
        const double lo_y = y.lo + (rays.offset.y[i] - centre.offset.y);
        const double lo_z = z.lo + (rays.offset.z[i] - centre.offset.z);
        const Vector d{rays.direction.x[i], rays.direction.y[i], rays.direction.z[i]};
        const double world_step = -(x.hi * d.x + y.hi * d.y + z.hi * d.z);
        const Vector w{fused_multiply_add(world_step, d.x, x.hi) + lo_x, fused_multiply_add(world_step, d.y, y.hi) + lo_y,
                       fused_multiply_add(world_step, d.z, z.hi) + lo_z};
        const Vector closest = identity ? w : multiply(w, m), direction = identity ? d : multiply(d, m);
        const double along = dot(closest, direction);
        const double step = keeps_shapes ? -along * squared_scale : -along / dot(direction, direction);
        lines.closest_x[i] = fused_multiply_add(step, direction.x, closest.x);
        lines.closest_y[i] = fused_multiply_add(step, direction.y, closest.y);
        lines.closest_z[i] = fused_multiply_add(step, direction.z, closest.z);
        lines.direction_x[i] = direction.x, lines.direction_y[i] = direction.y, lines.direction_z[i] = direction.z;
        placed.anchor[i] = world_step + step;
    }
}

inline void place_lines(const Transform& placement, const RayPacket& rays, PlacedLines& placed) {
    if (placement.has_identity_linear())
        place_lines_by<true, true>(placement, rays, placed);
    else if (placement.keeps_shapes())
        place_lines_by<false, true>(placement, rays, placed);
    else
        place_lines_by<false, false>(placement, rays, placed);
    if (placement.is_lopsided()) bring_nearer(placed);
}

}  // namespace lapidary
