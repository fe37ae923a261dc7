// SPDX-License-Identifier: MIT
//
// Eight rays at once through the tree of a solid: LineThroughSolid's functions in lanes. Each is idempotent, so a lane that has
// arrived may take part in further rounds until all have.
#include "kernel/csg/label.h"
#include "kernel/csg/packet_through_solid.h"

namespace lapidary {

namespace {

constexpr int width = PacketThroughSolid::width;

void take_lesser(const Lanes& __restrict other, Lanes& __restrict t) {
    for (int i = 0; i < width; ++i) t[i] = other[i] < t[i] ? other[i] : t[i];
}

bool differ(const Lanes& a, const Lanes& b) {
    std::int64_t different = 0;
    for (int i = 0; i < width; ++i) different += a[i] != b[i];
    return different > 0;
}

unsigned bits_of(const Lanes& flags, int count) {
    unsigned bits = 0;
    for (int i = 0; i < count; ++i) bits |= static_cast<unsigned>(flags[i] != 0) << i;
    return bits;
}

}  // namespace

void PacketThroughSolid::next_change(const Solid& solid, const Lanes& limit, Changes& changes) {
    ask_leaves(solid);
    Lanes start, inside, out;
    start.v.fill(0);
    hold(solid.root, start, inside);
    changes.t = start;
    enter(solid.root, changes.t);
    changes.inside = bits_of(inside, rays_->count);
    if (changes.inside != 0) {
        out = start;
        leave(solid.root, out);
        for (int i = 0; i < width; ++i) changes.t[i] = inside[i] != 0 ? out[i] : changes.t[i];
    }
    for (int i = 0; i < width; ++i) {
        changes.t[i] = changes.t[i] <= limit[i] ? changes.t[i] : infinity;
    }
    changes.doubtful = solid.leaf_count > 1 ? find_doubtful(solid, inside, changes.t) : 0;
    find_changing_leaves(solid, changes);
}

PacketThroughSolid::FirstChange PacketThroughSolid::next_change_of_single(const Solid& solid, int lane) {
    line_.start(rays_->ray(lane));
    line_.select(solid);
    return {line_.next_change(0), line_.inside(0, Side::after)};
}

void PacketThroughSolid::ask_leaves(const Solid& solid) {
    first_leaf_ = solid.first_leaf;
    for (std::int32_t i = 0; i < solid.leaf_count; ++i) {
        LeafSpans& of_leaf = leaf_spans_[static_cast<std::size_t>(i)];
        spans(solid.first_leaf + i, of_leaf.in, of_leaf.out, &of_leaf);
    }
}

// A cell that ends within a sliver's length may be one.
unsigned PacketThroughSolid::find_doubtful(const Solid& solid, const Lanes& inside, const Lanes& t) const {
    Lanes further, held, doubtful;
    for (int i = 0; i < width; ++i) further[i] = t[i] < infinity ? t[i] + sliver_length(solid.rounding, t[i]) : infinity;
    hold(solid.root, further, held);
    for (int i = 0; i < width; ++i) doubtful[i] = t[i] < infinity && held[i] == inside[i] ? 1 : 0;
    return bits_of(doubtful, rays_->count);
}

// The leaf with an end of its span at t, where it is the only one: no other can be what changes there.
void PacketThroughSolid::find_changing_leaves(const Solid& solid, Changes& changes) const {
    changes.leaf.fill(-1), changes.face.fill(-1);
    LeafLanes ends{};
    for (std::int32_t l = 0; l < solid.leaf_count; ++l) {
        const LeafSpans& of_leaf = leaf_spans_[static_cast<std::size_t>(l)];
        const std::int64_t index = solid.first_leaf + l;
        for (int i = 0; i < width; ++i) {
            const bool ends_here = of_leaf.in[i] == changes.t[i] || of_leaf.out[i] == changes.t[i];
            changes.leaf[i] = ends_here ? index : changes.leaf[i];
            ends[i] += ends_here ? 1 : 0;
        }
        if (world_.leaves[index].first_surface < 0) continue;
        for (int i = 0; i < width; ++i) {
            const std::int64_t face = of_leaf.in[i] == changes.t[i] ? of_leaf.in_face[i] : of_leaf.out_face[i];
            changes.face[i] = changes.leaf[i] == index ? face : changes.face[i];
        }
    }
    for (int i = 0; i < width; ++i) changes.leaf[i] = ends[i] == 1 ? changes.leaf[i] : -1;
}

void PacketThroughSolid::enter(std::int32_t index, Lanes& t) const {
    const Node& node = world_.nodes[index];
    const auto all = operands_of(world_, node);
    switch (node.operation) {
        case Operation::leaf: {
            const LeafSpans& of_leaf = leaf_spans_[static_cast<std::size_t>(node.first - first_leaf_)];
            for (int i = 0; i < width; ++i) {
                const double in = of_leaf.in[i] > t[i] ? of_leaf.in[i] : t[i];
                t[i] = t[i] < of_leaf.out[i] ? in : infinity;
            }
            return;
        }
        case Operation::union_:
        case Operation::merge: {
            Lanes first;
            first.v.fill(infinity);
            for (std::int32_t operand : all) {
                Lanes of_operand = t;
                enter(operand, of_operand);
                take_lesser(of_operand, first);
            }
            t = first;
            return;
        }
        case Operation::intersection:
            for (Lanes before = t;; before = t) {
                for (std::int32_t operand : all) enter(operand, t);
                if (!differ(before, t)) return;
            }
        case Operation::subtraction:
            for (;;) {
                enter(all[0], t);
                const Lanes entered = t;
                for (std::int32_t subtrahend : all.subspan(1)) leave(subtrahend, t);
                if (!differ(entered, t)) return;
            }
        case Operation::symdiff:
            break;  // never fits lanes
    }
}

void PacketThroughSolid::leave(std::int32_t index, Lanes& t) const {
    const Node& node = world_.nodes[index];
    const auto all = operands_of(world_, node);
    switch (node.operation) {
        case Operation::leaf: {
            const LeafSpans& of_leaf = leaf_spans_[static_cast<std::size_t>(node.first - first_leaf_)];
            for (int i = 0; i < width; ++i) {
                const bool held = of_leaf.in[i] <= t[i] && t[i] < of_leaf.out[i];
                t[i] = held ? of_leaf.out[i] : t[i];
            }
            return;
        }
        case Operation::union_:
        case Operation::merge:
            for (Lanes before = t;; before = t) {
                for (std::int32_t operand : all) leave(operand, t);
                if (!differ(before, t)) return;
            }
        case Operation::intersection:
        case Operation::subtraction: {
            Lanes first;
            first.v.fill(infinity);
            for (std::size_t operand = 0; operand < all.size(); ++operand) {
                Lanes of_operand = t;
                if (node.operation == Operation::subtraction && operand > 0)
                    enter(all[operand], of_operand);
                else
                    leave(all[operand], of_operand);
                take_lesser(of_operand, first);
            }
            t = first;
            return;
        }
        case Operation::symdiff:
            break;
    }
}

// Which lanes are inside of a node just behind t: 1, else 0.
void PacketThroughSolid::hold(std::int32_t index, const Lanes& t, Lanes& held) const {
    const Node& node = world_.nodes[index];
    const auto all = operands_of(world_, node);
    if (node.operation == Operation::leaf) {
        const LeafSpans& of_leaf = leaf_spans_[static_cast<std::size_t>(node.first - first_leaf_)];
        for (int i = 0; i < width; ++i) held[i] = of_leaf.in[i] <= t[i] && t[i] < of_leaf.out[i] ? 1 : 0;
        return;
    }
    // All lanes are counted with: of an intersection all operands, of a subtraction the first alone, else any.
    Lanes of_operand;
    hold(all[0], t, held);
    for (std::int32_t operand : all.subspan(1)) {
        hold(operand, t, of_operand);
        for (int i = 0; i < width; ++i) switch (node.operation) {
                case Operation::intersection:
                    held[i] = held[i] * of_operand[i];
                    break;
                case Operation::subtraction:
                    held[i] = held[i] * (1 - of_operand[i]);
                    break;
                default:
                    held[i] = held[i] > of_operand[i] ? held[i] : of_operand[i];
            }
    }
}

}  // namespace lapidary
