// SPDX-License-Identifier: MIT
#include "kernel/csg/line_through_solid.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "kernel/csg/departure.h"
#include "kernel/csg/near_root.h"
#include "kernel/math/roots.h"

namespace lapidary {

namespace {

// The most spans that the surfaces of one leaf can have on the way to their intersection: a double cone has two, its
// complement three.
constexpr int most_surface_spans = 4;

}  // namespace

LineThroughSolid::LineThroughSolid(const World& world, TraceStatistics& statistics)
    : world_(world),
      statistics_(statistics),
      slabs_({}, {}),
      cached_(static_cast<std::size_t>(world.most_leaves)),
      cached_spans_(static_cast<std::size_t>(world.most_leaves) * static_cast<std::size_t>(world.most_spans)),
      scratch_(static_cast<std::size_t>(world.most_spans)),
      deep_lines_(world.deep_trees.size()) {}

void LineThroughSolid::start(const Ray& ray) {
    ray_ = ray;
    origin_ = ray.origin.rounded();
    origin_size_ = std::max({std::fabs(origin_.x), std::fabs(origin_.y), std::fabs(origin_.z)});
    slabs_ = SlabLine(origin_, ray.direction);
    solid_ = nullptr;
    placed_leaf_ = -1;
    ++stamp_;
    ++ray_number_;
}

void LineThroughSolid::select(const Solid& solid) {
    if (solid_ == &solid) return;
    solid_ = &solid;
    ++stamp_;
}

// Takes the ray into a leaf's space about the point closest to its centre. The origin moves along the ray in the world
// first, in two parts, so that what is multiplied by the inverse matrix is short; one more step in the leaf's own space
// makes the point perpendicular there, too: where shapes are kept, no more than rounding, and a direction of the world's unit
// length has a length there that is known. Where the space is lopsided that step may be long, and leaves rounding of its length
// along the line; another one takes that away.
const LineThroughSolid::PlacedLine& LineThroughSolid::placed_line(std::int32_t index) {
    if (placed_leaf_ == index) return placed_;
    placed_leaf_ = index;
    const Leaf& leaf = world_.leaves[index];
    const Vector& d = ray_.direction;
    const TwoPartVector from_centre = ray_.origin - leaf.placement.centre();
    const double world_step = -dot(from_centre.hi, d);
    const Vector world_closest =
        Vector{fused_multiply_add(world_step, d.x, from_centre.hi.x), fused_multiply_add(world_step, d.y, from_centre.hi.y),
               fused_multiply_add(world_step, d.z, from_centre.hi.z)} +
        from_centre.lo;
    const Vector closest = leaf.placement.to_local(world_closest);
    const Vector direction = leaf.placement.to_local(d);
    const double along = dot(closest, direction), squared_scale = leaf.placement.squared_scale();
    const double step = leaf.placement.keeps_shapes() ? -along * squared_scale : -along / dot(direction, direction);
    placed_ = {{{fused_multiply_add(step, direction.x, closest.x), fused_multiply_add(step, direction.y, closest.y),
                 fused_multiply_add(step, direction.z, closest.z)},
                direction},
               world_step + step};
    if (leaf.placement.is_lopsided()) {
        Point& near = placed_.line.closest;
        const double again = -dot(near, direction) / dot(direction, direction);
        near = {fused_multiply_add(again, direction.x, near.x), fused_multiply_add(again, direction.y, near.y),
                fused_multiply_add(again, direction.z, near.z)};
        placed_.anchor += again;
    }
    return placed_;
}

std::span<const Span> LineThroughSolid::spans(std::int32_t index) {
    const auto slot = static_cast<std::size_t>(index - solid_->first_leaf);
    CachedSpans& cached = cached_[slot];
    Span* out = &cached_spans_[slot * static_cast<std::size_t>(world_.most_spans)];
    if (cached.stamp != stamp_) {
        cached.stamp = stamp_;
        const Leaf& leaf = world_.leaves[index];
        ++statistics_.object_tests;
        if (leaf.first_surface >= 0) {
            cached.count = intersect_surfaces(leaf, out);
        } else {
            const PlacedLine& placed = placed_line(index);
            cached.count = leaf.object->spans(placed.line, out);
            cached.count = in_world(placed, leaf, world_.faces_of(leaf), ray_.departure.leaf == index, out, cached.count);
        }
    }
    return {out, static_cast<std::size_t>(cached.count)};
}

// Takes spans from the leaf's t to that of the ray, which may depart from one of the given faces. Returns how many remain.
int LineThroughSolid::in_world(const PlacedLine& placed, const Leaf& leaf, std::span<const Surface> faces, bool departing,
                               Span* spans, int count) const {
    for (int i = 0; i < count; ++i) spans[i] = {placed.anchor + spans[i].in, placed.anchor + spans[i].out};
    if (departing) count = remove_departure_root(spans, count, ray_.departure.inward);
    for (int i = 0; i < count; ++i) find_near_ends(spans[i], ray_, leaf.placement, faces, placed.anchor, departing);
    return count;
}

// A leaf that shares faces with others is the intersection of what its surfaces bound, each met at its class's t.
int LineThroughSolid::intersect_surfaces(const Leaf& leaf, Span* out) {
    std::array<Span, most_surface_spans> common{Span::all()};
    int count = 1;
    for (std::int32_t i = 0; i < leaf.surface_count && count > 0; ++i) {
        std::array<Span, most_surface_spans> of_surface, both;
        const int surface_count = surface_spans(world_.surface_uses[leaf.first_surface + i], of_surface.data());
        int kept = 0;
        for (int a = 0; a < count; ++a)
            for (int b = 0; b < surface_count; ++b) {
                const Span shared = intersect(common[a], of_surface[b]);
                if (!shared.is_empty() && kept < most_surface_spans) both[kept++] = shared;
            }
        common = both;
        count = kept;
    }
    // Where surfaces meet in a point, rounding may leave a trace of what the leaf does not reach: the cone's other nappe.
    while (count > 1 && count > leaf.object->max_spans()) {
        const auto end = common.begin() + count;
        const auto shortest =
            std::min_element(common.begin(), end, [](const Span& a, const Span& b) { return a.out - a.in < b.out - b.in; });
        std::move(shortest + 1, end, shortest);
        --count;
    }
    std::copy_n(common.begin(), count, out);
    return count;
}

// Where the line runs on the leaf's side of a surface: by the representative's frame and numbers, so that every leaf of
// the class gets the same bits.
int LineThroughSolid::surface_spans(const SurfaceUse& use, Span* out) {
    const SurfaceClass& surface_class = world_.surface_classes[use.surface_class];
    const bool departing = ray_.departure.surface_class == use.surface_class;
    int count = 0;
    if (surface_class.is(Surface::Kind::plane)) {
        PlaneSpan& plane = planes_[static_cast<std::size_t>(use.surface_class) % plane_count];
        if (plane.ray != ray_number_ || plane.surface_class != use.surface_class) {
            plane.ray = ray_number_;
            plane.surface_class = use.surface_class;
            plane.count = plane_spans(surface_class, departing, &plane.span);
        }
        out[0] = plane.span;
        count = plane.count;
    } else {
        const Leaf& leaf = world_.leaves[surface_class.leaf];
        const PlacedLine& placed = placed_line(surface_class.leaf);
        const Surface& surface = surface_class.surface;
        if (surface_class.is(Surface::Kind::cylinder)) {
            out[0] = tube_span(placed.line, surface.a);
            count = out[0].is_empty() ? 0 : 1;
        } else if (surface_class.is(Surface::Kind::cone)) {
            count = double_cone_spans(placed.line, surface.a, surface.b, out);
        } else {
            count = leaf.object->spans(placed.line, out);  // the surface bounds all of the solid
        }
        const auto faces = surface_class.whole ? std::span<const Surface>() : std::span<const Surface>(&surface, 1);
        count = in_world(placed, leaf, faces, departing, out, count);
    }
    return use.flipped ? complement(out, count) : count;
}

int LineThroughSolid::plane_spans(const SurfaceClass& surface_class, bool departing, Span* out) {
    if (departing) {
        out[0] = ray_.departure.inward ? Span{0, infinity} : Span{-infinity, 0};
        return 1;
    }
    const Leaf& leaf = world_.leaves[surface_class.leaf];
    const PlacedLine& placed = placed_line(surface_class.leaf);
    const Vector normal{surface_class.surface.a, surface_class.surface.b, surface_class.surface.c};
    const double slope = dot(normal, placed.line.direction);
    const double distance = dot(placed.line.closest, normal) - surface_class.surface.d;
    const double t = placed.anchor - distance / slope;
    if (slope == 0 || !std::isfinite(t)) {
        const bool inside = (distance != 0 ? distance : surface_class.shifted_by) < 0;
        out[0] = Span::all();
        return inside ? 1 : 0;
    }
    out[0] = slope > 0 ? Span{-infinity, t} : Span{t, infinity};
    find_near_ends(out[0], ray_, leaf.placement, {&surface_class.surface, 1}, placed.anchor, departing);
    return 1;
}

// Whether the point at t may be inside the box; the point carries the rounding of origin and t.
bool LineThroughSolid::box_holds(const Bounds& box, double t) const {
    const double rounding = slack(t);
    const Point p = origin_ + t * ray_.direction;
    return p.x >= box.low.x - rounding && p.x <= box.high.x + rounding && p.y >= box.low.y - rounding &&
           p.y <= box.high.y + rounding && p.z >= box.low.z - rounding && p.z <= box.high.z + rounding;
}

// Whether the line never meets the box from t on.
bool LineThroughSolid::box_is_missed(const Bounds& box, double t) const {
    double near = 0;
    const std::array<double, 3> low{box.low.x, box.low.y, box.low.z}, high{box.high.x, box.high.y, box.high.z};
    return !slabs_.meets(low, high, t, infinity, near);
}

double LineThroughSolid::enter(double t) {
    for (;;) {
        const double in = enter_root(t);
        if (in == infinity || solid_->leaf_count == 1) return in;
        // What is inside a sliver's length further on, too, is no sliver: the common case, cheap to see.
        const double longest = sliver_length(solid_->rounding, in);
        if (inside(in + longest, Side::after)) return in;
        const double out = leave_root(in);
        if (out - in > longest) return in;
        if (!(out > t)) return infinity;  // numbers have overflowed, and no step leads on
        ++statistics_.slivers_removed;
        t = out;
    }
}

double LineThroughSolid::leave(double t) {
    for (;;) {
        const double out = leave_root(t);
        if (out == infinity || solid_->leaf_count == 1) return out;
        const double longest = sliver_length(solid_->rounding, out);
        if (!inside(out + longest, Side::after)) return out;
        const double in = enter_root(out);
        if (in - out > longest || out == t) return out;
        ++statistics_.slivers_removed;
        t = in;
    }
}

double LineThroughSolid::enter_root(double t) { return solid_->deep_tree < 0 ? enter(solid_->root, t) : deep_tree().enter(t); }

double LineThroughSolid::leave_root(double t) { return solid_->deep_tree < 0 ? leave(solid_->root, t) : deep_tree().leave(t); }

bool LineThroughSolid::inside(double t, Side side) {
    return solid_->deep_tree < 0 ? inside(solid_->root, t, side) : !deep_tree().label(t, side).is_empty();
}

Label LineThroughSolid::label(double t, Side side) {
    return solid_->deep_tree < 0 ? label(solid_->root, t, side) : deep_tree().label(t, side);
}

std::int32_t LineThroughSolid::leaf_at(double t) {
    return solid_->deep_tree < 0 ? leaf_at(solid_->root, t) : deep_tree().leaf_at(t);
}

// The selected solid's deep tree, with the spans of all leaves that the line meets from its start on.
LineThroughDeepTree& LineThroughSolid::deep_tree() {
    DeepLine& line = deep_lines_[static_cast<std::size_t>(solid_->deep_tree)];
    if (line.tree && line.ray == ray_number_) return *line.tree;
    if (!line.tree) line.tree = std::make_unique<LineThroughDeepTree>(world_, *solid_);
    line.ray = ray_number_;
    line.tree->start();
    const auto add = [&](std::int32_t leaf) {
        for (const Span& span : spans(solid_->first_leaf + leaf)) line.tree->add(leaf, span);
        return infinity;
    };
    const DeepTree& tree = world_.deep_trees[static_cast<std::size_t>(solid_->deep_tree)];
    for (std::int32_t leaf : tree.unbounded) add(leaf);
    tree.hierarchy.for_each_along(origin_, ray_.direction, infinity, add);
    line.tree->finish();
    return *line.tree;
}

double LineThroughSolid::enter_leaf(std::int32_t index, double t) {
    for (const Span& span : spans(index))
        if (t < span.out) return std::max(t, span.in);
    return infinity;
}

double LineThroughSolid::leave_leaf(std::int32_t index, double t) {
    for (const Span& span : spans(index))
        if (span.in <= t && t < span.out) t = span.out;
    return t;
}

bool LineThroughSolid::inside_leaf(std::int32_t index, double t, Side side) {
    const auto holds = [&](const Span& span) {
        return side == Side::after ? span.in <= t && t < span.out : span.in < t && t <= span.out;
    };
    const std::span<const Span> all = spans(index);
    return std::any_of(all.begin(), all.end(), holds);
}

double LineThroughSolid::enter(std::int32_t tree, double t) {
    if (tree < 0) return enter_leaf(~tree, t);
    const Node& node = world_.nodes[tree];
    switch (node.operation) {
        case Operation::leaf:
            break;
        case Operation::union_:
        case Operation::merge: {
            if (node.united >= 0) return enter_united(node, t);
            double first = infinity;
            for (std::int32_t operand : operands(node)) {
                if (box_is_missed(world_.box_of(operand), t)) continue;
                first = std::min(first, enter(operand, t));
                if (first == t) break;
            }
            return first;
        }
        case Operation::intersection:
            for (bool agreed = false; !agreed;) {
                agreed = true;
                for (std::int32_t operand : operands(node)) {
                    const double next = enter(operand, t);
                    if (next == infinity) return infinity;
                    if (next != t) agreed = false;
                    t = next;
                }
            }
            return t;
        case Operation::subtraction: {
            const auto all = operands(node);
            for (;;) {
                t = enter(all[0], t);
                if (t == infinity) return infinity;
                double beyond = t;
                if (node.united >= 0)
                    beyond = leave_united(node, beyond);
                else
                    for (std::int32_t subtrahend : all.subspan(1)) beyond = leave(subtrahend, beyond);
                if (beyond == t || beyond == infinity) return beyond;
                t = beyond;
            }
        }
        case Operation::symdiff:
            while (t < infinity && !inside(tree, t, Side::after)) t = first_change(operands(node), t);
            return t;
    }
    return infinity;
}

double LineThroughSolid::leave(std::int32_t tree, double t) {
    if (t == infinity || !box_holds(world_.box_of(tree), t)) return t;
    if (tree < 0) return leave_leaf(~tree, t);
    const Node& node = world_.nodes[tree];
    switch (node.operation) {
        case Operation::leaf:
            break;
        case Operation::union_:
        case Operation::merge:
            if (node.united >= 0) return leave_united(node, t);
            for (bool unchanged = false; !unchanged;) {
                unchanged = true;
                for (std::int32_t operand : operands(node)) {
                    const double next = leave(operand, t);
                    if (next != t) unchanged = false;
                    t = next;
                }
            }
            return t;
        case Operation::intersection: {
            double first = infinity;
            for (std::int32_t operand : operands(node)) {
                first = std::min(first, leave(operand, t));
                if (first == t) break;
            }
            return first;
        }
        case Operation::subtraction: {
            const auto all = operands(node);
            double first = leave(all[0], t);
            if (node.united >= 0) return first == t ? t : std::min(first, enter_united(node, t));
            for (std::int32_t subtrahend : all.subspan(1)) {
                if (first == t) break;
                if (!box_is_missed(world_.box_of(subtrahend), t)) first = std::min(first, enter(subtrahend, t));
            }
            return first;
        }
        case Operation::symdiff:
            while (t < infinity && inside(tree, t, Side::after)) t = first_change(operands(node), t);
            return t;
    }
    return t;
}

double LineThroughSolid::enter_united(const Node& node, double t) {
    const UnitedOperands& united = world_.united_operands[node.united];
    const std::span<const std::int32_t> all = operands(node);
    double first = infinity;
    const auto visit = [&](std::int32_t i) { first = std::min(first, enter(all[i], t)); };
    for (std::int32_t i : united.unbounded) visit(i);
    const SlabLine line = slabs_.relative_to(united.hierarchy.anchor());
    united.hierarchy.walk([&](const auto& low, const auto& high, double& near) { return line.meets(low, high, t, first, near); },
                          [&] { return first > t ? first : -infinity; }, visit);
    return first;
}

// Operands are left in the order in which they are met, as long as one begins before the last one ends: a row of many is left in
// one walk, and a second one finds nothing more.
double LineThroughSolid::leave_united(const Node& node, double t) {
    const UnitedOperands& united = world_.united_operands[node.united];
    const std::span<const std::int32_t> all = operands(node);
    const SlabLine line = slabs_.relative_to(united.hierarchy.anchor());
    const auto visit = [&](std::int32_t i) { t = leave(all[i], t); };
    for (double from = -infinity; from != t && t < infinity;) {
        from = t;
        for (std::int32_t i : united.unbounded) visit(i);
        united.hierarchy.walk(
            [&](const auto& low, const auto& high, double& near) { return line.meets(low, high, from, infinity, near); },
            [&] { return t + slack(t); }, visit);
    }
    return t;
}

bool LineThroughSolid::inside_united(const Node& node, double t, Side side) {
    const UnitedOperands& united = world_.united_operands[node.united];
    const std::span<const std::int32_t> all = operands(node);
    bool held = false;
    const auto visit = [&](std::int32_t i) { held = held || inside(all[i], t, side); };
    for (std::int32_t i : united.unbounded) visit(i);
    united.hierarchy.for_each_at(origin_ + t * ray_.direction, slack(t), visit);
    return held;
}

std::span<const std::int32_t> LineThroughSolid::operands_at(const Node& node, double t, std::vector<std::int32_t>& memory) const {
    const std::span<const std::int32_t> all = operands(node);
    if (node.united < 0) return all;
    const UnitedOperands& united = world_.united_operands[node.united];
    if (node.operation == Operation::subtraction) memory.push_back(0);
    memory.insert(memory.end(), united.unbounded.begin(), united.unbounded.end());
    united.hierarchy.for_each_at(origin_ + t * ray_.direction, slack(t), [&](std::int32_t i) { memory.push_back(i); });
    std::sort(memory.begin(), memory.end());
    for (std::int32_t& operand : memory) operand = all[operand];
    return memory;
}

double LineThroughSolid::first_change(std::span<const std::int32_t> operands, double t) {
    double next = infinity;
    for (std::int32_t operand : operands)
        next = std::min(next, inside(operand, t, Side::after) ? leave(operand, t) : enter(operand, t));
    return next;
}

bool LineThroughSolid::inside(std::int32_t tree, double t, Side side) {
    if (!box_holds(world_.box_of(tree), t)) return false;
    if (tree < 0) return inside_leaf(~tree, t, side);
    const Node& node = world_.nodes[tree];
    if (node.united < 0) return is_held(world_, node, [&](std::int32_t operand) { return inside(operand, t, side); });
    if (node.operation != Operation::subtraction) return inside_united(node, t, side);
    return inside(operands(node)[0], t, side) && !inside_united(node, t, side);
}

Label LineThroughSolid::label(std::int32_t tree, double t, Side side) {
    if (!inside(tree, t, side)) return {};
    if (tree < 0) return label_of_leaf(world_, ~tree);
    const Node& node = world_.nodes[tree];
    std::vector<std::int32_t> memory;
    return label_inside(node, operands_at(node, t, memory), [&](std::int32_t operand) { return label(operand, t, side); });
}

double LineThroughSolid::next_change(double t) {
    if (solid_->deep_tree >= 0 && solid_->has_interfaces) return deep_tree().next_change(t);
    if (!solid_->has_interfaces) return inside(t, Side::after) ? leave(t) : enter(t);
    for (;;) {
        // The next end of any leaf's span, and whether it makes a difference.
        double next = infinity;
        for (std::int32_t i = 0; i < solid_->leaf_count; ++i)
            for (const Span& span : spans(solid_->first_leaf + i)) {
                if (span.in > t) next = std::min(next, span.in);
                if (span.out > t) next = std::min(next, span.out);
            }
        if (next == infinity || !(label(next, Side::before) == label(next, Side::after))) return next;
        t = next;
    }
}

std::int32_t LineThroughSolid::leaf_at(std::int32_t tree, double t) {
    const auto change_of = [&](std::int32_t operand) {
        return Change{inside(operand, t, Side::before), inside(operand, t, Side::after)};
    };
    const auto label_changes = [&](std::int32_t operand) {
        return !(label(operand, t, Side::before) == label(operand, t, Side::after));
    };
    const Change change = change_of(tree);
    if (tree < 0) return change.before != change.after ? ~tree : -1;
    const Node& node = world_.nodes[tree];
    std::vector<std::int32_t> memory;
    const auto operand = changing_operand(node, operands_at(node, t, memory), change, change_of, label_changes);
    return operand ? leaf_at(*operand, t) : -1;
}

FaceHit LineThroughSolid::face_at(std::int32_t index, double t) {
    const Leaf& leaf = world_.leaves[index];
    FaceHit hit;
    hit.leaf = index;

    // The frame in which the position was computed: the leaf's own, or that of the representative of its face's class.
    std::int32_t frame = index;
    bool has_equation = !world_.faces_of(leaf).empty();
    for (std::int32_t i = 0; i < leaf.surface_count && hit.surface_class < 0; ++i) {
        const SurfaceUse& use = world_.surface_uses[leaf.first_surface + i];
        std::array<Span, most_surface_spans> of_surface;
        const int count = surface_spans(use, of_surface.data());
        if (std::any_of(of_surface.begin(), of_surface.begin() + count, [t](const Span& s) { return s.in == t || s.out == t; })) {
            hit.face = i;
            hit.surface_class = use.surface_class;
            hit.class_flipped = use.flipped;
            frame = world_.surface_classes[use.surface_class].leaf;
            has_equation = !world_.surface_classes[use.surface_class].whole;
        }
    }

    const Transform& placement = world_.leaves[frame].placement;
    const PlacedLine& placed = placed_line(frame);
    if (has_equation && is_near_root(t, placed.anchor)) {
        hit.point = point_along(ray_.origin, t, ray_.direction);
        hit.local = leaf.placement.to_local(hit.point);
    } else {
        // The end of a span before the anchor was added keeps the digits that t has lost at a distance.
        double local_t = t - placed.anchor;
        if (hit.surface_class < 0) {
            const int count = leaf.object->spans(placed.line, scratch_.data());
            for (int i = 0; i < count; ++i)
                for (double end : {scratch_[i].in, scratch_[i].out})
                    if (placed.anchor + end == t) local_t = end;
        }
        const Point in_frame = placed.line.at(local_t);
        hit.point = placement.to_parent_two_part(in_frame);
        hit.local = frame == index ? in_frame : leaf.placement.to_local(hit.point);
    }
    if (hit.surface_class < 0) hit.face = leaf.object->face(hit.local);
    hit.normal = normalize(leaf.placement.to_parent(leaf.object->normal({hit.local, hit.face})));
    return hit;
}

double LineThroughSolid::cross_sheet(std::int32_t index) {
    const Leaf& leaf = world_.leaves[index];
    if (leaf.first_surface >= 0) {
        // The plane that it shares: inside of it on one side of t.
        std::array<Span, most_surface_spans> side;
        if (surface_spans(world_.surface_uses[leaf.first_surface], side.data()) == 0) return infinity;
        return side[0].in > -infinity ? side[0].in : side[0].out;
    }
    if (ray_.departure.leaf == index) return infinity;
    const PlacedLine& placed = placed_line(index);
    if (leaf.object->spans(placed.line, scratch_.data()) == 0) return infinity;
    const double t = placed.anchor + scratch_[0].in;
    if (!is_near_root(t, placed.anchor)) return t;
    return near_root(ray_, leaf.placement, world_.faces_of(leaf), t, placed.anchor, Passing::either);
}

}  // namespace lapidary
