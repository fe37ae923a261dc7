// SPDX-License-Identifier: MIT
//
// A binary bounding-volume hierarchy over boxes, built by the binned surface-area heuristic: large parts at the same time
// where there are threads, into the same tree whatever their number.
//
// Boxes are stored as floats relative to an anchor, rounded outward and padded, so that no box loses a ray that the
// double arithmetic of its contents would find.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "kernel/export.h"
#include "kernel/math/bounds.h"

namespace lapidary {

class LAPIDARY_API Hierarchy {
public:
    // Two children with their boxes: one cache line.
    struct alignas(64) Node {
        std::array<std::array<float, 3>, 2> low, high;
        std::array<std::int32_t, 2> child;  // a node; or, where negative, ~index of an item; empty: no_child
    };
    static constexpr std::int32_t no_child = INT32_MAX;

    Hierarchy() = default;
    // Over those of the boxes that floats can hold; the others are listed as left out. Boxes are numbered from `first` on.
    Hierarchy(std::span<const Bounds> boxes, std::int32_t first, std::vector<std::int32_t>& left_out);

    const std::vector<Node>& nodes() const { return nodes_; }
    const Point& anchor() const { return anchor_; }
    bool is_empty() const { return nodes_.empty(); }
    // The furthest that any box reaches from the anchor.
    double reach() const;

    // Calls visit(item) for the items whose boxes `meets(low, high, near)` says are met, near ones first, as long as they are
    // not beyond limit().
    template <class Meets, class Limit, class Visit>
    void walk(Meets meets, Limit limit, Visit visit) const;

    // Calls visit(item) for the items whose boxes the line from `origin` meets between 0 and limit, near ones first; visit
    // returns the new limit.
    template <class Visit>
    void for_each_along(const Point& origin, const Vector& direction, double limit, Visit visit) const;

    // Calls visit(item) for the items whose boxes hold the point, to within `slack`, its own rounding.
    template <class Visit>
    void for_each_at(const Point& point, double slack, Visit visit) const;

    // Calls visit(item) for the items whose boxes overlap another one.
    template <class Visit>
    void for_each_overlapping(const Bounds& box, Visit visit) const;

private:
    // Calls visit(item) for the items whose boxes, and all boxes around them, are such that holds(low, high).
    template <class Holds, class Visit>
    void for_each_where(Holds holds, Visit visit) const;

    Point anchor_;
    std::vector<Node> nodes_;
};

// Where a line runs inside a box: entry and exit by the slab method. (b - o) / d keeps its digits where b / d - o / d
// would not. A direction of 0 counts as 1e-300, so that an origin on the face gives 0 and not NaN. The exit is padded by a
// few ulp (Ize 2013).
struct SlabLine {
    double ox, oy, oz, ix, iy, iz;

    SlabLine(const Point& o, const Vector& d)
        : ox(o.x), oy(o.y), oz(o.z), ix(finite_inverse(d.x)), iy(finite_inverse(d.y)), iz(finite_inverse(d.z)) {}

    // The same line with its origin relative to another place.
    SlabLine relative_to(const Point& place) const {
        SlabLine line = *this;
        line.ox -= place.x, line.oy -= place.y, line.oz -= place.z;
        return line;
    }

    // Whether the box is met between `from` and `limit`, and where first.
    template <class Low, class High>
    bool meets(const Low& low, const High& high, double from, double limit, double& near) const {
        const double x0 = (low[0] - ox) * ix, x1 = (high[0] - ox) * ix;
        const double y0 = (low[1] - oy) * iy, y1 = (high[1] - oy) * iy;
        const double z0 = (low[2] - oz) * iz, z1 = (high[2] - oz) * iz;
        double t0 = from, t1 = limit;
        narrow(x0, x1, t0, t1);
        narrow(y0, y1, t0, t1);
        narrow(z0, z1, t0, t1);
        near = t0;
        return t0 <= t1;
    }

    static double finite_inverse(double d) { return std::fabs(d) < 1e-300 ? std::copysign(1e300, d) : 1 / d; }

private:
    static void narrow(double a, double b, double& t0, double& t1) {
        constexpr double padding = 1 + 8 * 0x1p-52;
        const double first = a < b ? a : b, last = (a < b ? b : a) * padding;
        if (first > t0) t0 = first;
        if (last < t1) t1 = last;
    }
};

template <class Meets, class Limit, class Visit>
void Hierarchy::walk(Meets meets, Limit limit, Visit visit) const {
    if (nodes_.empty()) return;
    struct Entry {
        std::int32_t child;
        double near;
    };
    std::array<Entry, 128> stack;
    int size = 0;
    stack[size++] = {0, 0};
    while (size > 0) {
        const Entry entry = stack[--size];
        if (entry.near > limit()) continue;
        if (entry.child < 0) {
            visit(~entry.child);
            continue;
        }
        const Node& node = nodes_[entry.child];
        std::array<double, 2> near{};
        std::array<bool, 2> met{};
        for (int i = 0; i < 2; ++i) met[i] = node.child[i] != no_child && meets(node.low[i], node.high[i], near[i]);
        const int first = near[1] < near[0] ? 1 : 0;
        if (met[1 - first]) stack[size++] = {node.child[1 - first], near[1 - first]};
        if (met[first]) stack[size++] = {node.child[first], near[first]};
    }
}

template <class Visit>
void Hierarchy::for_each_along(const Point& origin, const Vector& direction, double limit, Visit visit) const {
    const SlabLine line(to_point(origin - anchor_), direction);
    walk([&](const auto& low, const auto& high, double& near) { return line.meets(low, high, 0, limit, near); },
         [&] { return limit; }, [&](std::int32_t item) { limit = visit(item); });
}

template <class Holds, class Visit>
void Hierarchy::for_each_where(Holds holds, Visit visit) const {
    if (nodes_.empty()) return;
    std::array<std::int32_t, 128> stack;
    int size = 0;
    stack[size++] = 0;
    while (size > 0) {
        const std::int32_t child = stack[--size];
        if (child < 0) {
            visit(~child);
            continue;
        }
        const Node& node = nodes_[child];
        for (int i = 0; i < 2; ++i)
            if (node.child[i] != no_child && holds(node.low[i], node.high[i])) stack[size++] = node.child[i];
    }
}

template <class Visit>
void Hierarchy::for_each_at(const Point& point, double slack, Visit visit) const {
    const Vector p = point - anchor_;
    const auto holds = [&](const auto& low, const auto& high) {
        return p.x >= low[0] - slack && p.x <= high[0] + slack && p.y >= low[1] - slack && p.y <= high[1] + slack &&
               p.z >= low[2] - slack && p.z <= high[2] + slack;
    };
    for_each_where(holds, visit);
}

template <class Visit>
void Hierarchy::for_each_overlapping(const Bounds& box, Visit visit) const {
    const Vector l = box.low - anchor_, h = box.high - anchor_;
    const auto overlaps = [&](const auto& low, const auto& high) {
        return h.x >= low[0] && l.x <= high[0] && h.y >= low[1] && l.y <= high[1] && h.z >= low[2] && l.z <= high[2];
    };
    for_each_where(overlaps, visit);
}

}  // namespace lapidary
