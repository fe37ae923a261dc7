// SPDX-License-Identifier: MIT
//
// What a cell of a line is made of, and how operations decide it from their operands.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>

#include "kernel/prepare/world.h"

namespace lapidary {

// The open cell of the line just before a position, or just behind it.
enum class Side : std::uint8_t { before, after };

// What the inside of a leaf is made of.
inline Label label_of_leaf(const World& world, std::int32_t leaf) {
    return {leaf, world.leaves[leaf].medium, world.leaves[leaf].priority};
}

// Whether an operation holds what its operands hold as `holds(operand)` says.
template <class Holds>
bool is_held(const World& world, const Node& node, Holds holds) {
    const auto all = world.operands_of(node);
    switch (node.operation) {
        case Operation::leaf:
            break;
        case Operation::union_:
        case Operation::merge:
            return std::any_of(all.begin(), all.end(), holds);
        case Operation::intersection:
            return std::all_of(all.begin(), all.end(), holds);
        case Operation::subtraction:
            return holds(all[0]) && std::none_of(all.begin() + 1, all.end(), holds);
        case Operation::symdiff:
            return std::count_if(all.begin(), all.end(), holds) % 2 == 1;
    }
    return false;
}

// What a cell inside of an operation is made of: of the operands that hold it, the one of highest priority, among equals the
// leftmost; for an intersection and a subtraction the left operand; for a merge its one material. Of `operands`, those of the
// node, such as may not hold the cell can be left out, but not the first one of a subtraction.
template <class LabelOf>
Label label_inside(const Node& node, std::span<const std::int32_t> operands, LabelOf label_of) {
    Label owner;
    switch (node.operation) {
        case Operation::leaf:
            break;
        case Operation::merge:
            owner = {node.leftmost, node.medium, 0};
            break;
        case Operation::intersection:
        case Operation::subtraction:
            owner = label_of(operands[0]);
            break;
        case Operation::union_:
            for (std::int32_t operand : operands) {
                const Label candidate = label_of(operand);
                if (candidate.is_empty()) continue;
                if (owner.is_empty() || candidate.priority > owner.priority) owner = candidate;
            }
            break;
        case Operation::symdiff:
            // ((a xor b) xor c) …: each operand that holds the cell takes it over from nothing, or makes nothing of it.
            for (std::int32_t operand : operands) {
                const Label candidate = label_of(operand);
                if (!candidate.is_empty()) owner = owner.is_empty() ? candidate : Label{};
            }
            break;
    }
    if (node.has_priority) owner.priority = node.priority;
    return owner;
}

// Whether a place lies inside of a node before and after a position.
struct Change {
    bool before, after;
    bool operator==(const Change&) const = default;
};

// The operand whose change is that of the whole: the first one, in order, that changes the way it must. Going in, an operand of
// a union or an intersection goes in, too; a subtrahend does the opposite of the whole. Where the inside of none changes, the
// first one whose label does. As above, operands that do not change can be left out, but not the first one of a subtraction.
template <class ChangeOf, class LabelChanges>
std::optional<std::int32_t> changing_operand(const Node& node, std::span<const std::int32_t> operands, const Change& whole,
                                             ChangeOf change_of, LabelChanges label_changes) {
    for (std::size_t i = 0; i < operands.size(); ++i) {
        const Change change = change_of(operands[i]);
        if (change.before == change.after) continue;
        const bool opposite = node.operation == Operation::subtraction && i > 0;
        const bool any_change = whole.before == whole.after || node.operation == Operation::symdiff;
        if (any_change || (change.after == whole.after) != opposite) return operands[i];
    }
    for (std::int32_t operand : operands)
        if (label_changes(operand)) return operand;
    return std::nullopt;
}

}  // namespace lapidary
