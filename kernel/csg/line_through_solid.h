// SPDX-License-Identifier: MIT
//
// Constructive solid geometry along a line.
//
// A leaf answers with half-open spans in <= t < out. On them every operation is evaluated by leaping: two functions,
//
//     enter(n, t) = smallest t' >= t inside n        leave(n, t) = smallest t' >= t outside n
//
//     leaf              t < out ? max(t, in) : inf            in <= t < out ? out : t
//     union, merge      min over operands                     repeat t = leave(operand, t) until unchanged
//     intersection      repeat t = enter(operand, t)          min over operands
//                         until all agree
//     a - b - c …       repeat t = enter(a, t), leave(b, t)…  min(leave(a, t), enter(b, t) …)
//                         until unchanged
//     symmetric         step from change to change until an odd (even) number of operands holds the point
//
// t only grows and only takes ends of spans as values: no lists, no sort, no allocation. An operand whose box the line
// misses, or whose box does not hold the point, is not asked at all.
//
// Half-open spans are the regularised operations as soon as coincident ends are equal bit for bit, which surface classes
// see to: abutting solids join without a face, a shared face subtracts cleanly, a solid minus itself is nothing.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "kernel/csg/label.h"
#include "kernel/csg/line_through_deep_tree.h"
#include "kernel/prepare/hierarchy.h"
#include "kernel/prepare/world.h"
#include "kernel/render/ray.h"
#include "kernel/render/tracer.h"

namespace lapidary {

// A face met at a known position.
struct FaceHit {
    std::int32_t leaf = -1;
    std::int32_t face = 0;  // as Object::face numbers them
    Point local;            // on the face, in the leaf's space
    TwoPartPoint point;     // the same in the world
    Normal normal;          // unit, in the world, out of the leaf
    std::int32_t surface_class = -1;
    bool class_flipped = false;  // the leaf lies outside of what the class's representative bounds
};

// One ray through one solid of the World. Owns scratch memory and is reused for many rays: start() a ray, select() a
// solid, then ask. All answers are pure functions of ray and solid.
class LAPIDARY_API LineThroughSolid {
public:
    LineThroughSolid(const World& world, TraceStatistics& statistics);

    void start(const Ray& ray);
    void select(const Solid& solid);

    // Rule S: where three or more different surfaces pass through one line or point, rounding can put their crossings into an
    // order that no true arrangement has, and leave a false cell of rounding size. enter() does not enter, and leave() does
    // not leave, for a cell no longer than that.
    double enter(double t);
    double leave(double t);
    bool inside(double t, Side side);
    Label label(double t, Side side);
    // The first position behind t where the inside or its medium changes; infinity where nothing does.
    double next_change(double t);
    // The leaf whose face represents the change at t: of coincident faces the left operand's. -1 where nothing changes.
    std::int32_t leaf_at(double t);
    // The face of a leaf met at t, an end of one of its spans.
    FaceHit face_at(std::int32_t leaf, double t);

    // Where the line crosses a sheet, a leaf of no solid; infinity where it does not.
    double cross_sheet(std::int32_t leaf);

private:
    // A leaf's line in its own space; t in the world = anchor + t along the local line.
    struct PlacedLine {
        LocalLine line;
        double anchor = 0;
    };
    struct CachedSpans {
        std::uint64_t stamp = 0;
        std::int32_t count = 0;
    };

    const PlacedLine& placed_line(std::int32_t leaf);
    std::span<const Span> spans(std::int32_t leaf);
    int intersect_surfaces(const Leaf& leaf, Span* out);
    int surface_spans(const SurfaceUse& use, Span* out);
    int plane_spans(const SurfaceClass& surface_class, bool departing, Span* out);
    int in_world(const PlacedLine& placed, const Leaf& leaf, std::span<const Surface> faces, bool departing, Span* spans,
                 int count) const;

    // The whole solid, slivers included: node by node, or as a deep tree.
    double enter_root(double t);
    double leave_root(double t);
    LineThroughDeepTree& deep_tree();

    // Of a tree: a node or, where negative, ~ a leaf.
    double enter(std::int32_t tree, double t);
    double leave(std::int32_t tree, double t);
    double enter_leaf(std::int32_t index, double t);
    double leave_leaf(std::int32_t index, double t);
    bool inside_leaf(std::int32_t index, double t, Side side);
    bool inside(std::int32_t tree, double t, Side side);
    Label label(std::int32_t tree, double t, Side side);
    std::int32_t leaf_at(std::int32_t tree, double t);
    double first_change(std::span<const std::int32_t> operands, double t);

    // The same functions of many operands' union, by their hierarchy: those that cannot matter are not asked.
    double enter_united(const Node& node, double t);
    double leave_united(const Node& node, double t);
    bool inside_united(const Node& node, double t, Side side);
    // The operands of a node that may hold a place or change there, in order, and the first one of a subtraction; `memory` holds
    // them where they are not all.
    std::span<const std::int32_t> operands_at(const Node& node, double t, std::vector<std::int32_t>& memory) const;
    double slack(double t) const { return 0x1p-50 * (origin_size_ + std::fabs(t)); }
    bool box_holds(const Bounds& box, double t) const;
    bool box_is_missed(const Bounds& box, double t) const;
    std::span<const std::int32_t> operands(const Node& node) const { return world_.operands_of(node); }

    const World& world_;
    TraceStatistics& statistics_;
    const Solid* solid_ = nullptr;
    Ray ray_;
    Point origin_;
    double origin_size_ = 0;
    SlabLine slabs_;
    std::int32_t placed_leaf_ = -1;  // whose line placed_ is: a leaf is often asked several times in a row
    PlacedLine placed_;
    std::uint64_t stamp_ = 0;
    std::vector<CachedSpans> cached_;
    std::vector<Span> cached_spans_;
    std::vector<Span> scratch_;

    // Planes that many leaves share are mostly asked for again soon: those met last, each at its place by its number.
    struct PlaneSpan {
        std::uint64_t ray = 0;
        std::int32_t surface_class = -1;
        std::int32_t count = 0;
        Span span;
    };
    static constexpr std::size_t plane_count = 64;
    std::array<PlaneSpan, plane_count> planes_;

    // For each deep tree of the World, made when it is first met, and the number of the ray that it holds the line of.
    struct DeepLine {
        std::unique_ptr<LineThroughDeepTree> tree;
        std::uint64_t ray = 0;
    };
    std::uint64_t ray_number_ = 0;
    std::vector<DeepLine> deep_lines_;
};

}  // namespace lapidary
