// SPDX-License-Identifier: MIT
//
// Which solids camera rays of a part of the picture may meet, so that what no ray comes near is not looked for ray by ray.
//
// It is found in two steps: what the beam of a tile may meet once for all of its rays, and of that what those rays may meet that
// are traced together. Where a tile sees too many solids no list is kept, and rays find their way through the hierarchy.
#pragma once

#include <vector>

#include "kernel/csg/solids_in_reach.h"
#include "kernel/export.h"
#include "kernel/math/beam.h"

namespace lapidary {

class LAPIDARY_API BeamThroughWorld {
public:
    explicit BeamThroughWorld(const World& world);

    // From now on rays lie within a tile's beam; null: anywhere.
    void begin_tile(const Beam* beam);
    // Of these, within a part of it; `in_quarters`: the nth quarter of its rays is within quarter 2^n of QuartersOfBeam.
    void begin_part(const Beam* beam, bool in_quarters);

    const SolidsInReach& solids() const { return part_; }
    // Whether the rays meet nothing, whichever they are.
    bool is_empty() const { return part_.are_known && part_.bounded.empty() && part_.unbounded.empty() && world_.sheets.empty(); }

private:
    // More than these, and packets do better with a hierarchy.
    static constexpr std::size_t most_of_tile = 256, most_of_part = 48;
    // Of more than these several are left for each packet, which tests their boxes anyway.
    static constexpr std::size_t most_by_quarters = 6;

    bool list_tile(const Beam& beam);
    // Of the unbounded solids, those that the beam does not run away from.
    void keep_unbounded(const std::vector<std::int32_t>& solids, const Beam& beam, std::vector<std::int32_t>& kept) const;
    void divide_part(const Beam& beam);

    const World& world_;
    double reach_;
    std::vector<SolidInReach> tile_;
    std::vector<std::int32_t> unbounded_of_tile_;
    bool tile_is_known_ = false;
    SolidsInReach part_;
};

}  // namespace lapidary
