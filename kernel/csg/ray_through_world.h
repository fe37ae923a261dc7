// SPDX-License-Identifier: MIT
//
// A ray through all solids of the World: where matter begins, ends or changes, and whether anything is in the way.
//
// The medium on each side of a face is read from the set of solids that hold the point, never from a stack carried along
// the path: nothing to corrupt, nothing to initialise for a camera inside.
#pragma once

#include "kernel/csg/line_through_solid.h"

namespace lapidary {

// A place on the ray where what a point is made of may change, or a sheet.
struct Boundary {
    double t = infinity;         // infinity: nothing ahead
    std::int32_t solid = -1;     // in World::solids; -1 for a sheet
    std::int32_t leaf = -1;      // whose face it is
    Label before, after;         // of the whole World; in an opaque World, of the one solid
    bool starts_inside = false;  // of an opaque World: the ray starts in a solid
    bool is_sheet() const { return leaf >= 0 && solid < 0; }
};

// Counts a ray that was sent into empty space, and is found in a solid of an opaque World.
inline void count_start_inside(const Departure& departure, TraceStatistics& statistics) {
    if (departure.cell == Departure::no_cell) ++statistics.first_cell_disagreements;
}

// Whether a sheet met at t comes before what was found so far; at the same place, what was written first does.
inline bool comes_before(const Sheet& sheet, double t, const Boundary& first) {
    return t < first.t || (t == first.t && !first.is_sheet() && sheet.order <= first.solid);
}

class LAPIDARY_API RayThroughWorld {
public:
    RayThroughWorld(const World& world, TraceStatistics& statistics)
        : world_(world), statistics_(statistics), line_(world, statistics) {}

    void start(const Ray& ray);

    // What the ray is in at t, on one side of it.
    Label label(double t, Side side);
    // The first boundary behind `from`; where nothing is transparent, `from` is the start of the ray. `here` is what the ray is
    // in on the way there.
    Boundary next(double from, const Label& here);
    // Replaces `first` by a sheet that is seen before it.
    void meet_sheet(const Sheet& sheet, double from, Boundary& first);
    // Fills in which leaf's face a boundary of one solid is, and, where that leaf shows the innards, their labels.
    void complete_opaque(Boundary& boundary);
    // Whether a solid lies behind its boundary, not before it.
    bool enters(const Boundary& boundary);
    // The face of a boundary.
    FaceHit face(const Boundary& boundary) { return line_.face_at(boundary.leaf, boundary.t); }

    // Whether any solid or sheet lies between the start and `distance`, for a World in which all are opaque.
    bool is_blocked(double distance);
    bool is_blocked_by(const Sheet& sheet, double distance);

private:
    Label step_into(Boundary& boundary);
    double next_change(std::int32_t solid, double from, Boundary& first);
    bool is_seen(const Sheet& sheet, double t);
    double slack(double t) const { return 0x1p-50 * (origin_size_ + std::fabs(t)); }
    template <class Visit>
    void for_each_solid_at(double t, Visit visit);

    const World& world_;
    TraceStatistics& statistics_;
    LineThroughSolid line_;
    Ray ray_;
    Point origin_;
    double origin_size_ = 0;
};

}  // namespace lapidary
