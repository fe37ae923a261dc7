// SPDX-License-Identifier: MIT
//
// Which solids camera rays of a part of the picture may meet, so that what no ray comes near is not looked for ray by ray.
//
// It is found in two steps: what the beam of a tile may meet once for all of its rays, and of that what those rays may meet that
// are traced together. Where a tile sees too many solids no list is kept, and rays find their way through the hierarchy.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "kernel/export.h"
#include "kernel/math/beam.h"
#include "kernel/prepare/world.h"

namespace lapidary {

// A solid and its box, relative to the anchor of the World's hierarchy.
struct SolidInBeam {
    std::array<float, 3> low, high;
    std::int32_t solid;
    double depth;  // where the box begins
};

class LAPIDARY_API BeamThroughWorld {
public:
    explicit BeamThroughWorld(const World& world) : world_(world), reach_(world.hierarchy.reach()) {}

    // From now on rays lie within a tile's beam; null: anywhere.
    void begin_tile(const Beam* beam);
    // Of these, within a part of it.
    void begin_part(const Beam* beam);

    // Whether all solids of the hierarchy that the part may meet are listed: near ones first.
    bool is_known() const { return part_is_known_; }
    std::span<const SolidInBeam> solids() const { return part_; }
    // Whether the rays meet nothing, whichever they are.
    bool is_empty() const { return part_is_known_ && part_.empty() && world_.unbounded.empty() && world_.sheets.empty(); }

private:
    // More than these, and packets do better with a hierarchy.
    static constexpr std::size_t most_of_tile = 48, most_of_part = 6;

    bool list_tile(const BeamAmongBoxes& beam);

    const World& world_;
    double reach_;
    std::vector<SolidInBeam> tile_, part_;
    bool tile_is_known_ = false, part_is_known_ = false;
};

}  // namespace lapidary
