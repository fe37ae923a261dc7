// SPDX-License-Identifier: MIT
#include "kernel/csg/packet_through_solid.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <span>

#include "kernel/csg/departure.h"
#include "kernel/csg/near_root.h"
#include "kernel/math/roots.h"
#include "kernel/prepare/ask_for.h"

namespace lapidary {

namespace {

double lesser(double a, double b) { return a < b ? a : b; }
double greater(double a, double b) { return a > b ? a : b; }

// Intersects what is left of each lane, from t to first_out, with a leaf's span. Returns how many lanes are left. A leaf that is
// alone is met even where t, at a distance, no longer tells its ends apart.
[[gnu::noinline]] std::int64_t narrow(const Lanes& __restrict in, const Lanes& __restrict out, std::int64_t index, bool alone,
                                      const Lanes& __restrict limit, Lanes& __restrict t, Lanes& __restrict first_out,
                                      PacketThroughSolid::LeafLanes& __restrict leaf) {
    std::int64_t left = 0;
    for (int i = 0; i < PacketThroughSolid::width; ++i) {
        leaf[i] = in[i] > t[i] ? index : leaf[i];
        t[i] = greater(in[i], t[i]);
        first_out[i] = lesser(out[i], first_out[i]);
        const double begin = alone ? 0 : t[i];
        const bool remains = begin < first_out[i] && t[i] <= limit[i];
        t[i] = remains ? t[i] : infinity;
        left += remains;
    }
    return left;
}

// Intersects spans with others; returns how many are not empty.
[[gnu::noinline]] std::int64_t intersect_spans(const Lanes& __restrict other_in, const Lanes& __restrict other_out,
                                               Lanes& __restrict in, Lanes& __restrict out) {
    std::int64_t left = 0;
    for (int i = 0; i < PacketThroughSolid::width; ++i) {
        in[i] = greater(other_in[i], in[i]);
        out[i] = lesser(other_out[i], out[i]);
        left += in[i] < out[i];
    }
    return left;
}

// Empty spans end before they begin.
[[gnu::noinline]] void mark_empty(Lanes& __restrict in, Lanes& __restrict out) {
    for (int i = 0; i < PacketThroughSolid::width; ++i) {
        const double begin = in[i], end = out[i];
        in[i] = begin < end ? begin : infinity;
        out[i] = begin < end ? end : -infinity;
    }
}

// The surfaces that ends of spans are on: of the later of two entries, and of the earlier of two exits; -1 for both at once.
[[gnu::noinline]] void name_later(const Lanes& __restrict in, const Lanes& __restrict other, std::int64_t surface,
                                  PacketThroughSolid::LeafLanes& __restrict name) {
    for (int i = 0; i < PacketThroughSolid::width; ++i) {
        const double begin = in[i], other_begin = other[i];
        const std::int64_t named = name[i], kept = other_begin == begin ? -1 : named;
        name[i] = other_begin > begin ? surface : kept;
    }
}
[[gnu::noinline]] void name_earlier(const Lanes& __restrict out, const Lanes& __restrict other, std::int64_t surface,
                                    PacketThroughSolid::LeafLanes& __restrict name) {
    for (int i = 0; i < PacketThroughSolid::width; ++i) {
        const double end = out[i], other_end = other[i];
        const std::int64_t named = name[i], kept = other_end == end ? -1 : named;
        name[i] = other_end < end ? surface : kept;
    }
}

// The surface that lines meet at t, where none is named before.
[[gnu::noinline]] void name_met(const Lanes& __restrict in, const Lanes& __restrict out, std::int64_t surface,
                                const Lanes& __restrict t, PacketThroughSolid::LeafLanes& __restrict name) {
    for (int i = 0; i < PacketThroughSolid::width; ++i) {
        const std::int64_t named = name[i], if_met = named < 0 ? surface : named;
        const std::int64_t at_exit = out[i] == t[i] ? if_met : named;
        name[i] = in[i] == t[i] ? if_met : at_exit;
    }
}

// Lanes that a negative leaf holds again a sliver's length beyond t are doubtful; where another one ends at t, too, whose face it
// is is not known.
[[gnu::noinline]] void mark_doubtful(const Lanes& __restrict in, const Lanes& __restrict out, std::int64_t index,
                                     const Lanes& __restrict t, const Lanes& __restrict further, Lanes& __restrict doubtful,
                                     PacketThroughSolid::LeafLanes& __restrict leaf) {
    for (int i = 0; i < PacketThroughSolid::width; ++i) {
        const double begin = in[i], end = out[i], at = t[i], beyond = further[i];
        const std::int64_t shown = leaf[i];
        const double if_begun = beyond < end ? 1 : doubtful[i];
        doubtful[i] = begin <= beyond ? if_begun : doubtful[i];
        const std::int64_t if_ends = shown == index ? shown : -1;
        leaf[i] = end == at ? if_ends : shown;
    }
}

// Moves the lanes that a negative leaf holds to its exit; returns how many there were.
[[gnu::noinline]] std::int64_t leave_span(const Lanes& __restrict in, const Lanes& __restrict out, std::int64_t index,
                                          Lanes& __restrict t, Lanes& __restrict moved,
                                          PacketThroughSolid::LeafLanes& __restrict leaf) {
    std::int64_t left = 0;
    for (int i = 0; i < PacketThroughSolid::width; ++i) {
        const double begin = in[i], end = out[i], at = t[i];
        const bool holds = both(begin <= at, at < end);
        t[i] = holds ? end : at;
        leaf[i] = holds ? index : leaf[i];
        moved[i] = holds ? 1 : moved[i];
        left += holds;
    }
    return left;
}

// Lanes that were moved are lost where they went beyond their end; returns how many are left of them.
[[gnu::noinline]] std::int64_t end_lanes(const Lanes& __restrict moved, const Lanes& __restrict first_out,
                                         const Lanes& __restrict limit, Lanes& __restrict t) {
    std::int64_t left = 0;
    for (int i = 0; i < PacketThroughSolid::width; ++i) {
        const double at = t[i], end = first_out[i], most = limit[i], was_moved = moved[i];
        const double before_end = at < end ? at : infinity;
        const double remaining = at <= most ? before_end : infinity;
        t[i] = was_moved > 0 ? remaining : at;
        left += both(was_moved > 0, remaining < infinity);
    }
    return left;
}

bool is_near_end_of(double in, double out, double anchor) { return is_near_root(lesser(std::fabs(in), std::fabs(out)), anchor); }

// Spans along the local lines as spans of the world's t; empty ones end before they begin. The lanes with near ends: bit i for
// lane i.
[[gnu::noinline]] unsigned count_from_origins(const SpanBatch& __restrict spans, const Lanes& __restrict anchor,
                                              Lanes& __restrict in, Lanes& __restrict out) {
    std::int64_t near = 0;
    for (int i = 0; i < PacketThroughSolid::width; ++i) {
        const double first = spans.in[i], last = spans.out[i], origin = anchor[i];
        const double begin = first < last ? origin + first : infinity, end = first < last ? origin + last : -infinity;
        in[i] = begin, out[i] = end;
        near |= is_near_end_of(begin, end, origin) ? bit_of(i) : 0;
    }
    return static_cast<unsigned>(near);
}

// Where lines run below a plane; those that lie in it do if they are shifted there (rule P). The lanes with near ends:
// bit i for lane i.
[[gnu::noinline]] unsigned find_plane_ends(const PlacedLines& __restrict placed, const Surface& __restrict plane,
                                           double shifted_by, Lanes& __restrict in, Lanes& __restrict out) {
    const LineBatch& lines = placed.lines;
    const double a = plane.a, b = plane.b, c = plane.c, d = plane.d;
    std::int64_t near = 0;
    for (int i = 0; i < PacketThroughSolid::width; ++i) {
        const double slope = a * lines.direction_x[i] + b * lines.direction_y[i] + c * lines.direction_z[i];
        const double distance = lines.closest_x[i] * a + lines.closest_y[i] * b + lines.closest_z[i] * c - d;
        const double anchor = placed.anchor[i], t = anchor - distance / slope;
        const double side = distance != 0 ? distance : shifted_by;
        const double parallel_in = side < 0 ? -infinity : infinity;
        const double crossing_in = slope > 0 ? -infinity : t, crossing_out = slope > 0 ? t : infinity;
        const bool parallel = either(slope == 0, !(std::fabs(t) < infinity));
        in[i] = parallel ? parallel_in : crossing_in;
        out[i] = parallel ? -parallel_in : crossing_out;
        near |= both(!parallel, is_near_root(t, anchor)) ? bit_of(i) : 0;
    }
    return static_cast<unsigned>(near);
}

// Half-lines become those on the other side of a plane, with the same t; everything becomes nothing.
[[gnu::noinline]] void turn_over(Lanes& __restrict in, Lanes& __restrict out) {
    for (int i = 0; i < PacketThroughSolid::width; ++i) {
        const double old_in = in[i], old_out = out[i], end = old_out < infinity ? infinity : -infinity;
        in[i] = old_in > -infinity ? -infinity : old_out;
        out[i] = old_in > -infinity ? old_in : end;
    }
}

// How many rays end before a ball, begin behind it or pass it by for certain: the rounding of all that is computed here, of
// places of the size of the origins', is allowed for many times over.
template <class Origins>
[[gnu::noinline]] std::int64_t count_beside_ball(const Origins& __restrict origins, const VectorLanes& __restrict direction,
                                                 const Lanes& __restrict limit, const Point& centre, double radius) {
    constexpr double rounding = 0x1p-40;
    const double size = largest_magnitude(centre);
    std::int64_t beside = 0;
    for (int i = 0; i < PacketThroughSolid::width; ++i) {
        const double x = centre.x - origins.x[i], y = centre.y - origins.y[i], z = centre.z - origins.z[i];
        const double along = x * direction.x[i] + y * direction.y[i] + z * direction.z[i], squared = x * x + y * y + z * z;
        const double reach = radius + rounding * (size + origins.size[i] + std::fabs(along));
        const bool passes_by = squared - along * along > reach * reach + rounding * squared;
        const bool begins_behind = along + reach < 0, ends_before = limit[i] < along - reach;
        beside += either(passes_by, either(begins_behind, ends_before));
    }
    return beside;
}

// Rays that come from outside of a ball and run through it for certain, before their limits, get a place in it; those that end
// before it, begin behind it or pass it by for certain get none. Returns how many are neither: those that graze it, or begin or
// end close to it or within. A leaf that is round up to rounding lies between the ball and the one of its inner radius.
template <class Origins>
[[gnu::noinline]] std::int64_t pass_through_ball(const Origins& __restrict origins, const VectorLanes& __restrict direction,
                                                 const Lanes& __restrict limit, const Point& centre, double radius,
                                                 double inner_radius, Lanes& __restrict t) {
    constexpr double rounding = 0x1p-40, least = 1e-140;  // a radius whose square has all of its digits
    const double size = largest_magnitude(centre);
    std::int64_t clear = 0;
    for (int i = 0; i < PacketThroughSolid::width; ++i) {
        const double x = centre.x - origins.x[i], y = centre.y - origins.y[i], z = centre.z - origins.z[i];
        const double along = x * direction.x[i] + y * direction.y[i] + z * direction.z[i], squared = x * x + y * y + z * z;
        const double slack = rounding * (size + origins.size[i] + std::fabs(along)), end = limit[i];
        const double reach = radius + slack, inner = inner_radius - slack, most = inner > least ? inner * inner : 0;
        const double beside = squared - along * along, rounded = rounding * squared;
        const bool misses = either(beside > reach * reach + rounded, either(along + reach < 0, end < along - reach));
        const bool passes = both(beside + rounded < most, both(along > reach, along + slack < end));
        const bool is_missed = either(misses, end < 0);
        t[i] = is_missed ? infinity : along;
        clear += either(is_missed, passes);
    }
    return PacketThroughSolid::width - clear;
}

// In how many lanes all from t to `end` lies in a ball for certain, rounding allowed for likewise: both ends do, as balls are
// convex, or nothing is left. From the centre the ray starts at o, and at t is away by the root of |o|^2 + t (2 o.d + t).
template <class Origins>
[[gnu::noinline]] std::int64_t count_within_ball(const Origins& __restrict origins, const VectorLanes& __restrict direction,
                                                 const Lanes& __restrict t, const Lanes& __restrict end, const Point& centre,
                                                 double radius) {
    constexpr double rounding = 0x1p-40, least = 1e-140;  // a radius whose square has all of its digits
    const double size = largest_magnitude(centre);
    std::int64_t within = 0;
    for (int i = 0; i < PacketThroughSolid::width; ++i) {
        const double x = origins.x[i] - centre.x, y = origins.y[i] - centre.y, z = origins.z[i] - centre.z;
        const double twice = 2 * (x * direction.x[i] + y * direction.y[i] + z * direction.z[i]), first = t[i], last = end[i];
        const double squared = (1 + rounding) * (x * x + y * y + z * z);
        const double reach = radius - rounding * (size + origins.size[i]), most = reach > least ? reach * reach : 0;
        const bool begins_within = squared + first * (twice + (1 + rounding) * first) < most;
        const bool ends_within = squared + last * (twice + (1 + rounding) * last) < most;
        within += either(!(first < infinity), both(begins_within, ends_within));
    }
    return within;
}

// From the least to the greatest.
PacketThroughSolid::NumberRange range_of(const std::array<std::int32_t, PacketThroughSolid::width>& numbers) {
    PacketThroughSolid::NumberRange range{numbers[0], numbers[0]};
    for (const std::int32_t number : numbers) {
        range.first = number < range.first ? number : range.first;
        range.last = number > range.last ? number : range.last;
    }
    return range;
}

}  // namespace

PacketThroughSolid::PacketThroughSolid(const World& world, TraceStatistics& statistics)
    : world_(world),
      statistics_(statistics),
      line_(world, statistics),
      asked_stamp_(static_cast<std::size_t>(world.most_leaves)),
      asked_slot_(static_cast<std::size_t>(world.most_leaves)),
      asked_(static_cast<std::size_t>(world.most_leaves)),
      leaf_spans_(world.features.transparency ? static_cast<std::size_t>(world.most_leaves) : 0) {}

void PacketThroughSolid::start(const RayPacket& rays) {
    rays_ = &rays;
    placed_leaf_ = -1, local_leaf_ = -1;
    find_origins(rays, origins_);
    departed_leaves_ = departed_classes_ = {};
    depart_alike_ = false;
    if (!rays.departs) return;
    departed_leaves_ = range_of(rays.departure.leaf);
    departed_classes_ = range_of(rays.departure.surface_class);
    depart_alike_ = departed_leaves_.is_one() && departed_classes_.is_one() && range_of(rays.departure.inward).is_one();
}

void PacketThroughSolid::find_origins(const RayPacket& __restrict rays, Origins& __restrict origins) {
    for (int i = 0; i < width; ++i) {
        const double x = rays.anchor.x[i] + rays.offset.x[i];
        const double y = rays.anchor.y[i] + rays.offset.y[i];
        const double z = rays.anchor.z[i] + rays.offset.z[i];
        origins.x[i] = x, origins.y[i] = y, origins.z[i] = z;
        origins.size[i] = greater(greater(std::fabs(x), std::fabs(y)), std::fabs(z));
    }
}

void PacketThroughSolid::enter(const Solid& solid, const Lanes& limit, Lanes& t, LeafLanes& leaf, bool only_compared) {
    if (solid.is_product) {
        enter_product(solid, limit, t, leaf, only_compared);
        return;
    }
    for (int i = 0; i < width; ++i) {
        leaf[i] = -1;
        t[i] = infinity;
        if (!(limit[i] >= 0)) continue;
        line_.start(rays_->ray(i));
        line_.select(solid);
        t[i] = line_.enter(0);
    }
}

double PacketThroughSolid::leave(const Solid& solid, int lane) {
    line_.start(rays_->ray(lane));
    line_.select(solid);
    return line_.leave(0);
}

void PacketThroughSolid::cross_sheet(std::int32_t leaf, Lanes& t) {
    placed_lines(leaf);
    SpanBatch crossings;
    world_.leaves[leaf].object->spans_batch(placed_.lines, width, &crossings);
    for (int i = 0; i < width; ++i) {
        t[i] = rays_->departure[i].leaf == leaf ? infinity : placed_.anchor[i] + crossings.in[i];
        if (is_near_root(t[i], placed_.anchor[i]))
            t[i] = near_root(rays_->ray(i), world_.leaves[leaf].placement, world_.faces_of(world_.leaves[leaf]), t[i],
                             placed_.anchor[i], Passing::either);
    }
}

// Whether every ray departs outward from a leaf that the solid lies inside of: as leaves of a product are met in one piece, it
// does not come back. So most shadow rays are done with the solid that they start on.
bool PacketThroughSolid::all_leave(const Solid& solid, const Lanes& limit) const {
    if (departed_leaves_.last < solid.first_leaf || departed_leaves_.first >= solid.first_leaf + solid.leaf_count) return false;
    if (depart_alike_) return leaves_for_good(rays_->departure[0], solid);
    for (int i = 0; i < width; ++i)
        if (limit[i] >= 0 && !leaves_for_good(rays_->departure[i], solid)) return false;
    return true;
}

bool PacketThroughSolid::leaves_for_good(const Departure& departure, const Solid& solid) const {
    if (!solid.is_product) return false;
    if (departure.leaf < solid.first_leaf || departure.leaf >= solid.first_leaf + solid.positive_count) return false;
    const Leaf& leaf = world_.leaves[departure.leaf];
    if (leaf.first_surface < 0) return !departure.inward;
    for (std::int32_t s = 0; s < leaf.surface_count; ++s) {
        const SurfaceUse& use = world_.surface_uses[leaf.first_surface + s];
        if (use.surface_class == departure.surface_class) return departure.inward == use.flipped && is_convex(use);
    }
    return false;
}

// Whether the side of a surface that a leaf lies on is convex.
bool PacketThroughSolid::is_convex(const SurfaceUse& use) const {
    const SurfaceClass& surface_class = world_.surface_classes[use.surface_class];
    if (surface_class.whole) return false;
    const Surface::Kind kind = surface_class.surface.kind;
    return kind == Surface::Kind::plane || (!use.flipped && (kind == Surface::Kind::sphere || kind == Surface::Kind::cylinder));
}

// Whether no ray meets the ball that the solid lies in, if there is one. That takes a fraction of the work of asking a leaf.
bool PacketThroughSolid::all_pass_beside(const Solid& solid, const Lanes& limit) const {
    if (solid.ball < 0) return false;
    const Leaf& ball = world_.leaves[solid.first_leaf + solid.ball];
    return count_beside_ball(origins_, rays_->direction, limit, ball.anchor(), ball.radius()) == width;
}

// Of shadow rays, which only ask whether they enter a solid before their limits: the same for one that is a ball, where no ray
// departs from it and none grazes it. That takes a fraction of the work of finding out where.
bool PacketThroughSolid::all_pass_through_ball(const Solid& solid, const Lanes& limit, Lanes& t) const {
    if (solid.ball != 0 || solid.leaf_count != 1 || may_depart_from(solid.first_leaf)) return false;
    const Leaf& ball = world_.leaves[solid.first_leaf];
    const double inner_radius = world_.inner_radius(ball);
    return pass_through_ball(origins_, rays_->direction, limit, ball.anchor(), ball.radius(), inner_radius, t) == 0;
}

bool PacketThroughSolid::may_depart_from(std::int32_t index) const {
    const Leaf& leaf = world_.leaves[index];
    bool departs = departed_leaves_.has(index);
    for (std::int32_t s = 0; leaf.first_surface >= 0 && s < leaf.surface_count; ++s)
        departs |= departed_classes_.has(world_.surface_uses[leaf.first_surface + s].surface_class);
    return departs;
}

// Whether what is left of every lane, from t to `end`, lies in a round leaf.
bool PacketThroughSolid::are_within(std::int32_t index, const Lanes& t, const Lanes& end) const {
    const Leaf& ball = world_.leaves[index];
    return count_within_ball(origins_, rays_->direction, t, end, ball.anchor(), world_.inner_radius(ball)) == width;
}

void PacketThroughSolid::enter_product(const Solid& solid, const Lanes& limit, Lanes& t, LeafLanes& leaf, bool only_compared) {
    if (only_compared && all_pass_through_ball(solid, limit, t)) {
        leaf.fill(-1);
        return;
    }
    if (all_leave(solid, limit) || all_pass_beside(solid, limit)) {
        t.v.fill(infinity), leaf.fill(-1);
        return;
    }
    // By the time that the first negative leaf is looked at, it is there.
    if (solid.leaf_count > solid.positive_count) ask_for(&world_.leaves[solid.first_leaf + solid.positive_count]);
    Lanes first_out;
    if (!enter_positive_leaves(solid, limit, only_compared, t, first_out, leaf) || solid.leaf_count == 1) return;

    asked_count_ = 0;
    if (solid.leaf_count > solid.positive_count) leave_negative_leaves(solid, limit, first_out, t, leaf);
    reconsider_doubtful(solid, first_out, t, leaf);
}

// Into all of the positive leaves: the last entry, while none has ended; whether anything is left. Ends count where something is
// left of the leaves before, and those of a leaf that is alone are compared with nothing else. A ball that holds all that is left
// narrows nothing; a hole that does leaves nothing.
bool PacketThroughSolid::enter_positive_leaves(const Solid& solid, const Lanes& limit, bool only_compared, Lanes& t,
                                               Lanes& first_out, LeafLanes& leaf) {
    const Asked asked{&t, &first_out, only_compared && solid.leaf_count == 1 ? &limit : nullptr};
    for (int i = 0; i < width; ++i) t[i] = 0, first_out[i] = infinity, leaf[i] = -1;
    for (std::int32_t p = 0; p < solid.positive_count; ++p) {
        if (p > 0 && p == solid.ball && are_within(solid.first_leaf + p, t, first_out)) continue;
        Lanes in, out;
        spans(solid.first_leaf + p, in, out, nullptr, asked);
        if (narrow(in, out, solid.first_leaf + p, solid.positive_count == 1, limit, t, first_out, leaf) == 0) return false;
        if (p > 0 || solid.hole < 0 || !are_within(solid.first_leaf + solid.hole, t, first_out)) continue;
        t.v.fill(infinity);
        return false;
    }
    return true;
}

// Out of the negative leaves, until none holds any lane.
void PacketThroughSolid::leave_negative_leaves(const Solid& solid, const Lanes& limit, const Lanes& first_out, Lanes& t,
                                               LeafLanes& leaf) {
    ++stamp_;
    const bool is_alone = solid.leaf_count == solid.positive_count + 1;
    Lanes unsettled;
    unsettled.v.fill(1);
    std::int32_t left_last = none_left;
    do {
        find_positions(origins_, rays_->direction, solid.rounding, t, unsettled, positions_);
        unsettled.v.fill(0);
        left_last = leave_negative_leaves_once(solid, left_last, t, unsettled, leaf);
    } while (left_last != none_left && end_lanes(unsettled, first_out, limit, t) > 0 && !is_alone);
}

// Each of those once that hold lanes at positions_; returns which one was left last, if any. That of the time before holds no
// lane now: it let go of all that it held, no other moved any since, and leaves are met in one piece.
std::int32_t PacketThroughSolid::leave_negative_leaves_once(const Solid& solid, std::int32_t left_before, Lanes& t, Lanes& moved,
                                                            LeafLanes& leaf) {
    const std::int32_t first_negative = solid.first_leaf + solid.positive_count;
    const std::int32_t negative_count = solid.leaf_count - solid.positive_count;
    std::int32_t left_last = none_left;
    const auto visit = [&](std::int32_t n) {
        if (n != left_before && leave_negative_leaf(n, first_negative + n, t, moved, leaf)) left_last = n;
    };
    if (negative_count == 1) {
        visit(0);
    } else if (solid.first_negative_block >= 0) {
        for_each_overlapping(world_.negative_blocks, solid.first_negative_block, surroundings_of(positions_),
                             anchor_of_blocks(world_.box_of(solid.root)), visit);
    } else {
        const Bounds around = surroundings_of(positions_);
        for (std::int32_t n = 0; n < negative_count; ++n)
            if (around.overlaps(world_.leaves[first_negative + n].bounds())) visit(n);
    }
    return left_last;
}

// Moves lanes that a negative leaf holds to its exit; whether there were any.
bool PacketThroughSolid::leave_negative_leaf(std::int32_t n, std::int32_t index, Lanes& t, Lanes& moved, LeafLanes& leaf) {
    if (!any_may_be_in(world_.leaves[index])) return false;
    if (asked_stamp_[n] != stamp_) {
        asked_stamp_[n] = stamp_;
        asked_slot_[n] = static_cast<std::int32_t>(asked_count_++);
        NegativeLeaf& asked = asked_[asked_slot_[n]];
        asked.leaf = index;
        spans(index, asked.in, asked.out, nullptr, {&t, nullptr, nullptr});
    }
    const NegativeLeaf& asked = asked_[asked_slot_[n]];
    return leave_span(asked.in, asked.out, index, t, moved, leaf) > 0;
}

// Where the same place is an entry of a positive leaf and an exit of negative ones, the positive one is shown; of several
// negative ones the first. Slivers, and what rounding makes doubtful, are left to the single ray. All negative leaves whose
// boxes are within a sliver's length were asked.
void PacketThroughSolid::reconsider_doubtful(const Solid& solid, const Lanes& first_out, Lanes& t, LeafLanes& leaf) {
    Lanes further, doubtful;
    for (int i = 0; i < width; ++i) {
        further[i] = t[i] + sliver_length(solid.rounding, t[i]);
        doubtful[i] = further[i] < first_out[i] ? 0 : 1;
    }
    for (std::size_t slot = 0; slot < asked_count_; ++slot) {
        const NegativeLeaf& asked = asked_[slot];
        mark_doubtful(asked.in, asked.out, asked.leaf, t, further, doubtful, leaf);
    }
    std::int64_t count = 0;
    for (int i = 0; i < width; ++i) count += t[i] < infinity && doubtful[i] != 0;
    if (count == 0) return;
    for (int i = 0; i < width; ++i) {
        if (!(t[i] < infinity) || doubtful[i] == 0) continue;
        line_.start(rays_->ray(i));
        line_.select(solid);
        t[i] = line_.enter(0);
        leaf[i] = -1;
    }
}

// Where the lanes are that are not settled, with what rounding and a sliver's length may add.
void PacketThroughSolid::find_positions(const Origins& __restrict origins, const VectorLanes& __restrict direction,
                                        double rounding, const Lanes& __restrict t, const Lanes& __restrict unsettled,
                                        Positions& __restrict p) {
    for (int i = 0; i < width; ++i) {
        const bool counts = unsettled[i] != 0 && t[i] < infinity;
        const double at = counts ? t[i] : 0;
        const double slack = counts ? 0x1p-50 * (origins.size[i] + at) + sliver_length(rounding, at) : -infinity;
        p.x[i] = origins.x[i] + at * direction.x[i];
        p.y[i] = origins.y[i] + at * direction.y[i];
        p.z[i] = origins.z[i] + at * direction.z[i];
        p.slack[i] = slack;
    }
}

Bounds PacketThroughSolid::surroundings_of(const Positions& p) {
    Lanes low_x, low_y, low_z, high_x, high_y, high_z;
    for (int i = 0; i < width; ++i) {
        const double x = p.x[i], y = p.y[i], z = p.z[i], slack = p.slack[i];
        low_x[i] = x - slack, low_y[i] = y - slack, low_z[i] = z - slack;
        high_x[i] = x + slack, high_y[i] = y + slack, high_z[i] = z + slack;
    }
    return {{least(low_x), least(low_y), least(low_z)}, {largest(high_x), largest(high_y), largest(high_z)}};
}

bool PacketThroughSolid::any_may_be_in(const Leaf& leaf) const {
    return world_.is_round(leaf) ? any_in_ball(leaf.anchor(), leaf.radius()) : any_in_box(leaf.bounds());
}

bool PacketThroughSolid::any_in_ball(const Point& centre, double radius) const {
    const Positions& p = positions_;
    std::int64_t held = 0;
    for (int i = 0; i < width; ++i) {
        const double x = p.x[i] - centre.x, y = p.y[i] - centre.y, z = p.z[i] - centre.z, reach = radius + p.slack[i];
        held += both(reach >= 0, !(x * x + y * y + z * z > reach * reach));
    }
    return held > 0;
}

bool PacketThroughSolid::any_in_box(const Bounds& box) const {
    // Counting instead of stopping keeps the lanes together.
    const Positions& p = positions_;
    std::int64_t held = 0;
    for (int i = 0; i < width; ++i) {
        const double x = p.x[i], y = p.y[i], z = p.z[i], slack = p.slack[i];
        held += (x >= box.low.x - slack) & (x <= box.high.x + slack) & (y >= box.low.y - slack) & (y <= box.high.y + slack) &
                (z >= box.low.z - slack) & (z <= box.high.z + slack);
    }
    return held > 0;
}

const PlacedLines& PacketThroughSolid::placed_lines(std::int32_t index) {
    const Transform& placement = world_.leaves[index].placement;
    if (placed_leaf_ < 0 || !world_.leaves[placed_leaf_].placement.is_same_as(placement)) place_lines(placement, *rays_, placed_);
    placed_leaf_ = index;
    return placed_;
}

const SpanBatch& PacketThroughSolid::local_spans(std::int32_t index) {
    const PlacedLines& placed = placed_lines(index);
    if (local_leaf_ != index) world_.leaves[index].object->spans_batch(placed.lines, width, &local_spans_);
    local_leaf_ = index;
    return local_spans_;
}

// A leaf's one span in every lane; an empty one ends before it begins.
void PacketThroughSolid::spans(std::int32_t index, Lanes& in, Lanes& out, LeafSpans* faces, const Asked& asked) {
    statistics_.object_tests += static_cast<std::uint64_t>(rays_->count);
    const Leaf& leaf = world_.leaves[index];
    if (leaf.first_surface >= 0) {
        shared_spans(leaf, in, out, faces);
        return;
    }
    const unsigned near = own_spans(leaf, in, out);
    const unsigned departing = departed_leaves_.has(index) ? lanes_with(rays_->departure.leaf, index) : 0;
    if (departing != 0) remove_departures(departing, in, out);
    if (near != 0) find_near_ends_of_lanes(near, leaf, world_.faces_of(leaf), departing, asked, in, out);
}

void PacketThroughSolid::find_near_ends_of_lanes(unsigned near, const Leaf& leaf, std::span<const Surface> faces,
                                                 unsigned departing, const Asked& asked, Lanes& in, Lanes& out) const {
    for (unsigned rest = near & rays_->lanes(); rest != 0; rest &= rest - 1) {
        const int i = std::countr_zero(rest);
        if (!(in[i] < out[i])) continue;
        Span span{in[i], out[i]};
        const double anchor = placed_.anchor[i];
        const bool departs = (departing >> i & 1) != 0;
        const auto matters = [&](double end) {
            return is_near_end(end, anchor, departs) && asked.holds(end, most_rounding * std::fabs(anchor), i);
        };
        if (!matters(span.in) && !matters(span.out)) continue;
        find_near_ends(span, rays_->ray(i), leaf.placement, faces, anchor, departs);
        in[i] = span.in, out[i] = span.out;
    }
}

// With placed_ set to the leaf's lines; the lanes with near ends.
unsigned PacketThroughSolid::own_spans(const Leaf& leaf, Lanes& in, Lanes& out) {
    ask_for(leaf.object);
    const SpanBatch& spans = local_spans(static_cast<std::int32_t>(&leaf - world_.leaves.data()));
    return count_from_origins(spans, placed_.anchor, in, out);
}

// What the leaf's surfaces have in common: of each next one, ends count where something is left of the others.
void PacketThroughSolid::shared_spans(const Leaf& leaf, Lanes& in, Lanes& out, LeafSpans* faces) {
    if (leaf.surface_count == 1 && !faces) {
        surface_spans(world_.surface_uses[leaf.first_surface], {}, in, out);
        mark_empty(in, out);
        return;
    }
    for (int i = 0; i < width; ++i) in[i] = -infinity, out[i] = infinity;
    if (faces) faces->in_face.fill(-1), faces->out_face.fill(-1);
    std::int64_t left = 1;
    for (std::int64_t s = 0; s < leaf.surface_count && left > 0; ++s) {
        Lanes surface_in, surface_out;
        surface_spans(world_.surface_uses[leaf.first_surface + s], {&in, &out, nullptr}, surface_in, surface_out);
        if (faces) {
            name_later(in, surface_in, s, faces->in_face);
            name_earlier(out, surface_out, s, faces->out_face);
        }
        left = intersect_spans(surface_in, surface_out, in, out);
    }
    mark_empty(in, out);
}

void PacketThroughSolid::find_shared_faces(const Leaf& leaf, const Lanes& t, LeafLanes& face) {
    if (leaf.surface_count == 1) {
        face.fill(0);
        return;
    }
    face.fill(-1);
    for (std::int32_t s = 0; s < leaf.surface_count; ++s) {
        Lanes in, out;
        surface_spans(world_.surface_uses[leaf.first_surface + s], {&t, &t, nullptr}, in, out);
        name_met(in, out, s, t, face);
    }
}

void PacketThroughSolid::surface_spans(const SurfaceUse& use, const Asked& asked, Lanes& in, Lanes& out) {
    const SurfaceClass& surface_class = world_.surface_classes[use.surface_class];
    const Leaf& frame = world_.leaves[surface_class.leaf];
    if (surface_class.is(Surface::Kind::plane)) {
        plane_spans(use, surface_class, asked, in, out);
        return;
    }
    const bool is_tube = surface_class.is(Surface::Kind::cylinder);
    const unsigned near = is_tube ? tube_spans(frame, surface_class.surface.a, in, out) : own_spans(frame, in, out);
    const unsigned departing = lanes_departing_from(use.surface_class);
    if (departing != 0) remove_departures(departing, in, out);
    if (!surface_class.whole && near != 0)
        find_near_ends_of_lanes(near, frame, {&surface_class.surface, 1}, departing, asked, in, out);
}

unsigned PacketThroughSolid::tube_spans(const Leaf& frame, double radius, Lanes& in, Lanes& out) {
    placed_lines(static_cast<std::int32_t>(&frame - world_.leaves.data()));
    SpanBatch batch;
    for (int i = 0; i < width; ++i) {
        const Span span = tube_span(placed_.lines.line(i), radius);
        batch.in[i] = span.in, batch.out[i] = span.out;
    }
    return count_from_origins(batch, placed_.anchor, in, out);
}

void PacketThroughSolid::plane_spans(const SurfaceUse& use, const SurfaceClass& surface_class, const Asked& asked, Lanes& in,
                                     Lanes& out) {
    placed_lines(surface_class.leaf);
    const unsigned near = find_plane_ends(placed_, surface_class.surface, surface_class.shifted_by, in, out);
    const unsigned departing = lanes_departing_from(use.surface_class);
    for (unsigned rest = departing; rest != 0; rest &= rest - 1) {
        const int i = std::countr_zero(rest);
        const bool inward = rays_->departure[i].inward;
        in[i] = inward ? 0 : -infinity;
        out[i] = inward ? infinity : 0;
    }
    if ((near & ~departing) != 0) {
        const Leaf& frame = world_.leaves[surface_class.leaf];
        find_near_ends_of_lanes(near & ~departing, frame, {&surface_class.surface, 1}, departing, asked, in, out);
    }
    if (use.flipped) turn_over(in, out);
}

unsigned PacketThroughSolid::lanes_departing_from(std::int32_t surface_class) const {
    return departed_classes_.has(surface_class) ? lanes_with(rays_->departure.surface_class, surface_class) : 0;
}

// Of the lanes that depart from what the spans are of.
void PacketThroughSolid::remove_departures(unsigned departing, Lanes& in, Lanes& out) const {
    for (unsigned rest = departing & rays_->lanes(); rest != 0; rest &= rest - 1) {
        const int i = std::countr_zero(rest);
        if (!(in[i] <= out[i])) continue;
        Span span{in[i], out[i]};
        const bool remains = remove_departure_root(&span, 1, rays_->departure[i].inward) > 0;
        in[i] = remains ? span.in : infinity;
        out[i] = remains ? span.out : -infinity;
    }
}

}  // namespace lapidary
