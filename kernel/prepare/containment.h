// SPDX-License-Identifier: MIT
//
// What a cut swallows or leaves alone, known before the first ray.
#pragma once

#include <span>

#include "kernel/interfaces/object.h"
#include "kernel/math/transform.h"

namespace lapidary {

// An object where it stands, with its faces as known surfaces.
struct PlacedObject {
    const Object& object;
    const Transform& placement;
    std::span<const Surface> faces;
};

enum class Containment { inside, outside, unknown };

// Whether a solid lies inside another one, or outside of it, with all of its points and by more than rounding. It is taken as its
// own box or, where a sphere is its only face, as that ball. Cones, tori and what has no known faces say nothing.
LAPIDARY_API Containment containment_of(const PlacedObject& solid, const PlacedObject& other);

}  // namespace lapidary
