// SPDX-License-Identifier: MIT
//
// The solids that rays of some kind may meet, found once for all of them.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "kernel/math/ball.h"
#include "kernel/prepare/world.h"

namespace lapidary {

// A bounded solid and its box, relative to the anchor of the World's hierarchy.
struct SolidInReach {
    std::array<float, 3> low, high;
    std::int32_t solid;
    Ball ball;                     // that the solid lies in, too
    double depth;                  // no ray meets the box before it has come as far
    unsigned quarters = all_rays;  // what part of the rays may meet it, where they are divided

    static constexpr unsigned all_rays = 15;
};

struct SolidsInReach {
    bool are_known = false;             // else they may be any of the World's
    std::vector<SolidInReach> bounded;  // by depth
    std::vector<std::int32_t> unbounded;
};

// The ball that a solid lies in, relative to the anchor of the World's hierarchy, where one is known.
inline Ball ball_of(const World& world, std::int32_t number) {
    const Solid& solid = world.solids[number];
    if (solid.ball < 0) return {};
    const Leaf& leaf = world.leaves[solid.first_leaf + solid.ball];
    return Ball::around(leaf.anchor(), leaf.radius(), world.hierarchy.anchor());
}

// Calls visit(low, high, solid) for the bounded solids whose boxes `region` may meet, until it answers false; whether it never
// did.
template <class Region, class Visit>
bool for_each_in_reach(const World& world, const Region& region, Visit visit) {
    const std::vector<Hierarchy::Node>& nodes = world.hierarchy.nodes();
    std::array<std::int32_t, 128> waiting;
    std::size_t size = 0;
    if (!nodes.empty()) waiting[size++] = 0;
    while (size > 0) {
        const Hierarchy::Node& node = nodes[static_cast<std::size_t>(waiting[--size])];
        for (std::size_t i = 0; i < 2; ++i) {
            const std::int32_t child = node.child[i];
            if (child == Hierarchy::no_child || !region.may_meet(node.low[i], node.high[i])) continue;
            if (child >= 0)
                waiting[size++] = child;
            else if (!visit(node.low[i], node.high[i], ~child))
                return false;
        }
    }
    return true;
}

}  // namespace lapidary
