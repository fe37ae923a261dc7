// SPDX-License-Identifier: MIT
#include "kernel/prepare/deep_tree.h"

#include <algorithm>
#include <bit>
#include <span>
#include <utility>

#include "kernel/prepare/world.h"

namespace lapidary {

namespace {

DeepTree::Step::Kind kind_of(Operation operation) {
    switch (operation) {
        case Operation::intersection:
            return DeepTree::Step::Kind::both;
        case Operation::subtraction:
            return DeepTree::Step::Kind::first_without_second;
        case Operation::symdiff:
            return DeepTree::Step::Kind::one_of_two;
        default:
            return DeepTree::Step::Kind::either;
    }
}

// The paths while they grow, each with its own list of steps.
class Growth {
public:
    Growth(const World& world, const Solid& solid, std::int32_t first_node, DeepTree& tree)
        : world_(world), solid_(solid), tree_(tree), steps_(static_cast<std::size_t>(solid.leaf_count)) {
        tree_.paths.resize(steps_.size());
        tree_.first_node = first_node;
    }

    // Nodes stand in the order of their numbers, operands first: one pass over them needs no stack.
    void grow() {
        for (std::int32_t index = tree_.first_node; index <= solid_.root; ++index) tops_.push_back(grow(world_.nodes[index]));
        tree_.root = tops_.back().path;
        for (std::size_t i = 0; i < steps_.size(); ++i) lay_out(tree_.paths[i], steps_[i]);
    }

private:
    // What has been grown of a subtree: the path that comes out of it, and how many leaves it has.
    struct Top {
        std::int32_t path, leaves;
    };

    Top top_of(std::int32_t tree) {
        if (tree >= 0) return tops_[tree - tree_.first_node];
        if (world_.leaves[~tree].priority != 0) tree_.leftmost_owns = false;
        return {~tree - solid_.first_leaf, 1};
    }

    Top grow(const Node& node) {
        if (node.has_priority) tree_.leftmost_owns = false;
        const std::span<const std::int32_t> operands = world_.operands_of(node);
        Top top = top_of(operands[0]);
        for (std::int32_t operand : operands.subspan(1)) top = join(kind_of(node.operation), top, top_of(operand));
        if (node.operation == Operation::merge) {
            steps_[top.path].push_back(
                {DeepTree::Step::Kind::owned_by_merge, true, static_cast<std::int32_t>(tree_.merges.size())});
            tree_.merges.push_back(static_cast<std::int32_t>(&node - world_.nodes.data()));
        }
        return top;
    }

    Top join(DeepTree::Step::Kind kind, const Top& first, const Top& second) {
        const bool heavy_is_first = first.leaves >= second.leaves;
        const Top &heavy = heavy_is_first ? first : second, &light = heavy_is_first ? second : first;
        tree_.paths[light.path].ends_on = heavy.path;
        tree_.paths[light.path].ends_at = static_cast<std::int32_t>(steps_[heavy.path].size());
        steps_[heavy.path].push_back({kind, heavy_is_first, light.path});
        return {heavy.path, first.leaves + second.leaves};
    }

    void lay_out(DeepTree::Path& path, const std::vector<DeepTree::Step>& steps) {
        path.first_step = static_cast<std::int32_t>(tree_.steps.size());
        path.step_count = static_cast<std::int32_t>(steps.size());
        tree_.steps.insert(tree_.steps.end(), steps.begin(), steps.end());
        path.width = static_cast<std::int32_t>(std::bit_ceil(std::max<std::size_t>(steps.size(), 1)));
        path.first_part = tree_.part_count;
        tree_.part_count += 2 * path.width;
    }

    const World& world_;
    const Solid& solid_;
    DeepTree& tree_;
    std::vector<std::vector<DeepTree::Step>> steps_;
    std::vector<Top> tops_;
};

}  // namespace

DeepTree make_deep_tree(const World& world, const Solid& solid, std::int32_t first_node) {
    DeepTree tree;
    Growth(world, solid, first_node, tree).grow();

    std::vector<Bounds> boxes;
    boxes.reserve(static_cast<std::size_t>(solid.leaf_count));
    for (std::int32_t i = 0; i < solid.leaf_count; ++i) boxes.push_back(world.leaves[solid.first_leaf + i].bounds());
    tree.hierarchy = Hierarchy(boxes, 0, tree.unbounded);
    return tree;
}

}  // namespace lapidary
