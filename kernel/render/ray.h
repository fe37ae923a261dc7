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
    // The leaf that owns the cell in which the ray should find itself, by what the ray before it met. It decides nothing: where
    // the ray finds another cell, which happens within rounding of an edge, that is counted.
    static constexpr std::int32_t no_cell = -1, unknown_cell = -2;
    std::int32_t cell = unknown_cell;
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
