// SPDX-License-Identifier: MIT
//
// The base of all texture trees that cut space into regions and give each to one of their children. The author
// writes where space is cut:
//
//     std::int64_t choose(const Point& point) const;                                    // whose region a point lies in
//     Crossing next_cut(const MaterialLine& line, double from, double to) const;        // the first cut in from < t < to
//     double clearance_of_cuts(const Point& point) const;                               // a distance surely without cuts
//     auto children() const;                                                            // all slots, or their addresses
//
// and the template makes a Material of it: along a line, the boundaries are the cuts, and between two cuts those of the
// one child in effect there. Children are known by their numbers, from 0, in children().
//
// Of many points at once, each child is asked for all that lie in its regions. Where `choose` is a few lines without calls, a
// BatchedSelection lets the compiler make vector instructions of it; a texture that knows a better way for many points writes
//
//     void choose_batch(const PointBatch& points, unsigned lanes, ChoiceBatch& choices) const;  // for these lanes at least
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

#include "kernel/interfaces/material.h"
#include "lapidary/child.h"
#include "lapidary/crossings.h"

namespace lapidary {

// One number for a region of a region.
inline std::uint64_t combine_regions(std::uint64_t outer, std::uint64_t inner) {
    const std::uint64_t mixed = (outer ^ (inner + 0x9e3779b97f4a7c15)) * 0xbf58476d1ce4e5b9;
    return mixed ^ (mixed >> 31);
}

// The numbers of the children to whom the points of a batch are given. They are as wide as coordinates, as vectors want them.
struct alignas(64) ChoiceBatch {
    std::int64_t child[batch_size];

    // The lanes of a child: bit i for lane i.
    [[gnu::noinline]] unsigned lanes_of(std::int64_t number) const {
        std::int64_t lanes = 0;
        for (int lane = 0; lane < batch_size; ++lane) lanes |= child[lane] == number ? bit_of(lane) : 0;
        return static_cast<unsigned>(lanes);
    }
};

template <class Texture>
class Selection : public Material {
public:
    Matter evaluate(const Site& site) const override { return child_at(site.point).evaluate(site); }

    void evaluate_batch(const SiteBatch& sites, unsigned lanes, MatterBatch& matter) const override {
        ChoiceBatch choices;
        texture().choose_batch(sites.points, lanes, choices);
        for (unsigned rest = lanes; rest != 0;) {
            const std::int64_t number = choices.child[std::countr_zero(rest)];
            const unsigned chosen = rest & choices.lanes_of(number);
            child(number).evaluate_batch(sites, chosen, matter);
            rest &= ~chosen;
        }
    }

    // Cell by cell: the child of the open cell is found at its middle, where rounding cannot choose the wrong one.
    Crossing next_boundary(const MaterialLine& line, double from, double to) const override {
        if (!(from < to)) return {};
        const Crossing cut = texture().next_cut(line, from, to);
        const double end = cut.t < to ? cut.t : to;
        const Crossing inner = child_at(line.at(between(from, end))).next_boundary(line, from, end);
        if (inner.t < end) return inner;
        return cut.t < to ? cut : Crossing{};
    }

    std::uint64_t region(const Point& point) const override {
        const std::int64_t number = texture().choose(point);
        return combine_regions(static_cast<std::uint64_t>(number), child(number).region(point));
    }

    double clearance(const Point& point) const override {
        return std::min(texture().clearance_of_cuts(point), child_at(point).clearance(point));
    }

    bool has_boundaries() const override { return true; }
    bool may_be_transparent() const override { return any(&Material::may_be_transparent); }
    bool may_reflect() const override { return any(&Material::may_reflect); }
    bool may_have_relief() const override { return any(&Material::may_have_relief); }

    void choose_batch(const PointBatch& points, unsigned lanes, ChoiceBatch& choices) const {
        for_each_lane(lanes, [&](int lane) { choices.child[lane] = texture().choose(points.point(lane)); });
    }

private:
    const Texture& texture() const { return static_cast<const Texture&>(*this); }

    static const Material& in_slot(const Child& child) { return *child; }
    static const Material& in_slot(const Child* child) { return **child; }
    const Material& child(std::int64_t number) const { return in_slot(texture().children()[static_cast<std::size_t>(number)]); }
    const Material& child_at(const Point& point) const { return child(texture().choose(point)); }

    bool any(bool (Material::*property)() const) const {
        const auto& children = texture().children();
        return std::any_of(children.begin(), children.end(), [&](const auto& slot) { return (in_slot(slot).*property)(); });
    }
};

// All lanes are computed, whether asked for or not: a loop of constant length is what vectorises.
template <class Texture>
class BatchedSelection : public Selection<Texture> {
public:
    void choose_batch(const PointBatch& __restrict points, unsigned, ChoiceBatch& __restrict choices) const {
        const auto& texture = static_cast<const Texture&>(*this);
        for (int lane = 0; lane < batch_size; ++lane) choices.child[lane] = texture.choose(points.point(lane));
    }
};

}  // namespace lapidary
