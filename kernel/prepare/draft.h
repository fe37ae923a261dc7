// SPDX-License-Identifier: MIT
//
// The scene's trees on their way into the World: flattened, pruned by boxes, sheets taken out.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <optional>
#include <span>
#include <vector>

#include "kernel/prepare/containment.h"
#include "kernel/prepare/world.h"

namespace lapidary {

// A tree of a drafted leaf or operation: the number of an operation or, where negative, ~ that of a leaf.
using DraftTree = std::int32_t;
constexpr DraftTree empty_set = INT32_MAX;

// An operation with everything accumulated to its leaves.
struct Draft {
    Operation operation = Operation::union_;
    bool is_shared = false;    // stands elsewhere, too: as what clips a sheet
    std::int32_t medium = -1;  // of a merge with a material of its own
    std::int32_t leaf_count = 0, depth = 1;
    std::optional<double> priority;
    Bounds box;
    std::pmr::vector<DraftTree> operands;

    explicit Draft(std::pmr::memory_resource* memory) : operands(memory) {}
};

// A leaf, and what is known of it besides.
struct DraftLeaf {
    Leaf leaf;
    Bounds box;           // its box in doubles
    bool stands = false;  // in the World
};

class Drafts {
public:
    // Of a World that knows the leaves' faces.
    explicit Drafts(const World& world) : world_(world) {}

    // All that are drafted, in the order of writing; in the World they stand solid by solid.
    std::vector<DraftLeaf> leaves;

    const Draft& operator[](DraftTree operation) const { return operations_[static_cast<std::size_t>(operation)]; }
    const Bounds& box_of(DraftTree tree) const { return tree < 0 ? leaves[~tree].box : (*this)[tree].box; }
    std::int32_t leaf_count(DraftTree tree) const { return tree < 0 ? 1 : (*this)[tree].leaf_count; }
    std::int32_t depth(DraftTree tree) const { return tree < 0 ? 1 : (*this)[tree].depth; }

    // How far drafting has come, and back to there.
    struct Mark {
        std::size_t leaves = 0, operations = 0;
    };
    Mark mark() const { return {leaves.size(), operations_.size()}; }
    void forget_since(const Mark& mark);

    // From now on an operation must stay as it is.
    void share(DraftTree tree) {
        if (tree >= 0 && tree != empty_set) operations_[static_cast<std::size_t>(tree)].is_shared = true;
    }

    // An operation on operands, with what is empty or out of reach left out: an operand that is empty, an intersection whose
    // boxes miss one another, a subtrahend that misses what it is taken from, and all that a subtrahend swallows whole. Nested
    // operations of the same kind are joined where that changes nothing. The operands belong to this operation alone, and the
    // list of them is used up.
    DraftTree combine(Operation operation, std::span<DraftTree> operands, std::optional<double> priority, std::int32_t medium);

    // Splits a tree into the list of those whose union it is: unions fall apart, and an intersection with or a subtraction from a
    // union is distributed over it, each part keeping only the operands that its box meets. Gives up where the parts would have
    // more than twice the leaves, and after `levels` distributions inside one another.
    void split_into_solids(DraftTree tree, std::vector<DraftTree>& solids, int levels = 16);

private:
    // Leaves those operands that matter, and gives the box of the whole; nothing where that is empty.
    std::optional<Bounds> prune(Operation operation, std::span<DraftTree>& operands) const;
    Containment containment_of(DraftTree tree, DraftTree subtrahend) const;
    PlacedObject placed_object(DraftTree leaf) const;
    void add_operands(std::span<const DraftTree> operands, Draft& draft) const;
    bool may_join(DraftTree operand, Operation operation, bool stands_first) const;
    bool distributes(DraftTree tree) const;

    const World& world_;
    std::array<std::byte, 8192> first_memory_;
    std::pmr::monotonic_buffer_resource memory_{first_memory_.data(), first_memory_.size()};  // of the lists of operands
    std::vector<Draft> operations_;
};

// A sheet and what clips it.
struct SheetDraft {
    struct Condition {
        DraftTree clip = empty_set;
        bool inside = true;
    };
    std::int32_t leaf = -1;  // in Drafts::leaves
    std::vector<Condition> conditions;
};

}  // namespace lapidary
