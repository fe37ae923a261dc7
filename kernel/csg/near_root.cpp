// SPDX-License-Identifier: MIT
#include "kernel/csg/near_root.h"

#include <array>
#include <limits>

namespace lapidary {

namespace {

using TwoPartTriple = std::array<TwoPart, 3>;

constexpr double no_root = std::numeric_limits<double>::quiet_NaN();

TwoPart square(const TwoPart& x) { return x * x; }

// A surface's equation at one point: its value, and its gradient as far as Newton's method needs it.
struct Equation {
    TwoPart value;
    Vector gradient;
};

// sum of q_i p_i^2 - right
Equation quadric(const TwoPartTriple& p, const std::array<double, 3>& q, const TwoPart& right) {
    Equation at{-right, {2 * q[0] * p[0].hi, 2 * q[1] * p[1].hi, 2 * q[2] * p[2].hi}};
    for (int i = 0; i < 3; ++i)
        if (q[i] != 0) at.value = at.value + q[i] * square(p[i]);
    return at;
}

// (|p|^2 + R^2 - r^2)^2 - 4 R^2 (x^2 + z^2)
Equation torus(const TwoPartTriple& p, double major, double minor) {
    const TwoPart sum = quadric(p, {1, 1, 1}, square(minor) - square(major)).value;
    const TwoPart across = square(p[0]) + square(p[2]);
    const double all = 4 * sum.hi, ring = 8 * major * major;
    return {square(sum) - 4.0 * square(major) * across, {(all - ring) * p[0].hi, all * p[1].hi, (all - ring) * p[2].hi}};
}

Equation equation_at(const Surface& s, const TwoPartTriple& p) {
    switch (s.kind) {
        case Surface::Kind::plane:
            return {p[0] * s.a + p[1] * s.b + p[2] * s.c - s.d, {s.a, s.b, s.c}};
        case Surface::Kind::sphere:
            return quadric(p, {1, 1, 1}, square(s.a));
        case Surface::Kind::cylinder:
            return quadric(p, {1, 0, 1}, square(s.a));
        case Surface::Kind::cone: {
            const TwoPart below_apex = TwoPart(s.b) - p[1];
            Equation at = quadric(p, {1, 0, 1}, square(s.a * below_apex));
            at.gradient.y = 2 * s.a * s.a * below_apex.hi;
            return at;
        }
        case Surface::Kind::torus:
            return torus(p, s.a, s.b);
    }
    return {};
}

// The ray in the surfaces' space, every coordinate in two parts.
struct TwoPartLine {
    TwoPartTriple origin, direction;

    TwoPartLine(const Ray& ray, const Transform& placement)
        : origin(placement.to_local_two_part(ray.origin)), direction(placement.to_local_two_part(ray.direction)) {}

    TwoPartTriple at(double t) const {
        return {origin[0] + direction[0] * t, origin[1] + direction[1] * t, origin[2] + direction[2] * t};
    }
};

// NaN where Newton's method finds no root of this surface near t that the line passes as asked. It begins a rounding away from
// the root, at the point `there`: three steps come to rest, where the rounding of the two-part value lets it move no further. Of
// a plane the first one tells already whether the root is farther off than `most`.
double root_of(const Surface& surface, const TwoPartLine& line, double t, const TwoPartTriple& there, double most,
               Passing passing) {
    constexpr int most_steps = 4;
    const Vector direction{line.direction[0].hi, line.direction[1].hi, line.direction[2].hi};
    const bool is_plane = surface.kind == Surface::Kind::plane;
    for (int i = 0; i < most_steps; ++i) {
        const Equation at = equation_at(surface, i == 0 ? there : line.at(t));
        const double slope = dot(at.gradient, direction);
        if (passing != Passing::either && (slope < 0) != (passing == Passing::in)) return no_root;
        const double step = at.value.hi / slope;
        if (is_plane && !(std::fabs(step) <= 2 * most)) return no_root;
        t -= step;
        if (!(std::fabs(step) > 0x1p-51 * std::fabs(t))) break;
    }
    return t;
}

}  // namespace

double near_root(const Ray& ray, const Transform& placement, std::span<const Surface> surfaces, double t, double anchor,
                 Passing passing) {
    const TwoPartLine line(ray, placement);
    const TwoPartTriple there = line.at(t);
    double nearest = t, least = most_rounding * std::fabs(anchor);
    for (const Surface& surface : surfaces) {
        const double root = root_of(surface, line, t, there, least, passing);
        const double distance = std::fabs(root - t);
        if (distance <= least) nearest = root, least = distance;
    }
    return nearest;
}

}  // namespace lapidary
