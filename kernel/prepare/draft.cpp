// SPDX-License-Identifier: MIT
#include "kernel/prepare/draft.h"

#include <algorithm>
#include <iterator>

namespace lapidary {

namespace {

// Whether (a op b) op c is a op b op c: true where the nested one stands first, and it is an anonymous part whose medium and
// priority are decided with the rest. Further right, a subtraction is another set, and a symmetric difference, though the same
// set, may be owned by another operand.
bool may_join(const Draft& operand, Operation operation, bool stands_first) {
    if (operand.operation != operation) return false;
    if (operation == Operation::merge) return true;  // the outer one decides medium and priority of all of it
    if (operand.priority) return false;
    return stands_first || (operation != Operation::subtraction && operation != Operation::symdiff);
}

}  // namespace

Draft::~Draft() {
    std::vector<DraftPtr> pending = std::move(operands);
    while (!pending.empty()) {
        const DraftPtr draft = std::move(pending.back());
        pending.pop_back();
        if (draft.use_count() > 1) continue;
        std::move(draft->operands.begin(), draft->operands.end(), std::back_inserter(pending));
        draft->operands.clear();
    }
}

DraftPtr combine(Operation operation, std::vector<DraftPtr> operands, std::optional<double> priority, std::int32_t medium) {
    if (operands.empty()) return nullptr;
    // What the empty set does to the whole.
    if (operation == Operation::subtraction && !operands[0]) return nullptr;
    if (operation == Operation::intersection && std::find(operands.begin(), operands.end(), nullptr) != operands.end())
        return nullptr;
    operands.erase(std::remove(operands.begin(), operands.end(), nullptr), operands.end());
    if (operands.empty()) return nullptr;

    Bounds box = operands[0]->box;
    if (operation == Operation::intersection) {
        for (const DraftPtr& operand : operands) box = intersect(box, operand->box);
        if (box.is_empty()) return nullptr;
    } else if (operation == Operation::subtraction) {
        operands.erase(
            std::remove_if(operands.begin() + 1, operands.end(), [&](const DraftPtr& d) { return !d->box.overlaps(box); }),
            operands.end());
    } else {
        for (const DraftPtr& operand : operands) box = unite(box, operand->box);
    }
    if (operands.size() == 1 && !priority && medium < 0) return operands[0];

    // The first operand, where it may be joined and belongs to nobody else, is continued: long chains are built in linear time.
    const bool continues = operands[0].use_count() == 1 && may_join(*operands[0], operation, true);
    const DraftPtr draft = continues ? std::move(operands[0]) : std::make_shared<Draft>();
    draft->operation = operation;
    draft->box = box;
    draft->priority = priority;
    draft->medium = medium;
    if (continues)
        operands.erase(operands.begin());
    else
        draft->leaf_count = 0;
    for (DraftPtr& operand : operands) {
        draft->leaf_count += operand->leaf_count;
        if (may_join(*operand, operation, draft->operands.empty())) {
            draft->depth = std::max(draft->depth, operand->depth);
            draft->operands.insert(draft->operands.end(), operand->operands.begin(), operand->operands.end());
        } else {
            draft->depth = std::max(draft->depth, 1 + operand->depth);
            draft->operands.push_back(std::move(operand));
        }
    }
    return draft;
}

void split_into_solids(const DraftPtr& draft, std::vector<DraftPtr>& solids, int levels) {
    const bool is_union = draft->operation == Operation::union_ && !draft->priority;
    if (is_union) {
        for (const DraftPtr& operand : draft->operands) split_into_solids(operand, solids, levels);
        return;
    }
    const bool distributes =
        levels > 0 && (draft->operation == Operation::subtraction || draft->operation == Operation::intersection) &&
        draft->operands[0]->operation == Operation::union_ && !draft->operands[0]->priority && !draft->priority;
    if (distributes) {
        std::vector<DraftPtr> parts;
        std::size_t leaves = 0;
        for (const DraftPtr& part : draft->operands[0]->operands) {
            std::vector<DraftPtr> operands{part};
            operands.insert(operands.end(), draft->operands.begin() + 1, draft->operands.end());
            if (DraftPtr distributed = combine(draft->operation, std::move(operands), std::nullopt, -1)) {
                leaves += distributed->leaf_count;
                parts.push_back(std::move(distributed));
            }
        }
        if (leaves <= 2 * draft->leaf_count) {
            for (const DraftPtr& part : parts) split_into_solids(part, solids, levels - 1);
            return;
        }
    }
    solids.push_back(draft);
}

}  // namespace lapidary
