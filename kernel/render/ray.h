// SPDX-License-Identifier: MIT
//
// A ray in the world: a two-part origin, a unit direction, and what it departs from.
#pragma once

#include <array>
#include <cstdint>

#include "kernel/math/two_part.h"

namespace lapidary {

// The surface that a secondary ray starts on: its own root is removed by identity, not by a distance.
struct Departure {
    std::int32_t leaf = -1;           // index in the World; -1: the ray starts in free space
    std::int32_t surface_class = -1;  // where the face is shared with other solids
    bool inward = false;              // the ray goes into the leaf (for a class: to its representative's inside)
};

// Which random numbers belong to a ray: a pure function of pixel and sample number.
struct SampleKey {
    std::uint32_t pixel = 0;   // hash of the pixel's coordinates in the full picture
    std::uint32_t sample = 0;  // number of the sample within the pixel
};

struct Ray {
    TwoPartPoint origin;
    Vector direction;  // unit length
    Departure departure;
    SampleKey key;
};

}  // namespace lapidary
