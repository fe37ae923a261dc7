// SPDX-License-Identifier: MIT
//
// A packet of rays through the tree of a solid: LineThroughSolid's functions in lanes. Each is idempotent, so a lane that has
// arrived may take part in further rounds until all have.
#include "kernel/csg/label.h"
#include "kernel/csg/packet_through_solid.h"

namespace lapidary {

namespace {

constexpr int width = PacketThroughSolid::width;
using LeafLanes = PacketThroughSolid::LeafLanes;

// Loops over lanes stand apart from all else, without branches and with nothing that overlaps: so they become vector
// instructions.

[[gnu::noinline]] void take_lesser(const Lanes& __restrict other, Lanes& __restrict t) {
    for (int i = 0; i < width; ++i) t[i] = other[i] < t[i] ? other[i] : t[i];
}

[[gnu::noinline]] bool differ(const Lanes& a, const Lanes& b) {
    std::int64_t different = 0;
    for (int i = 0; i < width; ++i) different += a[i] != b[i];
    return different > 0;
}

[[gnu::noinline]] void enter_span(const Lanes& __restrict in, const Lanes& __restrict out, Lanes& __restrict t) {
    for (int i = 0; i < width; ++i) {
        const double later = in[i] > t[i] ? in[i] : t[i];
        t[i] = t[i] < out[i] ? later : infinity;
    }
}

[[gnu::noinline]] void leave_span(const Lanes& __restrict in, const Lanes& __restrict out, Lanes& __restrict t) {
    for (int i = 0; i < width; ++i) {
        const double at = t[i], end = out[i], if_held = at < end ? end : at;
        t[i] = in[i] <= at ? if_held : at;
    }
}

[[gnu::noinline]] void hold_span(const Lanes& __restrict in, const Lanes& __restrict out, const Lanes& __restrict t,
                                 Lanes& __restrict held) {
    for (int i = 0; i < width; ++i) {
        const double before_end = t[i] < out[i] ? 1 : 0;
        held[i] = in[i] <= t[i] ? before_end : 0;
    }
}

[[gnu::noinline]] void hold_both(const Lanes& __restrict other, Lanes& __restrict held) {
    for (int i = 0; i < width; ++i) held[i] = held[i] * other[i];
}
[[gnu::noinline]] void hold_without(const Lanes& __restrict other, Lanes& __restrict held) {
    for (int i = 0; i < width; ++i) held[i] = held[i] * (1 - other[i]);
}
[[gnu::noinline]] void hold_either(const Lanes& __restrict other, Lanes& __restrict held) {
    for (int i = 0; i < width; ++i) held[i] = held[i] > other[i] ? held[i] : other[i];
}

// The lanes among the first `count` whose flag is not 0: bit i for lane i.
[[gnu::noinline]] unsigned bits_of(const Lanes& flags, int count) {
    std::int64_t bits = 0;
    for (int i = 0; i < width; ++i) bits += flags[i] != 0 ? bit_of(i) : 0;
    return static_cast<unsigned>(bits) & ((1U << count) - 1);
}

[[gnu::noinline]] void choose(const Lanes& __restrict inside, const Lanes& __restrict way_out, const Lanes& __restrict limit,
                              Lanes& __restrict t) {
    for (int i = 0; i < width; ++i) {
        const double change = inside[i] != 0 ? way_out[i] : t[i];
        t[i] = change <= limit[i] ? change : infinity;
    }
}

// Counts the leaves with an end at t.
[[gnu::noinline]] void count_ends(const Lanes& __restrict in, const Lanes& __restrict out, std::int64_t index,
                                  const Lanes& __restrict t, LeafLanes& __restrict leaf, LeafLanes& __restrict ends) {
    for (int i = 0; i < width; ++i) {
        const double at = t[i], begin = in[i], end = out[i];
        const std::int64_t shown = leaf[i], if_end = end == at ? index : shown;
        leaf[i] = begin == at ? index : if_end;
        const std::int64_t is_end = end == at ? 1 : 0;
        ends[i] += begin == at ? 1 : is_end;
    }
}

// The end of a span behind `from`, and the lanes that are inside there.
[[gnu::noinline]] unsigned next_end(const Lanes& __restrict in, const Lanes& __restrict out, const Lanes& __restrict from,
                                    const Lanes& __restrict limit, Lanes& __restrict t) {
    std::int64_t inside = 0;
    for (int i = 0; i < width; ++i) {
        const double begin = in[i], end = out[i], at = from[i];
        const double of_span = begin <= at ? end : begin, next = at < end ? of_span : infinity;
        t[i] = next <= limit[i] ? next : infinity;
        const std::int64_t if_begun = begin <= at ? bit_of(i) : 0;
        inside += at < end ? if_begun : 0;
    }
    return static_cast<unsigned>(inside);
}

[[gnu::noinline]] void choose_faces(const Lanes& __restrict in, const LeafLanes& __restrict in_face,
                                    const LeafLanes& __restrict out_face, PacketThroughSolid::Changes& __restrict changes) {
    for (int i = 0; i < width; ++i) {
        const std::int64_t at_entry = in_face[i], at_exit = out_face[i];
        changes.face[i] = in[i] == changes.t[i] ? at_entry : at_exit;
    }
}

// Of the lanes where this leaf changes.
[[gnu::noinline]] void name_faces(const Lanes& __restrict in, const LeafLanes& __restrict in_face,
                                  const LeafLanes& __restrict out_face, std::int64_t index,
                                  PacketThroughSolid::Changes& __restrict changes) {
    for (int i = 0; i < width; ++i) {
        const std::int64_t at_entry = in_face[i], at_exit = out_face[i], kept = changes.face[i];
        const std::int64_t face = in[i] == changes.t[i] ? at_entry : at_exit;
        changes.face[i] = changes.leaf[i] == index ? face : kept;
    }
}

[[gnu::noinline]] void keep_single_ends(const LeafLanes& __restrict ends, LeafLanes& __restrict leaf) {
    for (int i = 0; i < width; ++i) leaf[i] = ends[i] == 1 ? leaf[i] : -1;
}

[[gnu::noinline]] void find_further(double rounding, const Lanes& __restrict t, Lanes& __restrict further) {
    for (int i = 0; i < width; ++i) further[i] = t[i] + sliver_length(rounding, t[i]);
}

}  // namespace

void PacketThroughSolid::next_change(const Solid& solid, const Lanes& from, const Lanes& limit, Changes& changes) {
    if (all_leave(solid, limit) || all_pass_beside(solid, limit)) {  // outside, and nothing comes any more
        changes.t.v.fill(infinity), changes.leaf.fill(-1), changes.face.fill(-1);
        changes.inside = changes.doubtful = 0;
        return;
    }
    ask_leaves(solid);
    if (solid.leaf_count == 1) {
        next_change_of_leaf(solid.first_leaf, from, limit, changes);
        return;
    }
    Lanes inside;
    hold(solid.root, from, inside);
    changes.t = from;
    enter(solid.root, changes.t);
    Lanes way_out = from;
    changes.inside = bits_of(inside, rays_->count);
    if (changes.inside != 0) leave(solid.root, way_out);
    choose(inside, way_out, limit, changes.t);
    changes.doubtful = find_doubtful(solid, inside, changes.t);
    find_changing_leaves(solid, changes);
}

// One span: no tree to be followed, nothing that could be a sliver.
void PacketThroughSolid::next_change_of_leaf(std::int32_t index, const Lanes& from, const Lanes& limit, Changes& changes) const {
    const LeafSpans& of_leaf = leaf_spans_.front();
    changes.inside = next_end(of_leaf.in, of_leaf.out, from, limit, changes.t) & ((1U << rays_->count) - 1);
    changes.doubtful = 0;
    changes.leaf.fill(index);
    if (world_.leaves[index].first_surface >= 0) choose_faces(of_leaf.in, of_leaf.in_face, of_leaf.out_face, changes);
}

PacketThroughSolid::FirstChange PacketThroughSolid::next_change_of_single(const Solid& solid, double from, int lane) {
    line_.start(rays_->ray(lane));
    line_.select(solid);
    return {line_.next_change(from), line_.inside(from, Side::after)};
}

void PacketThroughSolid::ask_leaves(const Solid& solid) {
    first_leaf_ = solid.first_leaf;
    for (std::int32_t i = 0; i < solid.leaf_count; ++i) {
        LeafSpans& of_leaf = leaf_spans_[static_cast<std::size_t>(i)];
        spans(solid.first_leaf + i, of_leaf.in, of_leaf.out, &of_leaf);
    }
}

// A cell that ends within a sliver's length may be one. Nothing is at infinity.
unsigned PacketThroughSolid::find_doubtful(const Solid& solid, const Lanes& inside, const Lanes& t) const {
    Lanes further, held;
    find_further(solid.rounding, t, further);
    hold(solid.root, further, held);
    std::int64_t bits = 0;
    for (int i = 0; i < width; ++i) {
        const std::int64_t if_alike = held[i] == inside[i] ? bit_of(i) : 0;
        bits += t[i] < infinity ? if_alike : 0;
    }
    return static_cast<unsigned>(bits) & ((1U << rays_->count) - 1);
}

// The leaf with an end of its span at t, where it is the only one: no other can be what changes there.
void PacketThroughSolid::find_changing_leaves(const Solid& solid, Changes& changes) const {
    changes.leaf.fill(-1), changes.face.fill(-1);
    LeafLanes ends{};
    for (std::int32_t l = 0; l < solid.leaf_count; ++l) {
        const LeafSpans& of_leaf = leaf_spans_[static_cast<std::size_t>(l)];
        const std::int64_t index = solid.first_leaf + l;
        count_ends(of_leaf.in, of_leaf.out, index, changes.t, changes.leaf, ends);
        if (world_.leaves[index].first_surface < 0) continue;
        name_faces(of_leaf.in, of_leaf.in_face, of_leaf.out_face, index, changes);
    }
    keep_single_ends(ends, changes.leaf);
}

void PacketThroughSolid::enter(std::int32_t tree, Lanes& t) const {
    if (tree < 0) {
        const LeafSpans& of_leaf = leaf_spans_[static_cast<std::size_t>(~tree - first_leaf_)];
        enter_span(of_leaf.in, of_leaf.out, t);
        return;
    }
    const Node& node = world_.nodes[tree];
    const auto all = world_.operands_of(node);
    switch (node.operation) {
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
        case Operation::leaf:
        case Operation::symdiff:
            break;  // never fits lanes
    }
}

void PacketThroughSolid::leave(std::int32_t tree, Lanes& t) const {
    if (tree < 0) {
        const LeafSpans& of_leaf = leaf_spans_[static_cast<std::size_t>(~tree - first_leaf_)];
        leave_span(of_leaf.in, of_leaf.out, t);
        return;
    }
    const Node& node = world_.nodes[tree];
    const auto all = world_.operands_of(node);
    switch (node.operation) {
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
        case Operation::leaf:
        case Operation::symdiff:
            break;
    }
}

// Which lanes are inside of a tree just behind t: 1, else 0.
void PacketThroughSolid::hold(std::int32_t tree, const Lanes& t, Lanes& held) const {
    if (tree < 0) {
        const LeafSpans& of_leaf = leaf_spans_[static_cast<std::size_t>(~tree - first_leaf_)];
        hold_span(of_leaf.in, of_leaf.out, t, held);
        return;
    }
    const Node& node = world_.nodes[tree];
    const auto all = world_.operands_of(node);
    // All lanes are counted with: of an intersection all operands, of a subtraction the first alone, else any.
    Lanes of_operand;
    hold(all[0], t, held);
    for (std::int32_t operand : all.subspan(1)) {
        hold(operand, t, of_operand);
        if (node.operation == Operation::intersection)
            hold_both(of_operand, held);
        else if (node.operation == Operation::subtraction)
            hold_without(of_operand, held);
        else
            hold_either(of_operand, held);
    }
}

}  // namespace lapidary
