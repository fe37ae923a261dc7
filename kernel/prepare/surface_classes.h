// SPDX-License-Identifier: MIT
//
// Coincidence is a property of the scene, not of a ray: before the first ray, faces that lie on the same surface, to
// rounding, are put into one class, and every leaf bounded by it meets it at the same t, bit for bit.
#pragma once

#include "kernel/prepare/world.h"

namespace lapidary {

// Fills surface_uses and surface_classes of a World whose leaves and bounds are complete. Faces that are apart by more than
// rounding but less than a thousand times that are reported: it is seldom meant.
void recognise_coincident_surfaces(World& world, Messages& messages);

// How far apart numbers of this size may be and still mean the same place: 64 half-ulp.
inline double coincidence_tolerance(double coordinate, double extent) { return 64 * 0x1p-53 * (coordinate + extent); }

// The box around a leaf in the world, padded by what rounding and the t of a class's representative may be off.
// Its faces must be known.
Bounds padded_box(const World& world, const Leaf& leaf);

// Where a scene's solids are: around the bounded ones; where there are none, around the leaves that are bounded; else around
// the places of what has no bounds at all.
Bounds region_of_interest(const World& world);

// The largest absolute coordinate of the finite corners of a box.
double largest_coordinate(const Bounds& box);

}  // namespace lapidary
