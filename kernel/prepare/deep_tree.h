// SPDX-License-Identifier: MIT
//
// A tree of operations too deep to be followed from node to node, as its heavy paths.
//
// A node of more than two operands stands for a chain of nodes of two, ((a op b) op c) …. At every node the operand with more
// leaves is the heavy one; a path runs from a leaf upward for as long as it is the heavy one, and ends at the node where it is
// the light one, or at the root. Every leaf begins one path, and on the way from any leaf to the root there are at most log2 n
// of them: whatever changes at a leaf is felt in few paths.
#pragma once

#include <cstdint>
#include <vector>

#include "kernel/prepare/hierarchy.h"
#include "kernel/scene/scene.h"

namespace lapidary {

class World;
struct Solid;

struct DeepTree {
    // A node on a path: how it joins the light operand to what the path brings. Of a merge's chain of unions, the last step is
    // followed by one that makes all that is inside the merge's own.
    struct Step {
        enum class Kind : std::uint8_t { either, both, first_without_second, one_of_two, owned_by_merge };
        Kind kind = Kind::either;
        bool heavy_is_first = true;
        std::int32_t light = 0;  // the path that ends here; of owned_by_merge: an index into `merges`
    };
    // Path i begins at the i-th leaf of the solid; its steps go upward.
    struct Path {
        std::int32_t first_step = 0, step_count = 0;
        std::int32_t ends_on = -1,
                     ends_at = 0;  // the path and the step of it that this one is the light operand of; -1: the root
        std::int32_t first_part = 0, width = 1;  // its binary tree of compositions: 2 width entries, width a power of two
    };

    std::vector<Path> paths;
    std::vector<Step> steps;
    std::vector<std::int32_t> merges;  // nodes of the World
    std::int32_t root = 0;             // the path that ends at the root
    std::int32_t part_count = 0;       // of all paths together
    std::int32_t first_node = 0;       // of the solid, in World::nodes
    // Among operands that hold a point the leftmost owns it: no priorities are to be compared.
    bool leftmost_owns = true;

    Hierarchy hierarchy;                  // over the leaves, by their number in the solid
    std::vector<std::int32_t> unbounded;  // leaves outside the hierarchy
};

// The paths of a solid whose nodes, operands before operations, are the last ones of the World from `first_node` on.
DeepTree make_deep_tree(const World& world, const Solid& solid, std::int32_t first_node);

}  // namespace lapidary
