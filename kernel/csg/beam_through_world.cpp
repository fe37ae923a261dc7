// SPDX-License-Identifier: MIT
#include "kernel/csg/beam_through_world.h"

#include <algorithm>

namespace lapidary {

BeamThroughWorld::BeamThroughWorld(const World& world) : world_(world), reach_(world.hierarchy.reach()) {}

void BeamThroughWorld::begin_tile(const Beam* beam) {
    tile_.clear(), part_.bounded.clear();
    part_.are_known = false;
    tile_is_known_ = beam && list_tile(*beam);
    if (tile_is_known_) keep_unbounded(world_.unbounded, *beam, unbounded_of_tile_);
}

void BeamThroughWorld::keep_unbounded(const std::vector<std::int32_t>& solids, const Beam& beam,
                                      std::vector<std::int32_t>& kept) const {
    kept.clear();
    for (const std::int32_t solid : solids)
        if (!beam.runs_away_from(world_.box_of(world_.solids[static_cast<std::size_t>(solid)].root))) kept.push_back(solid);
}

// False where there are too many.
bool BeamThroughWorld::list_tile(const Beam& beam) {
    const Point anchor = world_.hierarchy.anchor();
    const BeamAmongBoxes among_boxes(beam, anchor, reach_);
    const DepthInBeam depth(beam, anchor, reach_);
    const bool is_complete = for_each_in_reach(world_, among_boxes, [&](const auto& low, const auto& high, std::int32_t solid) {
        if (tile_.size() == most_of_tile) return false;
        tile_.push_back({low, high, solid, {}, depth(low, high)});
        return true;
    });
    if (!is_complete) return false;
    for (SolidInReach& solid : tile_) solid.ball = ball_of(world_, solid.solid);
    std::erase_if(tile_, [&](const SolidInReach& solid) { return !among_boxes.may_meet(solid.ball); });
    std::sort(tile_.begin(), tile_.end(), [](const SolidInReach& a, const SolidInReach& b) { return a.depth < b.depth; });
    return true;
}

void BeamThroughWorld::begin_part(const Beam* beam, bool in_quarters) {
    part_.bounded.clear();
    part_.are_known = false;
    if (!tile_is_known_ || !beam) return;
    const Point anchor = world_.hierarchy.anchor();
    const BeamAmongBoxes part(*beam, anchor, reach_);
    for (const SolidInReach& solid : tile_) {
        if (!part.may_meet(solid.ball) || !part.may_meet(solid.low, solid.high)) continue;
        if (part_.bounded.size() == most_of_part) return;
        part_.bounded.push_back(solid);
    }
    keep_unbounded(unbounded_of_tile_, *beam, part_.unbounded);
    part_.are_known = true;
    if (in_quarters && part_.bounded.size() > 1 && part_.bounded.size() <= most_by_quarters) divide_part(*beam);
}

void BeamThroughWorld::divide_part(const Beam& beam) {
    const QuartersOfBeam quarters(beam, world_.hierarchy.anchor(), reach_);
    for (SolidInReach& solid : part_.bounded) solid.quarters = quarters.that_may_meet(solid.low, solid.high, solid.ball);
}

}  // namespace lapidary
