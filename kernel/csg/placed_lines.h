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

inline void place_lines(const Transform& placement, const RayPacket& rays, PlacedLines& placed) {
    const TwoPartPoint& centre = placement.centre();
    const Matrix3& m = placement.inverse_linear();
    const bool identity = placement.has_identity_linear();
    LineBatch& lines = placed.lines;
    for (int i = 0; i < batch_size; ++i) {
        const TwoPart x = two_difference(rays.anchor.x[i], centre.anchor.x);
        const TwoPart y = two_difference(rays.anchor.y[i], centre.anchor.y);
        const TwoPart z = two_difference(rays.anchor.z[i], centre.anchor.z);
        const double lo_x = x.lo + (rays.offset.x[i] - centre.offset.x);
        const double lo_y = y.lo + (rays.offset.y[i] - centre.offset.y);
        const double lo_z = z.lo + (rays.offset.z[i] - centre.offset.z);
        const double dx = rays.direction.x[i], dy = rays.direction.y[i], dz = rays.direction.z[i];
        const double world_step = -(x.hi * dx + y.hi * dy + z.hi * dz);
        const double wx = std::fma(world_step, dx, x.hi) + lo_x;
        const double wy = std::fma(world_step, dy, y.hi) + lo_y;
        const double wz = std::fma(world_step, dz, z.hi) + lo_z;
        const double lx = identity ? wx : wx * m[0][0] + wy * m[1][0] + wz * m[2][0];
        const double ly = identity ? wy : wx * m[0][1] + wy * m[1][1] + wz * m[2][1];
        const double lz = identity ? wz : wx * m[0][2] + wy * m[1][2] + wz * m[2][2];
        const double ldx = identity ? dx : dx * m[0][0] + dy * m[1][0] + dz * m[2][0];
        const double ldy = identity ? dy : dx * m[0][1] + dy * m[1][1] + dz * m[2][1];
        const double ldz = identity ? dz : dx * m[0][2] + dy * m[1][2] + dz * m[2][2];
        const double step = -(lx * ldx + ly * ldy + lz * ldz) / (ldx * ldx + ldy * ldy + ldz * ldz);
        lines.closest_x[i] = std::fma(step, ldx, lx);
        lines.closest_y[i] = std::fma(step, ldy, ly);
        lines.closest_z[i] = std::fma(step, ldz, lz);
        lines.direction_x[i] = ldx, lines.direction_y[i] = ldy, lines.direction_z[i] = ldz;
        placed.anchor[i] = world_step + step;
    }
}

}  // namespace lapidary
