// SPDX-License-Identifier: MIT
//
// A line through a tree of operations too deep to be followed from node to node.
//
// The ends of all leaves' spans are passed in order. Along a path of the tree (kernel/prepare/deep_tree.h) every step is a
// function of what the path brings from below, while its light operand stays as it is; of such functions there are few:
//
//     nothing below |-> nothing, or a light operand's      something below |-> itself, nothing, or a light operand's
//
// They compose to functions of the same form, kept in a binary tree for each path. When a leaf changes, its path's value does or
// does not; if it does, one function on the path above is replaced and log2 n compositions with it, and so on to the root: at
// most log2^2 n in all, without recursion, and mostly far fewer.
//
// Functions say whose something is, not only that it is: the owner of a cell comes with its inside.
#pragma once

#include <cstdint>
#include <vector>

#include "kernel/csg/label.h"
#include "kernel/prepare/world.h"

namespace lapidary {

class LineThroughDeepTree {
public:
    LineThroughDeepTree(const World& world, const Solid& solid);

    // The end of a leaf's span: the leaf, by its number in the solid, is left or entered.
    struct Event {
        double t;
        std::int32_t leaf;
    };
    // A new line, with no event yet.
    void start();
    // For each leaf, in the order of t.
    void add(std::int32_t leaf, const Span& span);
    void finish();

    // As LineThroughSolid has them, for the whole tree.
    double enter(double t);
    double leave(double t);
    Label label(double t, Side side);
    double next_change(double t);
    std::int32_t leaf_at(double t);

private:
    // What a function makes of nothing and of something: `nothing`, `itself`, or a number: of a light path, or behind those
    // of the merges.
    static constexpr std::int32_t nothing = -1, itself = -2;
    struct Function {
        std::int32_t of_nothing = nothing, of_something = itself;
        bool operator==(const Function&) const = default;
    };
    static Function after(const Function& first, const Function& second);
    Function function_of(const DeepTree::Step& step) const;

    // From one group of equal events to the next, the whole is one cell.
    struct Cell {
        double from;
        Label label;
        std::int32_t leaf;  // the one that changed at `from`, in the World; several: several_leaves
    };
    static constexpr std::int32_t several_leaves = -2;

    const Function& whole_of(const DeepTree::Path& path) const { return parts_[path.first_part + 1]; }
    bool is_something(std::int32_t path) const;
    void replace(const DeepTree::Path& path, std::int32_t step, const Function& function);
    void toggle(std::int32_t leaf);
    Label owner() const;
    Label merge_label(std::int32_t node) const;

    bool advance();
    std::size_t cell_at(double t, Side side);
    // Where the label of a tree of the solid stands among those of all: leaves first, then nodes.
    std::size_t place_of(std::int32_t tree) const;
    void evaluate_all(double t, Side side, std::vector<Label>& labels) const;

    const World& world_;
    const Solid& solid_;
    const DeepTree& tree_;
    std::vector<Function> parts_;
    std::vector<bool> inside_;  // of each leaf, at present
    std::vector<Event> events_;
    std::size_t passed_ = 0;  // of the events
    std::vector<Cell> cells_;
};

}  // namespace lapidary
