// SPDX-License-Identifier: MIT
#include "kernel/csg/packet_through_world.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include "kernel/math/outward.h"
#include "kernel/prepare/ask_for.h"

namespace lapidary {

// Loops over lanes stand in functions of their own, which are not to be put into others: there g++ may take them apart into
// single numbers before it looks for vectors.
namespace {

constexpr float largest_float = std::numeric_limits<float>::max();

float lesser(float a, float b) { return a < b ? a : b; }
float greater(float a, float b) { return a > b ? a : b; }

// Puts a solid's boundaries where they come first; returns in how many lanes. Of boundaries at the same place, that of the solid
// written first counts.
[[gnu::noinline]] std::int64_t take_closer(const Lanes& __restrict t, const PacketThroughSolid::LeafLanes& __restrict leaf,
                                           std::int32_t solid, BoundaryPacket& __restrict boundaries, Lanes& __restrict limits) {
    std::array<std::int64_t, PacketThroughWorld::width> first_solid;
    Lanes closer;
    for (int i = 0; i < PacketThroughWorld::width; ++i) first_solid[i] = boundaries.solid[i];
    std::int64_t count = 0;
    for (int i = 0; i < PacketThroughWorld::width; ++i) {
        const double first = boundaries.t[i], at = t[i];
        const std::int64_t before = first_solid[static_cast<std::size_t>(i)];
        const bool ties = both(both(at == first, at < infinity), solid < before);
        const bool comes_first = both(at > 0, either(at < first, ties));
        boundaries.t[i] = comes_first ? at : first;
        limits[i] = comes_first ? at : limits[i];
        closer[i] = comes_first ? 1 : 0;
        count += comes_first;
    }
    for (int i = 0; count > 0 && i < PacketThroughWorld::width; ++i) {
        boundaries.solid[i] = closer[i] != 0 ? solid : boundaries.solid[i];
        boundaries.leaf[i] = closer[i] != 0 ? static_cast<std::int32_t>(leaf[i]) : boundaries.leaf[i];
    }
    return count;
}

// Lanes that meet something: bit i for lane i.
struct MetLanes {
    unsigned met, inside;  // of them those that start inside
};

// Those where t is below the limit. They are done.
[[gnu::noinline]] MetLanes end_met_lanes(const Lanes& __restrict t, Lanes& __restrict limits) {
    std::int64_t met = 0, inside = 0;
    for (int i = 0; i < PacketThroughWorld::width; ++i) {
        const double at = t[i], limit = limits[i];
        met |= at < limit ? bit_of(i) : 0;
        inside |= both(at < limit, at == 0) ? bit_of(i) : 0;
        limits[i] = at < limit ? -1 : limit;
    }
    return {static_cast<unsigned>(met), static_cast<unsigned>(inside)};
}

// The same lanes, which go on.
[[gnu::noinline]] unsigned lanes_within(const Lanes& t, const Lanes& limits) {
    std::int64_t bits = 0;
    for (int i = 0; i < PacketThroughWorld::width; ++i) bits |= t[i] < limits[i] ? bit_of(i) : 0;
    return static_cast<unsigned>(bits);
}

}  // namespace

PacketThroughWorld::PacketThroughWorld(const World& world, TraceStatistics& statistics)
    : world_(world),
      statistics_(statistics),
      single_(world, statistics),
      reach_(world.hierarchy.reach()),
      solid_(world, statistics) {}

void PacketThroughWorld::start(const RayPacket& rays) {
    packet_ = &rays;
    is_ready_for_boxes_ = false;
    solid_.start(rays);
    // Lanes without a ray are done from the start.
    for (int i = rays.count; i < width; ++i) limits_[i] = -1;
}

void PacketThroughWorld::get_ready_for_boxes() {
    is_ready_for_boxes_ = true;
    round_rays();
    set_limits();
}

// Rays as floats that lose no box. The origin, relative to the anchor, is rounded up against the low planes of boxes and down
// against the high ones: in (plane - origin) / direction both move the entry toward the start and the exit away from it,
// whatever the direction's sign. An origin far outside of the scene would lose its digits: it first moves along the ray to
// where boxes may begin, and t counts from there.
void PacketThroughWorld::round_rays() {
    const Point anchor = world_.hierarchy.anchor();
    const double anchor_size = std::fabs(anchor.x) + std::fabs(anchor.y) + std::fabs(anchor.z);
    const double reach = reach_;
    const RayPacket& __restrict rays = *packet_;
    FloatRays& __restrict floats = rays_;
    Lanes& __restrict shifts = shifts_;

    const auto inverse = [](double direction) {
        // A direction of 0 counts as one that leaves no box: infinity times 0 would be no number.
        constexpr double least = 1e-36;
        const double kept = std::fabs(direction) < least ? std::copysign(least, direction) : direction;
        return 1 / static_cast<float>(kept);
    };
    for (int i = 0; i < width; ++i) {
        const double dx = rays.direction.x[i], dy = rays.direction.y[i], dz = rays.direction.z[i];
        const double ox = rays.anchor.x[i] + rays.offset.x[i];
        const double oy = rays.anchor.y[i] + rays.offset.y[i];
        const double oz = rays.anchor.z[i] + rays.offset.z[i];
        const double ahead = (anchor.x - ox) * dx + (anchor.y - oy) * dy + (anchor.z - oz) * dz;
        const double shift = ahead > 8 * reach ? ahead - 2 * reach : 0;
        const double x = ox - anchor.x + shift * dx, y = oy - anchor.y + shift * dy, z = oz - anchor.z + shift * dz;
        const double slack = 0x1p-50 * (std::fabs(ox) + std::fabs(oy) + std::fabs(oz) + anchor_size + shift);
        shifts[i] = shift;
        floats.high_x[i] = float_above(x + slack), floats.low_x[i] = float_below(x - slack);
        floats.high_y[i] = float_above(y + slack), floats.low_y[i] = float_below(y - slack);
        floats.high_z[i] = float_above(z + slack), floats.low_z[i] = float_below(z - slack);
        floats.inverse_x[i] = inverse(dx);
        floats.inverse_y[i] = inverse(dy);
        floats.inverse_z[i] = inverse(dz);
    }
}

void PacketThroughWorld::set_limits() {
    if (is_ready_for_boxes_) round_limits(limits_, shifts_, float_limits_);
}

// From where t counts for boxes, rounded up; below 0 where it is.
[[gnu::noinline]] void PacketThroughWorld::round_limits(const Lanes& __restrict limits, const Lanes& __restrict shifts,
                                                        FloatLanes& __restrict rounded) {
    for (int i = 0; i < width; ++i) {
        const double limit = limits[i], shift = shifts[i];
        const double shifted = limit - shift + 0x1p-50 * shift;
        rounded[i] = lesser(float_above(limit >= 0 ? shifted : -1), largest_float);
    }
}

// Whether any ray meets a box within its limit: where they do, `near` is the entry, else infinity.
bool PacketThroughWorld::meets(const std::array<float, 3>& lowest, const std::array<float, 3>& highest,
                               FloatLanes& __restrict near) const {
    constexpr float padding = 1 + 0x1p-20F;  // for the rounding of differences, inverses and products
    const FloatRays& r = rays_;
    const std::array<float, 3> low = lowest, high = highest;
    int met = 0;
    for (int i = 0; i < width; ++i) {
        const float x0 = (low[0] - r.high_x[i]) * r.inverse_x[i], x1 = (high[0] - r.low_x[i]) * r.inverse_x[i];
        const float y0 = (low[1] - r.high_y[i]) * r.inverse_y[i], y1 = (high[1] - r.low_y[i]) * r.inverse_y[i];
        const float z0 = (low[2] - r.high_z[i]) * r.inverse_z[i], z1 = (high[2] - r.low_z[i]) * r.inverse_z[i];
        const float in = greater(greater(greater(lesser(x0, x1), lesser(y0, y1)), lesser(z0, z1)), 0);
        const float out = lesser(lesser(greater(x0, x1), greater(y0, y1)), greater(z0, z1)) * padding;
        const bool is_met = in <= lesser(out, float_limits_[i]);
        near[i] = is_met ? in : INFINITY;
        met += is_met;
    }
    return met > 0;
}

// How many more rays reach the second of two boxes before the first than the other way round.
[[gnu::noinline]] int PacketThroughWorld::votes_for_second(const FloatLanes& __restrict first,
                                                           const FloatLanes& __restrict second) {
    std::int32_t for_first = 0, for_second = 0;
    for (int i = 0; i < width; ++i) for_first += first[i] < second[i] ? 1 : 0;
    for (int i = 0; i < width; ++i) for_second += second[i] < first[i] ? 1 : 0;
    return for_second - for_first;
}

[[gnu::noinline]] bool PacketThroughWorld::is_within(const FloatLanes& __restrict near, const FloatLanes& __restrict limits) {
    std::int32_t count = 0;
    for (int i = 0; i < width; ++i) count += near[i] <= limits[i] ? 1 : 0;
    return count > 0;
}

// Calls visit(solid) for the solids that any ray may meet within its limit.
template <PacketThroughWorld::Order order, class Visit>
void PacketThroughWorld::for_each_solid(const SolidsInReach* among, unsigned quarter, Visit visit) {
    const bool all = !among || !among->are_known;
    for (std::int32_t solid : all ? world_.unbounded : among->unbounded) visit(solid);
    if (all) {
        walk<order>(visit);
        return;
    }
    const auto in_quarter = [quarter](const SolidInReach& solid) { return (solid.quarters & quarter) != 0; };
    const auto count = std::ranges::count_if(among->bounded, in_quarter);
    if (count == 0) return;
    // Most rays that lie near one solid only meet its box, and of a few it costs as much to find out.
    const bool tests_boxes = count > 3;
    if (tests_boxes) get_ready_for_boxes();
    FloatLanes near;
    double furthest = infinity;
    for (const SolidInReach& in_reach : among->bounded) {
        if (!in_quarter(in_reach)) continue;
        if (in_reach.depth > furthest) return;
        if (tests_boxes && !meets(in_reach.low, in_reach.high, near)) continue;
        visit(in_reach.solid);
        furthest = largest(limits_);
    }
}

// While a node's boxes are tested, for what lies in them.
[[gnu::always_inline]] inline void PacketThroughWorld::ask_for_children(const Hierarchy::Node& node) const {
    for (const std::int32_t child : node.child) {
        if (child < 0) ask_for(&world_.solids[~child]);
        if (child >= 0 && child != Hierarchy::no_child) ask_for(&world_.hierarchy.nodes()[child]);
    }
}

// Of a solid that waits.
[[gnu::always_inline]] inline void PacketThroughWorld::ask_for_first_leaf(std::int32_t child) const {
    if (child < 0) ask_for(&world_.leaves[world_.solids[~child].first_leaf]);
}

template <PacketThroughWorld::Order order, class Visit>
void PacketThroughWorld::walk(Visit visit) {
    const std::vector<Hierarchy::Node>& nodes = world_.hierarchy.nodes();
    if (nodes.empty()) return;
    get_ready_for_boxes();
    std::array<FloatLanes, 2> near;
    std::int32_t child = 0;
    for (int size = 0;;) {
        // Down to a solid: of two children that are met the nearer one, while the other waits.
        while (child >= 0) {
            const Hierarchy::Node& node = nodes[child];
            ask_for_children(node);
            std::array<bool, 2> met;
            for (std::size_t i = 0; i < 2; ++i)
                met[i] = node.child[i] != Hierarchy::no_child && meets(node.low[i], node.high[i], near[i]);
            if (!met[0] && !met[1]) break;
            int next = met[0] ? 0 : 1;
            if (met[0] && met[1]) {
                if (order == Order::near_first) next = votes_for_second(near[0], near[1]) > 0 ? 1 : 0;
                ask_for_first_leaf(node.child[1 - next]);
                children_[size] = node.child[1 - next];
                nears_[size++] = near[1 - next];
            }
            child = node.child[next];
        }
        if (child < 0) visit(~child);
        // What waits and is still within the limits of some ray.
        for (bool found = false; !found;) {
            if (size == 0) return;
            child = children_[--size];
            found = is_within(nears_[static_cast<std::size_t>(size)], float_limits_);
        }
    }
}

void PacketThroughWorld::first_boundaries(const RayPacket& rays, const SolidsInReach* among, BoundaryPacket& boundaries,
                                          unsigned quarter) {
    limits_.v.fill(infinity);
    boundaries.t.v.fill(infinity), boundaries.solid.fill(-1), boundaries.leaf.fill(-1), boundaries.face.fill(-1);
    boundaries.starts_inside = 0;
    start(rays);
    const auto meet = [&](std::int32_t solid) { meet_solid(solid, boundaries); };
    for_each_solid<Order::near_first>(among, quarter, meet);
    if (!world_.sheets.empty()) {
        Lanes from;
        from.v.fill(0);
        meet_sheets(from, boundaries);
    }
    if (world_.features.shared_surfaces) name_shared_faces(boundaries);
}

// Of leaves that share faces: which surface it is that rays meet.
void PacketThroughWorld::name_shared_faces(BoundaryPacket& boundaries) {
    unsigned rest = (1u << width) - 1;
    while (rest != 0) {
        const std::int32_t index = boundaries.leaf[static_cast<std::size_t>(std::countr_zero(rest))];
        const unsigned meeting = lanes_with(boundaries.leaf, index);
        rest &= ~meeting;
        if (index < 0 || world_.leaves[index].first_surface < 0) continue;
        PacketThroughSolid::LeafLanes faces;
        solid_.find_shared_faces(world_.leaves[index], boundaries.t, faces);
        for (int lane = 0; lane < width; ++lane) {
            std::int32_t& face = boundaries.face[static_cast<std::size_t>(lane)];
            face = (meeting & bit_of(lane)) != 0 ? static_cast<std::int32_t>(faces[static_cast<std::size_t>(lane)]) : face;
        }
    }
}

void PacketThroughWorld::meet_solid(std::int32_t index, BoundaryPacket& boundaries) {
    const Solid& solid = world_.solids[index];
    Lanes t;
    PacketThroughSolid::LeafLanes leaf;
    solid_.enter(solid, limits_, t, leaf);
    std::int64_t inside = 0;
    for (int i = 0; i < width; ++i) inside += t[i] == 0;
    for (int i = 0; inside > 0 && i < packet_->count; ++i)
        if (t[i] == 0) {  // the way out is what is met
            t[i] = solid_.leave(solid, i), leaf[i] = -1;
            boundaries.starts_inside |= 1u << i;
            count_start_inside(packet_->departure[i], statistics_);
        }

    if (take_closer(t, leaf, index, boundaries, limits_) > 0) set_limits();
}

// Behind `from`.
void PacketThroughWorld::meet_sheets(const Lanes& from, BoundaryPacket& boundaries) {
    const RayPacket& rays = *packet_;
    for (const Sheet& sheet : world_.sheets) {
        const bool simple = sheet.conditions.empty() && world_.leaves[sheet.leaf].first_surface < 0;
        Lanes t;
        if (simple) solid_.cross_sheet(sheet.leaf, t);
        for (int i = 0; i < rays.count; ++i) {
            Boundary first;
            first.t = boundaries.t[i], first.solid = boundaries.solid[i], first.leaf = boundaries.leaf[i];
            if (!simple) {
                single_.start(rays.ray(i));
                single_.meet_sheet(sheet, from[i], first);
            } else if (t[i] > from[i] && t[i] < infinity && comes_before(sheet, t[i], first)) {
                first = {t[i], -1, sheet.leaf, {}, {}};
            }
            boundaries.t[i] = first.t, boundaries.solid[i] = first.solid, boundaries.leaf[i] = first.leaf;
        }
    }
}

unsigned PacketThroughWorld::blocked(const RayPacket& rays, const Lanes& distances, const SolidsInReach* among) {
    limits_ = distances;
    start(rays);
    unsigned blocked = 0;
    for_each_solid<Order::any>(among, SolidInReach::all_rays, [&](std::int32_t index) {
        Lanes t;
        PacketThroughSolid::LeafLanes leaf;
        solid_.enter(world_.solids[index], limits_, t, leaf, true);
        const MetLanes hits = end_met_lanes(t, limits_);  // never lanes without a ray: their limits are below 0
        for (unsigned rest = hits.inside; rest != 0; rest &= rest - 1)
            count_start_inside(rays.departure[std::countr_zero(rest)], statistics_);
        blocked |= hits.met;
        if (hits.met != 0) set_limits();
    });
    return blocked | blocked_by_sheets(distances, ~blocked);
}

bool PacketThroughWorld::are_clear(const Departure& departure, const SolidsInReach& among) const {
    const auto is_clear = [&](std::int32_t index) {
        const Solid& solid = world_.solids[static_cast<std::size_t>(index)];
        return (world_.features.transparency && solid.shadow == Solid::Shadow::clear) || solid_.leaves_for_good(departure, solid);
    };
    return among.are_known && world_.sheets.empty() &&
           std::all_of(among.bounded.begin(), among.bounded.end(), [&](const SolidInReach& s) { return is_clear(s.solid); }) &&
           std::all_of(among.unbounded.begin(), among.unbounded.end(), is_clear);
}

// Which of the rays `among` a packet's are blocked by sheets.
unsigned PacketThroughWorld::blocked_by_sheets(const Lanes& distances, unsigned among) {
    unsigned blocked = 0;
    if (world_.sheets.empty()) return blocked;
    for (unsigned rest = among & packet_->lanes(); rest != 0; rest &= rest - 1) {
        const int i = std::countr_zero(rest);
        if (!(distances[i] >= 0)) continue;
        single_.start(packet_->ray(i));
        for (const Sheet& sheet : world_.sheets)
            if (single_.is_blocked_by(sheet, distances[i])) blocked |= 1u << i;
    }
    return blocked;
}

// ---- transparent Worlds ----------------------------------------------------------------------------------------------

void PacketThroughWorld::first_changes(const RayPacket& rays, const Stretch& stretch, const SolidsInReach* among,
                                       ChangePacket& changes, unsigned quarter) {
    from_ = stretch.from, limits_ = stretch.limit;
    BoundaryPacket& first = changes.first;
    first.t.v.fill(infinity), first.solid.fill(-1), first.leaf.fill(-1);
    first.starts_inside = 0;
    first.face.fill(-1);
    changes.unclear = 0;
    starts_.first.fill(-1), starts_.second.fill(-1);
    starts_.leaves_first = 0, starts_.shared = 0;
    start(rays);
    for_each_solid<Order::near_first>(among, quarter, [&](std::int32_t solid) { change_at_solid(solid, changes); });
    finish_changes(changes);
}

namespace {

// The lanes in which a solid changes before, and where, others do.
struct CloserLanes {
    unsigned closer, shared;
};

[[gnu::noinline]] CloserLanes take_closer_changes(const PacketThroughSolid::Changes& __restrict found,
                                                  ChangePacket& __restrict changes, Lanes& __restrict limits) {
    std::int64_t closer = 0, shared = 0;
    for (int i = 0; i < PacketThroughWorld::width; ++i) {
        const double first = changes.first.t[i], t = found.t[i];
        closer += t < first ? bit_of(i) : 0;
        shared += both(t == first, t < infinity) ? bit_of(i) : 0;
        changes.first.t[i] = t < first ? t : first;
        limits[i] = t < first ? t : limits[i];
    }
    const auto bits = static_cast<unsigned>(closer);
    for (unsigned rest = bits; rest != 0; rest &= rest - 1) {
        const auto lane = static_cast<std::size_t>(std::countr_zero(rest));
        changes.first.leaf[lane] = static_cast<std::int32_t>(found.leaf[lane]);
        changes.first.face[lane] = static_cast<std::int32_t>(found.face[lane]);
    }
    return {bits, static_cast<unsigned>(shared)};
}

}  // namespace

// Whether the first of two solids owns what both hold.
bool PacketThroughWorld::takes_precedence(std::int32_t solid, std::int32_t other) const {
    if (solid < 0 || other < 0) return solid >= 0;
    const Label &a = world_.insides[solid], &b = world_.insides[other];
    return a.priority > b.priority || (a.priority == b.priority && solid < other);
}

// A ray that is in a solid where its stretch begins meets its box before, whatever its limit: all owners of that cell are seen.
void PacketThroughWorld::change_at_solid(std::int32_t index, ChangePacket& changes) {
    const Solid& solid = world_.solids[index];
    if (!solid.fits_lanes) {
        change_at_solid_of_single(index, changes);
        return;
    }
    PacketThroughSolid::Changes found;
    solid_.next_change(solid, from_, limits_, found);
    changes.unclear |= found.doubtful;
    Starts& starts = starts_;
    for (unsigned rest = found.inside; rest != 0; rest &= rest - 1) {
        const auto lane = static_cast<std::size_t>(std::countr_zero(rest));
        std::int32_t behind = index;
        if (takes_precedence(index, starts.first[lane])) std::swap(behind, starts.first[lane]);
        if (takes_precedence(behind, starts.second[lane])) starts.second[lane] = behind;
    }

    const CloserLanes met = take_closer_changes(found, changes, limits_);
    for (unsigned rest = met.closer; rest != 0; rest &= rest - 1) changes.first.solid[std::countr_zero(rest)] = index;
    starts.leaves_first = (starts.leaves_first & ~met.closer) | (found.inside & met.closer);
    starts.shared = (starts.shared & ~met.closer) | met.shared;
    if (met.closer != 0) set_limits();
}

// Of a solid that does not fit lanes, only where it counts is found: the single ray has to say what it is.
void PacketThroughWorld::change_at_solid_of_single(std::int32_t index, ChangePacket& changes) {
    for (int i = 0; i < packet_->count; ++i) {
        if (!(limits_[i] >= 0)) continue;
        const PacketThroughSolid::FirstChange found = solid_.next_change_of_single(world_.solids[index], from_[i], i);
        changes.unclear |= static_cast<unsigned>(found.inside) << i;
        if (!(found.t <= changes.first.t[i]) || found.t == infinity) continue;
        changes.first.t[i] = limits_[i] = found.t;
        starts_.shared |= 1u << i;
    }
    set_limits();
}

void PacketThroughWorld::finish_changes(ChangePacket& changes) {
    const Starts& starts = starts_;
    changes.unclear |= starts.shared;
    for (int i = 0; i < width; ++i) {
        const auto lane = static_cast<std::size_t>(i);
        const std::int32_t changing = changes.first.solid[lane], owner = starts.first[lane];
        const bool leaves = (starts.leaves_first >> i & 1) != 0;
        std::int32_t after = leaves && changing == owner ? starts.second[lane] : owner;
        if (!leaves && takes_precedence(changing, owner)) after = changing;
        changes.before[lane] = owner, changes.after[lane] = after;
    }
    if (world_.sheets.empty()) return;
    meet_sheets(from_, changes.first);
    for (int i = 0; i < width; ++i) {
        const auto lane = static_cast<std::size_t>(i);
        const bool is_sheet = changes.first.leaf[lane] >= 0 && changes.first.solid[lane] < 0;
        changes.after[lane] = is_sheet ? changes.before[lane] : changes.after[lane];
    }
}

// Which rays enter a solid before their limits.
unsigned PacketThroughWorld::reached(std::int32_t index) {
    Lanes t;
    PacketThroughSolid::LeafLanes leaf;
    solid_.enter(world_.solids[index], limits_, t, leaf, true);
    return lanes_within(t, limits_) & packet_->lanes();
}

// What blocks does so whatever else is on the way, and what is clear changes nothing: no order has to be found out.
PacketThroughWorld::Shadows PacketThroughWorld::shadows(const RayPacket& rays, const Lanes& distances,
                                                        const SolidsInReach* among) {
    limits_ = distances;
    start(rays);
    Shadows shadows;
    for_each_solid<Order::any>(among, SolidInReach::all_rays, [&](std::int32_t index) {
        const Solid::Shadow shadow = world_.solids[index].shadow;
        if (shadow == Solid::Shadow::clear) return;
        const unsigned bits = reached(index);
        if (shadow == Solid::Shadow::asked) {
            shadows.asked |= bits;
            return;
        }
        shadows.blocked |= bits;
        for (unsigned rest = bits; rest != 0; rest &= rest - 1) limits_[std::countr_zero(rest)] = -1;
        if (bits != 0) set_limits();
    });
    // Sheets block, too, but where they lie on other faces these may be met in their place.
    shadows.blocked |= blocked_by_sheets(distances, ~(shadows.blocked | shadows.asked));
    shadows.asked &= ~shadows.blocked;
    return shadows;
}

}  // namespace lapidary
