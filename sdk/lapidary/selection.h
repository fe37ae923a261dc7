// SPDX-License-Identifier: MIT
//
// The base of all texture trees that cut space into regions and give each to one of their children. The author
// writes where space is cut:
//
//     const Child& choose(const Point& point) const;                                    // whose region a point lies in
//     Crossing next_cut(const MaterialLine& line, double from, double to) const;        // the first cut in from < t < to
//     double clearance_of_cuts(const Point& point) const;                               // a distance surely without cuts
//     auto children() const;                                                            // the addresses of all slots
//
// and the template makes a Material of it: along a line, the boundaries are the cuts, and between two cuts those of the
// one child in effect there.
#pragma once

#include <algorithm>
#include <array>

#include "kernel/interfaces/material.h"
#include "lapidary/child.h"
#include "lapidary/crossings.h"

namespace lapidary {

// One number for a region of a region.
inline std::uint64_t combine_regions(std::uint64_t outer, std::uint64_t inner) {
    const std::uint64_t mixed = (outer ^ (inner + 0x9e3779b97f4a7c15)) * 0xbf58476d1ce4e5b9;
    return mixed ^ (mixed >> 31);
}

template <class Texture>
class Selection : public Material {
public:
    Matter evaluate(const Site& site) const override { return texture().choose(site.point)->evaluate(site); }

    // Cell by cell: the child of the open cell is found at its middle, where rounding cannot choose the wrong one.
    Crossing next_boundary(const MaterialLine& line, double from, double to) const override {
        if (!(from < to)) return {};
        const Crossing cut = texture().next_cut(line, from, to);
        const double end = cut.t < to ? cut.t : to;
        const Child& child = texture().choose(line.at(between(from, end)));
        const Crossing inner = child->next_boundary(line, from, end);
        if (inner.t < end) return inner;
        return cut.t < to ? cut : Crossing{};
    }

    std::uint64_t region(const Point& point) const override {
        const Child& child = texture().choose(point);
        return combine_regions(reinterpret_cast<std::uintptr_t>(&child), child->region(point));
    }

    double clearance(const Point& point) const override {
        return std::min(texture().clearance_of_cuts(point), texture().choose(point)->clearance(point));
    }

    bool has_boundaries() const override { return true; }
    bool may_be_transparent() const override { return any(&Material::may_be_transparent); }
    bool may_reflect() const override { return any(&Material::may_reflect); }
    bool may_have_relief() const override { return any(&Material::may_have_relief); }

private:
    const Texture& texture() const { return static_cast<const Texture&>(*this); }

    bool any(bool (Material::*property)() const) const {
        const auto children = texture().children();
        return std::any_of(children.begin(), children.end(), [&](const Child* child) { return ((**child).*property)(); });
    }
};

}  // namespace lapidary
