// SPDX-License-Identifier: MIT
//
// A packet of rays through one solid: the same answers as LineThroughSolid, bit for bit.
//
// A solid in product form, inside all of its positive leaves and outside all of its negative ones, is evaluated for all lanes
// in one go:
//
//     t = the largest entry of the positive leaves; while a negative leaf holds t, t = its exit; nothing where a positive leaf
//     ends first.
//
// A negative leaf is asked only when the point at t of some lane lies in its box, and its box only when it overlaps the one
// around the points of all lanes. What does not fit (other trees, a start inside, slivers) is asked of the single ray's own
// evaluation, lane by lane.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "kernel/csg/line_through_solid.h"
#include "kernel/csg/placed_lines.h"
#include "kernel/csg/ray_packet.h"

namespace lapidary {

class LAPIDARY_API PacketThroughSolid {
public:
    static constexpr int width = batch_size;
    using LeafLanes = std::array<std::int64_t, width>;  // as wide as doubles, next to which they are chosen
    // Some numbers, by bounds that all of them lie between.
    struct NumberRange {
        std::int32_t first = 0, last = -1;  // none
        bool has(std::int32_t number) const { return first <= number && number <= last; }
        bool is_one() const { return first == last; }
    };

    PacketThroughSolid(const World& world, TraceStatistics& statistics);

    // The packet must be filled up, and stay where it is until the next start.
    void start(const RayPacket& rays);

    // Whether a ray with this departure leaves a product behind: it departs outward from a positive leaf, each of which is met in
    // one piece.
    bool leaves_for_good(const Departure& departure, const Solid& solid) const;

    // The first entry of every lane into a solid, as far as it is not beyond its limit, and the leaf entered by or, of negative
    // ones, left; -1 where that is not known. A start inside is an entry at 0.
    // Where entries are `only_compared` with the limits, they may be any places of the solid's before their limits, for rays that
    // come from outside.
    void enter(const Solid& solid, const Lanes& limit, Lanes& t, LeafLanes& leaf, bool only_compared = false);
    // The way out of a solid that a lane starts in.
    double leave(const Solid& solid, int lane);
    // Where the inside of a solid that fits lanes begins or ends first behind `from` in every lane, the leaf whose face that
    // is (-1: not known), and which lanes are inside just behind `from`, as far as their limits are not below 0. Slivers, and
    // what rounding makes doubtful, are left to the single ray.
    struct Changes {
        Lanes t;
        LeafLanes leaf;
        LeafLanes face;  // of a leaf that shares faces: which of its surfaces; else without meaning
        unsigned inside, doubtful;
    };
    void next_change(const Solid& solid, const Lanes& from, const Lanes& limit, Changes& changes);
    // The same of one lane, for any solid.
    struct FirstChange {
        double t;
        bool inside;
    };
    FirstChange next_change_of_single(const Solid& solid, double from, int lane);
    // The lines of the rays in a leaf's space.
    const PlacedLines& placed_lines(std::int32_t leaf);
    // What they have in common with it, there. Both are remembered until another leaf is asked for.
    const SpanBatch& local_spans(std::int32_t leaf);
    // Of a leaf that shares faces, and that is met at t in the lanes that count: the first of its surfaces there; -1: none, or
    // one that rounding moved.
    void find_shared_faces(const Leaf& leaf, const Lanes& t, LeafLanes& face);
    // Where every lane meets a sheet that shares no plane.
    void cross_sheet(std::int32_t leaf, Lanes& t);

private:
    // Where the rays start, in one part, and the largest magnitude of each one's coordinates.
    struct Origins {
        Lanes x, y, z, size;
    };
    // Where the lanes are at some t each, for tests against boxes. Lanes that do not count are nowhere: a slack of -infinity
    // keeps them out of every box.
    struct Positions {
        Lanes x, y, z, slack;
    };

