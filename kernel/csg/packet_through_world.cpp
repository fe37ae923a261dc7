// SPDX-License-Identifier: MIT
#include "kernel/csg/packet_through_world.h"

#include <algorithm>
#include <cmath>

#include "kernel/csg/departure.h"
#include "kernel/math/roots.h"

namespace lapidary {

PacketThroughWorld::PacketThroughWorld(const World& world, TraceStatistics& statistics)
    : world_(world),
      statistics_(statistics),
      single_(world, statistics),
      line_(world, statistics),
      negative_stamp_(static_cast<std::size_t>(world.most_leaves)),
      negative_in_(static_cast<std::size_t>(world.most_leaves)),
      negative_out_(static_cast<std::size_t>(world.most_leaves)) {}

void PacketThroughWorld::start(const RayPacket& rays) {
    rays_ = rays;
    placed_leaf_ = -1;
    const Point anchor = world_.hierarchy.anchor();
    for (int i = 0; i < width; ++i) {
        origin_x_[i] = rays.anchor.x[i] + rays.offset.x[i];
        origin_y_[i] = rays.anchor.y[i] + rays.offset.y[i];
        origin_z_[i] = rays.anchor.z[i] + rays.offset.z[i];
        relative_x_[i] = origin_x_[i] - anchor.x, relative_y_[i] = origin_y_[i] - anchor.y,
        relative_z_[i] = origin_z_[i] - anchor.z;
        inverse_x_[i] = SlabLine::finite_inverse(rays.direction.x[i]);
        inverse_y_[i] = SlabLine::finite_inverse(rays.direction.y[i]);
        inverse_z_[i] = SlabLine::finite_inverse(rays.direction.z[i]);
        const double x = std::fabs(origin_x_[i]), y = std::fabs(origin_y_[i]), z = std::fabs(origin_z_[i]);
        const double larger = x < y ? y : x;
        origin_size_[i] = larger < z ? z : larger;
    }
    // Lanes without a ray are done from the start.
    for (int i = rays.count; i < width; ++i) limit_[i] = -1;
    update_furthest();
}

void PacketThroughWorld::update_furthest() { furthest_ = *std::max_element(limit_.v.begin(), limit_.v.end()); }

// Whether any lane meets the box within its limit, and where the first one does.
bool PacketThroughWorld::meets(const std::array<float, 3>& low, const std::array<float, 3>& high, double& nearest) const {
    constexpr double padding = 1 + 8 * 0x1p-52;
    const double low_x = low[0], low_y = low[1], low_z = low[2], high_x = high[0], high_y = high[1], high_z = high[2];
    Lanes near{};
    for (int i = 0; i < width; ++i) {
        const double x0 = (low_x - relative_x_[i]) * inverse_x_[i], x1 = (high_x - relative_x_[i]) * inverse_x_[i];
        const double y0 = (low_y - relative_y_[i]) * inverse_y_[i], y1 = (high_y - relative_y_[i]) * inverse_y_[i];
        const double z0 = (low_z - relative_z_[i]) * inverse_z_[i], z1 = (high_z - relative_z_[i]) * inverse_z_[i];
        const double in_x = x0 < x1 ? x0 : x1, out_x = x0 < x1 ? x1 : x0;
        const double in_y = y0 < y1 ? y0 : y1, out_y = y0 < y1 ? y1 : y0;
        const double in_z = z0 < z1 ? z0 : z1, out_z = z0 < z1 ? z1 : z0;
        double in = in_x > in_y ? in_x : in_y;
        in = in > in_z ? in : in_z;
        in = in > 0 ? in : 0;
        double out = out_x < out_y ? out_x : out_y;
        out = (out < out_z ? out : out_z) * padding;
        out = out < limit_[i] ? out : limit_[i];
        near[i] = in <= out ? in : infinity;
    }
    nearest = near[0];
    for (int i = 1; i < width; ++i) nearest = near[i] < nearest ? near[i] : nearest;
    return nearest < infinity;
}

// Solids that any lane may meet within its limit, near ones first.
template <class Visit>
void PacketThroughWorld::for_each_solid(Visit visit) {
    for (std::int32_t solid : world_.unbounded) visit(solid);
    world_.hierarchy.walk([this](const auto& low, const auto& high, double& near) { return meets(low, high, near); },
                          [this] { return furthest_; }, visit);
}

void PacketThroughWorld::first_boundaries(const RayPacket& rays, BoundaryPacket& boundaries) {
    for (int i = 0; i < width; ++i) limit_[i] = infinity;
    start(rays);
    boundaries.t.v.fill(infinity), boundaries.solid.fill(-1), boundaries.leaf.fill(-1);
    for_each_solid([&](std::int32_t index) {
        Lanes t;
        std::array<std::int32_t, width> leaf;
        enter(world_.solids[index], t, leaf);
        bool closer = false;
        for (int i = 0; i < rays.count; ++i) {
            if (t[i] == 0) {  // a start inside: the way out is what is met
                line_.start(rays.ray(i));
                line_.select(world_.solids[index]);
                t[i] = line_.leave(0), leaf[i] = -1;
            }
            const double first = boundaries.t[i];
            if (t[i] > 0 && (t[i] < first || (t[i] == first && t[i] < infinity && index < boundaries.solid[i]))) {
                boundaries.t[i] = limit_[i] = t[i], boundaries.solid[i] = index, boundaries.leaf[i] = leaf[i];
                closer = true;
            }
        }
        if (closer) update_furthest();
    });
    meet_sheets(boundaries);
}

void PacketThroughWorld::meet_sheets(BoundaryPacket& boundaries) {
    for (const Sheet& sheet : world_.sheets) {
        const Leaf& leaf = world_.leaves[sheet.leaf];
        const bool simple = sheet.conditions.empty() && leaf.first_surface < 0;
        Lanes in, out;
        if (simple) own_spans(leaf, in, out);
        for (int i = 0; i < rays_.count; ++i) {
            Boundary first;
            first.t = boundaries.t[i], first.solid = boundaries.solid[i], first.leaf = boundaries.leaf[i];
            if (!simple) {
                single_.start(rays_.ray(i));
                single_.meet_sheet(sheet, 0, first);
            } else {
                const double t = rays_.departure[i].leaf == sheet.leaf ? infinity : placed_.anchor[i] + in[i];
                if (t > 0 && t < infinity && comes_before(sheet, t, first)) first = {t, -1, sheet.leaf, {}, {}};
            }
            boundaries.t[i] = first.t, boundaries.solid[i] = first.solid, boundaries.leaf[i] = first.leaf;
        }
    }
}

unsigned PacketThroughWorld::blocked(const RayPacket& rays, const Lanes& distances) {
    limit_ = distances;
    start(rays);
    unsigned blocked = 0;
    const unsigned all = (1u << rays.count) - 1;
    for_each_solid([&](std::int32_t index) {
        if (blocked == all) return;
        Lanes t;
        std::array<std::int32_t, width> leaf;
        enter(world_.solids[index], t, leaf);
        const unsigned before = blocked;
        for (int i = 0; i < rays.count; ++i)
            if (t[i] < distances[i]) blocked |= 1u << i, limit_[i] = -1;
        if (blocked != before) update_furthest();
    });
    for (const Sheet& sheet : world_.sheets)
        for (int i = 0; i < rays.count && blocked != all; ++i) {
            if (blocked & (1u << i)) continue;
            single_.start(rays.ray(i));
            if (single_.is_blocked_by(sheet, distances[i])) blocked |= 1u << i;
        }
    return blocked;
}

void PacketThroughWorld::enter(const Solid& solid, Lanes& t, std::array<std::int32_t, width>& leaf) {
    if (solid.is_product) {
        enter_product(solid, t, leaf);
        return;
    }
    for (int i = 0; i < width; ++i) {
        leaf[i] = -1;
        t[i] = infinity;
        if (!(limit_[i] >= 0)) continue;
        line_.start(rays_.ray(i));
        line_.select(solid);
        t[i] = line_.enter(0);
    }
}

bool PacketThroughWorld::any_in_box(const Bounds& box, const Lanes& t) const {
    // Counting instead of stopping keeps the lanes together.
    int held = 0;
    for (int i = 0; i < width; ++i) {
        const double slack = 0x1p-50 * (origin_size_[i] + (t[i] < infinity ? t[i] : 0));
        const double x = origin_x_[i] + t[i] * rays_.direction.x[i];
        const double y = origin_y_[i] + t[i] * rays_.direction.y[i];
        const double z = origin_z_[i] + t[i] * rays_.direction.z[i];
        held += (x >= box.low.x - slack) & (x <= box.high.x + slack) & (y >= box.low.y - slack) & (y <= box.high.y + slack) &
                (z >= box.low.z - slack) & (z <= box.high.z + slack);
    }
    return held > 0;
}

void PacketThroughWorld::enter_product(const Solid& solid, Lanes& t, std::array<std::int32_t, width>& leaf) {
    const std::int32_t* positive = world_.product_leaves.data() + solid.first_product_leaf;
    const std::int32_t* negative = positive + solid.positive_count;

    // All of the positive leaves: the last entry, while none has ended.
    Lanes first_out;
    for (int i = 0; i < width; ++i) t[i] = 0, first_out[i] = infinity, leaf[i] = -1;
    for (std::int32_t p = 0; p < solid.positive_count; ++p) {
        Lanes in, out;
        spans(positive[p], in, out);
        for (int i = 0; i < width; ++i) {
            if (in[i] > t[i]) t[i] = in[i], leaf[i] = positive[p];
            first_out[i] = out[i] < first_out[i] ? out[i] : first_out[i];
        }
    }
    int alive = 0;
    for (int i = 0; i < width; ++i) {
        t[i] = t[i] < first_out[i] && t[i] <= limit_[i] ? t[i] : infinity;
        alive += t[i] < infinity;
    }
    if (alive == 0) return;

    // Out of the negative leaves, until none holds any lane.
    ++stamp_;
    for (bool moved = solid.negative_count > 0; moved;) {
        moved = false;
        for (std::int32_t n = 0; n < solid.negative_count; ++n) {
            const Leaf& subtrahend = world_.leaves[negative[n]];
            if (!any_in_box(subtrahend.box, t)) continue;
            Lanes &in = negative_in_[n], &out = negative_out_[n];
            if (negative_stamp_[n] != stamp_) {
                negative_stamp_[n] = stamp_;
                spans(negative[n], in, out);
            }
            int left = 0;
            for (int i = 0; i < width; ++i) {
                const bool holds = in[i] <= t[i] && t[i] < out[i];
                if (holds) t[i] = out[i], leaf[i] = negative[n];
                left += holds;
            }
            moved |= left > 0;
        }
        for (int i = 0; i < width; ++i) t[i] = t[i] < first_out[i] ? t[i] : infinity;
    }
    if (solid.leaf_count == 1) return;

    // Where the same place is an entry of a positive leaf and an exit of negative ones, the positive one is shown; of several
    // negative ones the first. Slivers, and what rounding makes doubtful, are left to the single ray.
    Lanes further;
    for (int i = 0; i < width; ++i) further[i] = t[i] + (64 * 0x1p-53 * t[i] + solid.rounding);
    Lanes sliver;
    for (int i = 0; i < width; ++i) sliver[i] = further[i] < first_out[i] ? 0 : 1;
    for (std::int32_t n = 0; n < solid.negative_count; ++n) {
        if (negative_stamp_[n] != stamp_) {
            if (!any_in_box(world_.leaves[negative[n]].box, further)) continue;
            negative_stamp_[n] = stamp_;
            spans(negative[n], negative_in_[n], negative_out_[n]);
        }
        for (int i = 0; i < width; ++i) {
            if (negative_in_[n][i] <= further[i] && further[i] < negative_out_[n][i]) sliver[i] = 1;
            if (negative_out_[n][i] == t[i] && leaf[i] != negative[n]) leaf[i] = -1;
        }
    }
    for (int i = 0; i < width; ++i) {
        if (!(t[i] < infinity) || sliver[i] == 0) continue;
        line_.start(rays_.ray(i));
        line_.select(solid);
        t[i] = line_.enter(0);
        leaf[i] = -1;
    }
}

const PlacedLines& PacketThroughWorld::placed_lines(std::int32_t index) {
    if (placed_leaf_ != index) place_lines(world_.leaves[index].placement, rays_, placed_);
    placed_leaf_ = index;
    return placed_;
}

// A leaf's one span in every lane; an empty one ends before it begins.
void PacketThroughWorld::spans(std::int32_t index, Lanes& in, Lanes& out) {
    statistics_.object_tests += static_cast<std::uint64_t>(rays_.count);
    const Leaf& leaf = world_.leaves[index];
    if (leaf.first_surface >= 0) {
        shared_spans(leaf, in, out);
        return;
    }
    own_spans(leaf, in, out);
    for (int i = 0; i < width; ++i) {
        const bool empty = !(in[i] < out[i]);
        in[i] = empty ? infinity : placed_.anchor[i] + in[i];
        out[i] = empty ? -infinity : placed_.anchor[i] + out[i];
    }
    if (rays_.departs) remove_departures(in, out, index, -1);
}

// In the leaf's own t, with placed_ set to its lines.
void PacketThroughWorld::own_spans(const Leaf& leaf, Lanes& in, Lanes& out) {
    placed_lines(static_cast<std::int32_t>(&leaf - world_.leaves.data()));
    SpanBatch batch;
    leaf.object->spans_batch(placed_.lines, width, &batch);
    for (int i = 0; i < width; ++i) in[i] = batch.in[i], out[i] = batch.out[i];
}

void PacketThroughWorld::shared_spans(const Leaf& leaf, Lanes& in, Lanes& out) {
    for (int i = 0; i < width; ++i) in[i] = -infinity, out[i] = infinity;
    for (std::int32_t s = 0; s < leaf.surface_count; ++s) {
        const SurfaceUse& use = world_.surface_uses[leaf.first_surface + s];
        const SurfaceClass& surface_class = world_.surface_classes[use.surface_class];
        const Leaf& frame = world_.leaves[surface_class.leaf];
        Lanes surface_in, surface_out;
        if (!surface_class.whole && surface_class.surface.kind == Surface::Kind::plane) {
            plane_spans(use, frame, surface_class.surface, surface_in, surface_out);
        } else {
            if (!surface_class.whole && surface_class.surface.kind == Surface::Kind::cylinder) {
                placed_lines(surface_class.leaf);
                for (int i = 0; i < width; ++i) {
                    const Span span = tube_span(placed_.lines.line(i), surface_class.surface.a);
                    surface_in[i] = span.in, surface_out[i] = span.out;
                }
            } else {
                own_spans(frame, surface_in, surface_out);
            }
            for (int i = 0; i < width; ++i) {
                const bool empty = !(surface_in[i] < surface_out[i]);
                surface_in[i] = empty ? infinity : placed_.anchor[i] + surface_in[i];
                surface_out[i] = empty ? -infinity : placed_.anchor[i] + surface_out[i];
            }
            if (rays_.departs) remove_departures(surface_in, surface_out, -1, use.surface_class);
        }
        for (int i = 0; i < width; ++i) {
            in[i] = surface_in[i] > in[i] ? surface_in[i] : in[i];
            out[i] = surface_out[i] < out[i] ? surface_out[i] : out[i];
        }
    }
    for (int i = 0; i < width; ++i)
        if (!(in[i] < out[i])) in[i] = infinity, out[i] = -infinity;
}

void PacketThroughWorld::plane_spans(const SurfaceUse& use, const Leaf& frame, const Surface& plane, Lanes& in, Lanes& out) {
    placed_lines(static_cast<std::int32_t>(&frame - world_.leaves.data()));
    const LineBatch& lines = placed_.lines;
    const double side_of_shift = dot(frame.placement.to_parent(Normal(plane.a, plane.b, plane.c)), generic_shift);
    for (int i = 0; i < width; ++i) {
        const double slope = plane.a * lines.direction_x[i] + plane.b * lines.direction_y[i] + plane.c * lines.direction_z[i];
        const double distance =
            lines.closest_x[i] * plane.a + lines.closest_y[i] * plane.b + lines.closest_z[i] * plane.c - plane.d;
        const double t = placed_.anchor[i] - distance / slope;
        const bool parallel = slope == 0 || !(std::fabs(t) < infinity);
        const bool holds = distance != 0 ? distance < 0 : side_of_shift < 0;
        in[i] = parallel ? (holds ? -infinity : infinity) : (slope > 0 ? -infinity : t);
        out[i] = parallel ? (holds ? infinity : -infinity) : (slope > 0 ? t : infinity);
    }
    if (rays_.departs)
        for (int i = 0; i < width; ++i) {
            const Departure& departure = rays_.departure[i];
            if (departure.surface_class != use.surface_class) continue;
            in[i] = departure.inward ? 0 : -infinity;
            out[i] = departure.inward ? infinity : 0;
        }
    if (use.flipped)
        for (int i = 0; i < width; ++i) {
            // The other side of the plane, with the same t.
            const bool everywhere = in[i] == -infinity && out[i] == infinity, nowhere = in[i] > out[i];
            const double old_in = in[i], old_out = out[i];
            in[i] = everywhere ? infinity : nowhere || old_in > -infinity ? -infinity : old_out;
            out[i] = everywhere ? -infinity : nowhere ? infinity : old_in > -infinity ? old_in : infinity;
        }
}

void PacketThroughWorld::remove_departures(Lanes& in, Lanes& out, std::int32_t leaf, std::int32_t surface_class) const {
    for (int i = 0; i < rays_.count; ++i) {
        const Departure& departure = rays_.departure[i];
        const bool departs = surface_class >= 0 ? departure.surface_class == surface_class : departure.leaf == leaf;
        if (!departs || !(in[i] <= out[i])) continue;
        Span span{in[i], out[i]};
        const bool remains = remove_departure_root(&span, 1, departure.inward) > 0;
        in[i] = remains ? span.in : infinity;
        out[i] = remains ? span.out : -infinity;
    }
}

}  // namespace lapidary
