// SPDX-License-Identifier: MIT
//
// The scene's trees on their way into the World: flattened, pruned by boxes, sheets taken out.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "kernel/prepare/world.h"

namespace lapidary {

// A tree of operations with everything accumulated to its leaves. Null stands for the empty set. Shared, because a
// distributed subtrahend and the clip of a sheet stand in several places.
struct Draft {
    Operation operation = Operation::leaf;
    std::int32_t leaf = -1;    // of a leaf: its index in the list of all that are drafted
    std::int32_t medium = -1;  // of a merge with a material of its own
    std::vector<std::shared_ptr<Draft>> operands;
    Bounds box;
    std::optional<double> priority;
    std::size_t leaf_count = 1;
    std::size_t depth = 1;  // of the tree, in nodes

    Draft() = default;
    Draft(const Draft&) = delete;
    Draft& operator=(const Draft&) = delete;
    // Trees may be very deep: released one node after the other, not one inside the other.
    ~Draft();
};
using DraftPtr = std::shared_ptr<Draft>;

// A sheet and what clips it.
struct SheetDraft {
    struct Condition {
        DraftPtr clip;  // null: the empty set
        bool inside = true;
    };
    Leaf leaf;
    std::vector<Condition> conditions;
};

// An operation on operands, with what is empty or out of reach left out: an operand that is empty,
// an intersection whose boxes miss one another, a subtrahend whose box misses what it is taken from. Nested operations of the
// same kind are joined where that changes nothing.
DraftPtr combine(Operation operation, std::vector<DraftPtr> operands, std::optional<double> priority, std::int32_t medium);

// Splits a solid into the list of solids whose union it is: unions fall apart, and an intersection with or a subtraction from
// a union is distributed over it, each part keeping only the operands that its box meets. Gives up where the parts would have
// more than twice the leaves, and after `levels` distributions inside one another.
void split_into_solids(const DraftPtr& draft, std::vector<DraftPtr>& solids, int levels = 16);

}  // namespace lapidary
