// SPDX-License-Identifier: MIT
#include "kernel/csg/shaft_through_world.h"

#include "kernel/math/shaft.h"

namespace lapidary {

ShaftThroughWorld::ShaftThroughWorld(const World& world) : world_(world), reach_(world.hierarchy.reach()) {}

void ShaftThroughWorld::begin(const Bounds& from, const Bounds& to) {
    solids_.are_known = false;
    solids_.bounded.clear(), solids_.unbounded.clear();
    if (!from.is_finite() || !to.is_finite() || from.is_empty() || to.is_empty()) return;
    const Point anchor = world_.hierarchy.anchor();
    const ShaftAmongBoxes shaft(from, to, anchor, reach_);
    solids_.are_known = for_each_in_reach(world_, shaft, [&](const auto& low, const auto& high, std::int32_t solid) {
        if (solids_.bounded.size() == most) return false;
        solids_.bounded.push_back({low, high, solid, {}, 0});
        return true;
    });
    // Of many that are not listed, balls would be looked up for nothing.
    const auto is_beside = [&](const SolidInReach& solid) { return !shaft.may_meet(ball_of(world_, solid.solid)); };
    if (solids_.are_known) std::erase_if(solids_.bounded, is_beside);
    for (const std::int32_t solid : world_.unbounded) {
        const Bounds& box = world_.box_of(world_.solids[static_cast<std::size_t>(solid)].root);
        const Vector low = box.low - anchor, high = box.high - anchor;
        if (shaft.may_meet(std::array{low.x, low.y, low.z}, std::array{high.x, high.y, high.z}))
            solids_.unbounded.push_back(solid);
    }
}

}  // namespace lapidary
