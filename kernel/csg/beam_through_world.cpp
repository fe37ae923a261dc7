// SPDX-License-Identifier: MIT
#include "kernel/csg/beam_through_world.h"

#include <algorithm>

namespace lapidary {

void BeamThroughWorld::begin_tile(const Beam* beam) {
    tile_.clear(), part_.clear();
    part_is_known_ = false;
    tile_is_known_ = beam && list_tile({*beam, world_.hierarchy.anchor(), reach_});
}

// False where there are too many.
bool BeamThroughWorld::list_tile(const BeamAmongBoxes& beam) {
    const std::vector<Hierarchy::Node>& nodes = world_.hierarchy.nodes();
    std::array<std::int32_t, 128> waiting;
    int size = 0;
    if (!nodes.empty()) waiting[size++] = 0;
    while (size > 0) {
        const Hierarchy::Node& node = nodes[waiting[--size]];
        for (std::size_t i = 0; i < 2; ++i) {
            const std::int32_t child = node.child[i];
            if (child == Hierarchy::no_child || !beam.may_meet(node.low[i], node.high[i])) continue;
            if (child >= 0)
                waiting[size++] = child;
            else if (tile_.size() == most_of_tile)
                return false;
            else
                tile_.push_back({node.low[i], node.high[i], ~child, beam.depth(node.low[i], node.high[i])});
        }
    }
    std::sort(tile_.begin(), tile_.end(), [](const SolidInBeam& a, const SolidInBeam& b) { return a.depth < b.depth; });
    return true;
}

void BeamThroughWorld::begin_part(const Beam* beam) {
    part_.clear();
    part_is_known_ = false;
    if (!tile_is_known_ || !beam) return;
    const BeamAmongBoxes part(*beam, world_.hierarchy.anchor(), reach_);
    for (const SolidInBeam& solid : tile_) {
        if (!part.may_meet(solid.low, solid.high)) continue;
        if (part_.size() == most_of_part) return;
        part_.push_back(solid);
    }
    part_is_known_ = true;
}

}  // namespace lapidary
