// SPDX-License-Identifier: MIT
#include "kernel/csg/ray_through_world.h"

#include <algorithm>
#include <cmath>

namespace lapidary {

void RayThroughWorld::start(const Ray& ray) {
    ray_ = ray;
    origin_ = ray.origin.rounded();
    origin_size_ = std::max({std::fabs(origin_.x), std::fabs(origin_.y), std::fabs(origin_.z)});
    line_.start(ray);
}

template <class Visit>
void RayThroughWorld::for_each_solid_at(double t, Visit visit) {
    const auto select_and_visit = [&](std::int32_t solid) {
        line_.select(world_.solids[solid]);
        visit(solid);
    };
    for (std::int32_t solid : world_.unbounded) select_and_visit(solid);
    world_.hierarchy.for_each_at(origin_ + t * ray_.direction, slack(t), select_and_visit);
}

namespace {

// Of the solids that hold a point, the one of highest priority owns it, among equals the first in the order of writing.
struct Ownership {
    Label owner;
    std::int32_t solid = -1;

    void claim(const Label& candidate, std::int32_t claimant) {
        if (candidate.is_empty()) return;
        const bool wins =
            owner.is_empty() || candidate.priority > owner.priority || (candidate.priority == owner.priority && claimant < solid);
        if (wins) owner = candidate, solid = claimant;
    }
};

}  // namespace

Label RayThroughWorld::label(double t, Side side) {
    Ownership ownership;
    for_each_solid_at(t, [&](std::int32_t solid) { ownership.claim(line_.label(t, side), solid); });
    return ownership.owner;
}

// What lies behind a boundary. Where several solids change there at once, its face becomes that of the first in the order of
// writing.
Label RayThroughWorld::step_into(Boundary& boundary) {
    Ownership behind;
    for_each_solid_at(boundary.t, [&](std::int32_t solid) {
        behind.claim(line_.label(boundary.t, Side::after), solid);
        if (boundary.leaf >= 0 && solid >= boundary.solid) return;
        if (const std::int32_t leaf = line_.leaf_at(boundary.t); leaf >= 0) boundary.leaf = leaf, boundary.solid = solid;
    });
    return behind.owner;
}

double RayThroughWorld::next_change(std::int32_t solid, double from, Boundary& first) {
    line_.select(world_.solids[solid]);
    if (world_.features.transparency) return line_.next_change(from);
    const double t = line_.enter(from);
    if (t > from) return t;
    first.starts_inside = true;
    count_start_inside(ray_.departure, statistics_);
    return line_.leave(from);
}

Boundary RayThroughWorld::next(double from, const Label& here) {
    Boundary first;
    const auto visit = [&](std::int32_t solid) {
        const double t = next_change(solid, from, first);
        if (t > from && (t < first.t || (t == first.t && solid < first.solid && t < infinity))) first.t = t, first.solid = solid;
        return first.t;
    };
    for (std::int32_t solid : world_.unbounded) visit(solid);
    world_.hierarchy.for_each_along(origin_, ray_.direction, first.t, visit);

    for (const Sheet& sheet : world_.sheets) meet_sheet(sheet, from, first);
    if (first.t == infinity) return first;

    if (world_.features.transparency) {
        first.before = here;
        first.after = first.is_sheet() ? here : step_into(first);
    } else if (!first.is_sheet()) {
        complete_opaque(first);
    }
    return first;
}

void RayThroughWorld::meet_sheet(const Sheet& sheet, double from, Boundary& first) {
    const double t = line_.cross_sheet(sheet.leaf);
    if (t > from && t < infinity && comes_before(sheet, t, first) && is_seen(sheet, t))
        first = {t, -1, sheet.leaf, {}, {}, first.starts_inside};
}

void RayThroughWorld::complete_opaque(Boundary& boundary) {
    line_.select(world_.solids[boundary.solid]);
    if (boundary.leaf < 0) boundary.leaf = line_.leaf_at(boundary.t);
    // From far away both ends of a span may round to one t, at which nothing seems to change: a leaf alone is met all the same.
    const Solid& solid = world_.solids[boundary.solid];
    if (boundary.leaf < 0 && solid.leaf_count == 1) boundary.leaf = solid.first_leaf;
    if (boundary.leaf >= 0 && world_.leaves[boundary.leaf].appearance < 0) {
        boundary.before = line_.label(boundary.t, Side::before);
        boundary.after = line_.label(boundary.t, Side::after);
    }
}

bool RayThroughWorld::enters(const Boundary& boundary) {
    line_.select(world_.solids[boundary.solid]);
    return line_.inside(boundary.t, Side::after) || !line_.inside(boundary.t, Side::before);
}

// A sheet is seen where every operand that clips it lets it be. Clips are closed sets: a sheet in their boundary is inside.
bool RayThroughWorld::is_seen(const Sheet& sheet, double t) {
    return std::all_of(sheet.conditions.begin(), sheet.conditions.end(), [&](const Sheet::Condition& condition) {
        line_.select(world_.clips[condition.solid]);
        const bool inside = line_.inside(t, Side::before) || line_.inside(t, Side::after);
        return inside == condition.inside;
    });
}

bool RayThroughWorld::is_blocked(double distance) {
    bool blocked = false;
    const auto visit = [&](std::int32_t solid) {
        line_.select(world_.solids[solid]);
        const double t = line_.enter(0);
        if (t == 0) count_start_inside(ray_.departure, statistics_);
        blocked = t < distance;
        return blocked ? -1.0 : distance;
    };
    for (std::int32_t solid : world_.unbounded)
        if (visit(solid) < 0) return true;
    world_.hierarchy.for_each_along(origin_, ray_.direction, distance, visit);
    if (blocked) return true;
    return std::any_of(world_.sheets.begin(), world_.sheets.end(),
                       [&](const Sheet& sheet) { return is_blocked_by(sheet, distance); });
}

bool RayThroughWorld::is_blocked_by(const Sheet& sheet, double distance) {
    const double t = line_.cross_sheet(sheet.leaf);
    return t > 0 && t < distance && is_seen(sheet, t);
}

}  // namespace lapidary
