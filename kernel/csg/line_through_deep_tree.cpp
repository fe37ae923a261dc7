// SPDX-License-Identifier: MIT
#include "kernel/csg/line_through_deep_tree.h"

#include <algorithm>

namespace lapidary {

LineThroughDeepTree::LineThroughDeepTree(const World& world, const Solid& solid)
    : world_(world),
      solid_(solid),
      tree_(world.deep_trees[static_cast<std::size_t>(solid.deep_tree)]),
      parts_(static_cast<std::size_t>(tree_.part_count)),
      inside_(tree_.paths.size()) {
    // All leaves are left: no light operand holds anything.
    for (const DeepTree::Path& path : tree_.paths) {
        for (std::int32_t i = 0; i < path.step_count; ++i)
            parts_[path.first_part + path.width + i] = function_of(tree_.steps[path.first_step + i]);
        for (std::int32_t i = path.width - 1; i > 0; --i)
            parts_[path.first_part + i] = after(parts_[path.first_part + 2 * i], parts_[path.first_part + 2 * i + 1]);
    }
}

LineThroughDeepTree::Function LineThroughDeepTree::after(const Function& first, const Function& second) {
    // What the second makes of a value that the first came to.
    const auto then = [&second](std::int32_t value) {
        if (value == nothing) return second.of_nothing;
        return second.of_something == itself ? value : second.of_something;
    };
    return {then(first.of_nothing), then(first.of_something)};
}

// Whether anything is inside of what a path comes to.
bool LineThroughDeepTree::is_something(std::int32_t path) const {
    const Function& whole = whole_of(tree_.paths[path]);
    return (inside_[path] ? whole.of_something : whole.of_nothing) != nothing;
}

LineThroughDeepTree::Function LineThroughDeepTree::function_of(const DeepTree::Step& step) const {
    constexpr Function identity{}, never{nothing, nothing};
    using Kind = DeepTree::Step::Kind;
    if (step.kind == Kind::owned_by_merge) return {nothing, static_cast<std::int32_t>(tree_.paths.size()) + step.light};
    const bool held = is_something(step.light);
    switch (step.kind) {
        case Kind::either:
            return !held ? identity : Function{step.light, step.heavy_is_first ? itself : step.light};
        case Kind::both:
            return !held ? never : Function{nothing, step.heavy_is_first ? itself : step.light};
        case Kind::first_without_second:
            if (step.heavy_is_first) return held ? never : identity;
            return held ? Function{step.light, nothing} : never;
        case Kind::one_of_two:
            return held ? Function{step.light, nothing} : identity;
        case Kind::owned_by_merge:
            break;
    }
    return identity;
}

void LineThroughDeepTree::replace(const DeepTree::Path& path, std::int32_t step, const Function& function) {
    std::int32_t at = path.width + step;
    Function* const parts = parts_.data() + path.first_part;
    if (parts[at] == function) return;
    parts[at] = function;
    for (at /= 2; at > 0; at /= 2) {
        const Function composed = after(parts[2 * at], parts[2 * at + 1]);
        if (parts[at] == composed) return;
        parts[at] = composed;
    }
}

// A leaf is entered or left: up from its path, as long as what a path comes to changes.
void LineThroughDeepTree::toggle(std::int32_t leaf) {
    bool was_something = is_something(leaf);
    inside_[leaf] = !inside_[leaf];
    for (std::int32_t index = leaf; is_something(index) != was_something;) {
        const DeepTree::Path& path = tree_.paths[index];
        if (path.ends_on < 0) return;
        index = path.ends_on;
        was_something = is_something(index);
        const DeepTree::Path& above = tree_.paths[index];
        replace(above, path.ends_at, function_of(tree_.steps[above.first_step + path.ends_at]));
    }
}

Label LineThroughDeepTree::merge_label(std::int32_t node) const {
    return {world_.nodes[node].leftmost, world_.nodes[node].medium, 0};
}

// Whose the present cell is: from the root into the light path that its value comes from, and so on, to a leaf or a merge.
Label LineThroughDeepTree::owner() const {
    const auto path_count = static_cast<std::int32_t>(tree_.paths.size());
    for (std::int32_t path = tree_.root;;) {
        const Function& whole = whole_of(tree_.paths[path]);
        const std::int32_t value = inside_[path] ? whole.of_something : whole.of_nothing;
        if (value == nothing) return {};
        if (value == itself) return label_of_leaf(world_, solid_.first_leaf + path);
        if (value >= path_count) return merge_label(tree_.merges[value - path_count]);
        path = value;
    }
}

void LineThroughDeepTree::start() {
    // Leaving what is still inside brings all functions back to where they were.
    for (const Event& event : events_)
        if (inside_[event.leaf]) toggle(event.leaf);
    events_.clear();
}

void LineThroughDeepTree::add(std::int32_t leaf, const Span& span) {
    events_.push_back({span.in, leaf});
    if (span.out < infinity) events_.push_back({span.out, leaf});
}

void LineThroughDeepTree::finish() {
    std::sort(events_.begin(), events_.end(),
              [](const Event& a, const Event& b) { return a.t < b.t || (a.t == b.t && a.leaf < b.leaf); });
    passed_ = 0;
    cells_.assign(1, {-infinity, {}, -1});
}

// Passes the next group of equal events. False: there is none.
bool LineThroughDeepTree::advance() {
    if (passed_ == events_.size()) return false;
    const double t = events_[passed_].t;
    const std::size_t first = passed_;
    for (; passed_ < events_.size() && events_[passed_].t == t; ++passed_) toggle(events_[passed_].leaf);

    Label label = owner();
    if (!tree_.leftmost_owns && !label.is_empty()) {
        std::vector<Label> labels;
        evaluate_all(t, Side::after, labels);
        label = labels.back();
    }
    const std::int32_t leaf = passed_ - first == 1 ? solid_.first_leaf + events_[first].leaf : several_leaves;
    if (!(label == cells_.back().label)) cells_.push_back({t, label, leaf});
    return true;
}

// The cell at a position, or the one before where it begins there.
std::size_t LineThroughDeepTree::cell_at(double t, Side side) {
    while (passed_ < events_.size() && events_[passed_].t <= t) advance();
    const auto begins_later = [side](double position, const Cell& cell) {
        return side == Side::after ? cell.from > position : cell.from >= position;
    };
    const auto later = std::upper_bound(cells_.begin() + 1, cells_.end(), t, begins_later);
    return static_cast<std::size_t>(later - cells_.begin()) - 1;
}

Label LineThroughDeepTree::label(double t, Side side) { return cells_[cell_at(t, side)].label; }

double LineThroughDeepTree::enter(double t) {
    std::size_t cell = cell_at(t, Side::after);
    if (!cells_[cell].label.is_empty()) return t;
    for (++cell; cell == cells_.size() || cells_[cell].label.is_empty();) {
        if (cell < cells_.size())
            ++cell;
        else if (!advance())
            return infinity;
    }
    return cells_[cell].from;
}

double LineThroughDeepTree::leave(double t) {
    if (t == infinity) return t;
    std::size_t cell = cell_at(t, Side::after);
    if (cells_[cell].label.is_empty()) return t;
    for (++cell; cell == cells_.size() || !cells_[cell].label.is_empty();) {
        if (cell < cells_.size())
            ++cell;
        else if (!advance())
            return infinity;
    }
    return cells_[cell].from;
}

double LineThroughDeepTree::next_change(double t) {
    const std::size_t next = cell_at(t, Side::after) + 1;
    while (next == cells_.size())
        if (!advance()) return infinity;
    return cells_[next].from;
}

// Where several leaves change at once, which of them stands for the whole is decided as in a shallow tree, from the root down.
std::int32_t LineThroughDeepTree::leaf_at(double t) {
    const Cell& cell = cells_[cell_at(t, Side::after)];
    if (cell.from != t) return -1;
    if (cell.leaf != several_leaves) return cell.leaf;

    std::vector<Label> before, after;
    evaluate_all(t, Side::before, before);
    evaluate_all(t, Side::after, after);
    const auto change_of = [&](std::int32_t tree) {
        const std::size_t i = place_of(tree);
        return Change{!before[i].is_empty(), !after[i].is_empty()};
    };
    const auto label_changes = [&](std::int32_t tree) {
        const std::size_t i = place_of(tree);
        return !(before[i] == after[i]);
    };
    for (std::optional<std::int32_t> tree = solid_.root; tree;) {
        const Change change = change_of(*tree);
        if (*tree < 0) return change.before != change.after ? ~*tree : -1;
        const Node& node = world_.nodes[*tree];
        tree = changing_operand(node, world_.operands_of(node), change, change_of, label_changes);
    }
    return -1;
}

std::size_t LineThroughDeepTree::place_of(std::int32_t tree) const {
    return static_cast<std::size_t>(tree < 0 ? ~tree - solid_.first_leaf : solid_.leaf_count + tree - tree_.first_node);
}

// The label of every leaf and every node of the solid, operands before operations.
void LineThroughDeepTree::evaluate_all(double t, Side side, std::vector<Label>& labels) const {
    labels.assign(tree_.paths.size(), {});
    for (const Event& event : events_)
        if (side == Side::after ? event.t <= t : event.t < t) {
            Label& label = labels[static_cast<std::size_t>(event.leaf)];
            label = label.is_empty() ? label_of_leaf(world_, solid_.first_leaf + event.leaf) : Label{};
        }
    const auto label_of = [&](std::int32_t tree) { return labels[place_of(tree)]; };
    const auto holds = [&](std::int32_t tree) { return !label_of(tree).is_empty(); };
    for (std::int32_t index = tree_.first_node; index <= solid_.root; ++index) {
        const Node& node = world_.nodes[index];
        labels.push_back(is_held(world_, node, holds) ? label_inside(node, world_.operands_of(node), label_of) : Label{});
    }
}

}  // namespace lapidary