    bool all_leave(const Solid& solid, const Lanes& limit) const;
    bool is_convex(const SurfaceUse& use) const;
    bool all_pass_beside(const Solid& solid, const Lanes& limit) const;
    bool all_pass_through_ball(const Solid& solid, const Lanes& limit, Lanes& t) const;
    bool may_depart_from(std::int32_t leaf) const;
    void enter_product(const Solid& solid, const Lanes& limit, Lanes& t, LeafLanes& leaf, bool only_compared);
    bool enter_positive_leaves(const Solid& solid, const Lanes& limit, bool only_compared, Lanes& t, Lanes& first_out,
                               LeafLanes& leaf);
    bool are_within(std::int32_t leaf, const Lanes& t, const Lanes& end) const;
    void leave_negative_leaves(const Solid& solid, const Lanes& limit, const Lanes& first_out, Lanes& t, LeafLanes& leaf);
    static constexpr std::int32_t none_left = -1;
    std::int32_t leave_negative_leaves_once(const Solid& solid, std::int32_t left_before, Lanes& t, Lanes& moved,
                                            LeafLanes& leaf);
    void reconsider_doubtful(const Solid& solid, const Lanes& first_out, Lanes& t, LeafLanes& leaf);
    static void find_origins(const RayPacket& rays, Origins& origins);
    static void find_positions(const Origins& origins, const VectorLanes& direction, double rounding, const Lanes& t,
                               const Lanes& unsettled, Positions& positions);
    static Bounds surroundings_of(const Positions& positions);  // all that lies within their slack
    bool any_may_be_in(const Leaf& leaf) const;
    bool any_in_box(const Bounds& box) const;
    bool any_in_ball(const Point& centre, double radius) const;
    bool leave_negative_leaf(std::int32_t slot, std::int32_t index, Lanes& t, Lanes& moved, LeafLanes& leaf);

    // The spans of a leaf, and its faces at their ends.
    struct LeafSpans {
        Lanes in, out;
        LeafLanes in_face, out_face;  // of a leaf that shares faces: the surfaces that the ends are on; -1: several
    };

    // The functions of LineThroughSolid, for all lanes, over the spans of all leaves of a solid that fits lanes.
    void ask_leaves(const Solid& solid);
    void next_change_of_leaf(std::int32_t leaf, const Lanes& from, const Lanes& limit, Changes& changes) const;
    void enter(std::int32_t tree, Lanes& t) const;
    void leave(std::int32_t tree, Lanes& t) const;
    void hold(std::int32_t tree, const Lanes& t, Lanes& held) const;
    unsigned find_doubtful(const Solid& solid, const Lanes& inside, const Lanes& t) const;
    void find_changing_leaves(const Solid& solid, Changes& changes) const;

    // Which ends of spans have to be exact; others may be off by their rounding.
    struct Asked {
        const Lanes* from;   // those from here on …
        const Lanes* to;     // … up to here; null: any
        const Lanes* limit;  // of them, those that are next to 0 or the limit; null: all

        bool holds(double end, double slack, int lane) const {
            const bool is_outside = (from && end + slack < (*from)[lane]) || (to && end - slack > (*to)[lane]);
            return !is_outside && (!limit || std::fabs(end) <= slack || std::fabs(end - (*limit)[lane]) <= slack);
        }
    };

    // Empty spans have in > out.
    void spans(std::int32_t leaf, Lanes& in, Lanes& out, LeafSpans* faces = nullptr, const Asked& asked = {});
    void shared_spans(const Leaf& leaf, Lanes& in, Lanes& out, LeafSpans* faces);
    void surface_spans(const SurfaceUse& use, const Asked& asked, Lanes& in, Lanes& out);
    unsigned own_spans(const Leaf& leaf, Lanes& in, Lanes& out);
    unsigned tube_spans(const Leaf& frame, double radius, Lanes& in, Lanes& out);
    void plane_spans(const SurfaceUse& use, const SurfaceClass& surface_class, const Asked& asked, Lanes& in, Lanes& out);
    // Ends close to the rays' origins are found anew, lane by lane, as LineThroughSolid does.
    void find_near_ends_of_lanes(unsigned near, const Leaf& leaf, std::span<const Surface> faces, unsigned departing,
                                 const Asked& asked, Lanes& in, Lanes& out) const;
    unsigned lanes_departing_from(std::int32_t surface_class) const;
    void remove_departures(unsigned departing, Lanes& in, Lanes& out) const;

    const World& world_;
    TraceStatistics& statistics_;
    LineThroughSolid line_;

    const RayPacket* rays_ = nullptr;
    NumberRange departed_leaves_, departed_classes_;  // what lanes depart from
    bool depart_alike_ = false;                       // all of them from one face, to the same side
    Origins origins_;

    std::int32_t placed_leaf_ = -1;
    PlacedLines placed_;
    std::int32_t local_leaf_ = -1;
    SpanBatch local_spans_;

    // The negative leaves of the solid under way that were asked so far.
    struct NegativeLeaf {
        std::int32_t leaf = -1;
        Lanes in, out;
    };
    Positions positions_;
    std::uint64_t stamp_ = 0;
    std::vector<std::uint64_t> asked_stamp_;
    std::vector<std::int32_t> asked_slot_;
    std::vector<NegativeLeaf> asked_;
    std::size_t asked_count_ = 0;

    // Of the leaves of a solid that fits lanes, from its first leaf on.
    std::vector<LeafSpans> leaf_spans_;
    std::int32_t first_leaf_ = 0;
};

}  // namespace lapidary
