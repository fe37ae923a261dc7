// SPDX-License-Identifier: MIT
//
// Boxes in the world around what stands turned and stretched in it.
#pragma once

#include <span>

#include "kernel/interfaces/object.h"
#include "kernel/math/transform.h"

namespace lapidary {

// The box around an object, of which its own box and its faces as known surfaces are given. The box around its turned own box is
// up to 1.7 times as wide as a ball that just fits into that; of the surfaces that are round, the exact extent is known.
LAPIDARY_API Bounds placed_bounds(const Transform& placement, const Bounds& own, std::span<const Surface> faces);

}  // namespace lapidary
