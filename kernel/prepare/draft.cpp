// SPDX-License-Identifier: MIT
#include "kernel/prepare/draft.h"

#include <algorithm>
#include <utility>

namespace lapidary {

// Whether (a op b) op c is a op b op c: true where the nested one stands first, and it is an anonymous part whose medium and
// priority are decided with the rest. Further right, a subtraction is another set, and a symmetric difference, though the same
// set, may be owned by another operand.
bool Drafts::may_join(DraftTree operand, Operation operation, bool stands_first) const {
    if (operand < 0 || (*this)[operand].operation != operation) return false;
    if (operation == Operation::merge) return true;  // the outer one decides medium and priority of all of it
    if ((*this)[operand].priority) return false;
    return stands_first || (operation != Operation::subtraction && operation != Operation::symdiff);
}

void Drafts::forget_since(const Mark& mark) {
    leaves.erase(leaves.begin() + static_cast<std::ptrdiff_t>(mark.leaves), leaves.end());
    operations_.erase(operations_.begin() + static_cast<std::ptrdiff_t>(mark.operations), operations_.end());
    if (operations_.empty()) memory_.release();
}

std::optional<Bounds> Drafts::prune(Operation operation, std::span<DraftTree>& operands) const {
    if (operands.empty()) return std::nullopt;
    // What the empty set does to the whole.
    if (operation == Operation::subtraction && operands[0] == empty_set) return std::nullopt;
    const auto present = std::remove(operands.begin(), operands.end(), empty_set);
    if (present == operands.begin() || (operation == Operation::intersection && present != operands.end())) return std::nullopt;
    operands = {operands.begin(), present};

    Bounds box = box_of(operands[0]);
    if (operation == Operation::intersection) {
        for (DraftTree operand : operands) box = intersect(box, box_of(operand));
        if (box.is_empty()) return std::nullopt;
    } else if (operation == Operation::subtraction) {
        bool is_swallowed = false;
        const auto is_out_of_reach = [&](DraftTree operand) {
            if (!box_of(operand).overlaps(box)) return true;
            const Containment containment = containment_of(operands[0], operand);
            is_swallowed |= containment == Containment::inside;
            return containment == Containment::outside;
        };
        operands = {operands.begin(), std::remove_if(operands.begin() + 1, operands.end(), is_out_of_reach)};
        if (is_swallowed) return std::nullopt;
    } else {
        for (DraftTree operand : operands) box = unite(box, box_of(operand));
    }
    return box;
}

PlacedObject Drafts::placed_object(DraftTree leaf) const {
    const Leaf& of = leaves[~leaf].leaf;
    return {*of.object, of.placement, world_.faces_of(of)};
}

// Where a tree lies for a leaf that is taken out of it. What is left of an intersection or a subtraction lies where its first
// operand does, and that of an intersection where any of them does: of those only leaves are looked at. As most subtrahends are
// small bites, one whose box does not hold that of the tree is looked at no further.
Containment Drafts::containment_of(DraftTree tree, DraftTree subtrahend) const {
    if (subtrahend >= 0) return Containment::unknown;
    const Bounds &box = box_of(tree), &around = box_of(subtrahend);
    if (!around.contains(box.low) || !around.contains(box.high)) return Containment::unknown;
    constexpr int most_levels = 4, most_operands = 8;
    for (int i = 0; i < most_levels && tree >= 0 && (*this)[tree].operation == Operation::subtraction; ++i)
        tree = (*this)[tree].operands[0];
    const PlacedObject other = placed_object(subtrahend);
    if (tree < 0) return lapidary::containment_of(placed_object(tree), other);
    if ((*this)[tree].operation != Operation::intersection) return Containment::unknown;
    const std::span<const DraftTree> operands = (*this)[tree].operands;
    for (const DraftTree operand : operands.first(std::min<std::size_t>(most_operands, operands.size()))) {
        if (operand >= 0) continue;
        const Containment containment = lapidary::containment_of(placed_object(operand), other);
        if (containment != Containment::unknown) return containment;
    }
    return Containment::unknown;
}

DraftTree Drafts::combine(Operation operation, std::span<DraftTree> operands, std::optional<double> priority,
                          std::int32_t medium) {
    const std::optional<Bounds> box = prune(operation, operands);
    if (!box) return empty_set;
    if (operands.size() == 1 && !priority && medium < 0) return operands[0];

    // The first operand, where it may be joined, is continued: long chains are built in linear time.
    DraftTree tree = operands[0];
    if (may_join(tree, operation, true) && !(*this)[tree].is_shared) {
        operands = operands.subspan(1);
    } else {
        tree = static_cast<DraftTree>(operations_.size());
        operations_.emplace_back(&memory_).operands.reserve(operands.size());
    }
    Draft& draft = operations_[static_cast<std::size_t>(tree)];
    draft.operation = operation;
    draft.box = *box;
    draft.priority = priority;
    draft.medium = medium;
    add_operands(operands, draft);
    return tree;
}

void Drafts::add_operands(std::span<const DraftTree> operands, Draft& draft) const {
    for (DraftTree operand : operands) {
        draft.leaf_count += leaf_count(operand);
        if (may_join(operand, draft.operation, draft.operands.empty())) {
            const Draft& joined = (*this)[operand];
            draft.depth = std::max(draft.depth, joined.depth);
            draft.operands.insert(draft.operands.end(), joined.operands.begin(), joined.operands.end());
        } else {
            draft.depth = std::max(draft.depth, 1 + depth(operand));
            draft.operands.push_back(operand);
        }
    }
}

// Whether it is an intersection with or a subtraction from a union.
bool Drafts::distributes(DraftTree tree) const {
    const Draft& draft = (*this)[tree];
    if (draft.operation != Operation::subtraction && draft.operation != Operation::intersection) return false;
    const DraftTree first = draft.operands[0];
    return first >= 0 && (*this)[first].operation == Operation::union_ && !(*this)[first].priority && !draft.priority;
}

void Drafts::split_into_solids(DraftTree tree, std::vector<DraftTree>& solids, int levels) {
    if (tree < 0) {
        solids.push_back(tree);
        return;
    }
    // New drafts may move the others: what is needed of one is copied.
    if ((*this)[tree].operation == Operation::union_ && !(*this)[tree].priority) {
        for (std::size_t i = 0; i < (*this)[tree].operands.size(); ++i)
            split_into_solids((*this)[tree].operands[i], solids, levels);
        return;
    }
    if (levels > 0 && distributes(tree)) {
        const Operation operation = (*this)[tree].operation;
        const std::pmr::vector<DraftTree> operands = (*this)[tree].operands, united = (*this)[operands[0]].operands;
        std::vector<DraftTree> parts;
        std::int64_t count = 0;
        for (DraftTree part : united) {
            share(part);
            std::vector<DraftTree> part_operands{part};
            part_operands.insert(part_operands.end(), operands.begin() + 1, operands.end());
            const DraftTree distributed = combine(operation, part_operands, std::nullopt, -1);
            if (distributed == empty_set) continue;
            count += leaf_count(distributed);
            parts.push_back(distributed);
        }
        if (count <= 2 * std::int64_t{leaf_count(tree)}) {
            for (DraftTree part : parts) split_into_solids(part, solids, levels - 1);
            return;
        }
    }
    solids.push_back(tree);
}

}  // namespace lapidary
