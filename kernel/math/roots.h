// SPDX-License-Identifier: MIT
//
// Where a straight line runs inside the standard surfaces. Object plugins and the kernel, which meets a surface shared
// by several solids once for all of them, ask the same questions; the mathematics stands here once.
//
// Every line comes as LocalLine: closest + t direction, about its point closest to the surface's centre. From there the
// textbook formulas keep their digits at any distance of the eye; what is left to avoid is
//
//   - differences of squares of rounded lengths: of a distance that a root gave, r^2 - m^2 is taken as (r - m)(r + m), and of a
//     vector its squares are taken away one by one; the components of c = o x d, whose length is the distance from the centre
//     times |d|, are differences of products with one fma each (1.5 ulp, Kahan);
//   - squares that overflow or vanish: sizes and directions are first multiplied by powers of two that bring them near 1,
//     which rounds nothing.
//
// There is no tolerance anywhere. A line that only touches a surface has no length inside it: no span. A direction may
// have zeros; a line that never leaves a face, edge or generator counts as outside.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

#include "kernel/export.h"
#include "kernel/interfaces/object.h"
#include "kernel/math/vector.h"

namespace lapidary {

// The power of two that brings |x| into [1/2, 1), by arithmetic on the exponent's bits alone, so that loops over it
// vectorise. Of zero and of numbers below 2^-1022: a large one that still brings their squares out of reach of zero.
inline double normalizing_power_of_two(double x) {
    constexpr std::uint64_t exponent_mask = 0x7ff0'0000'0000'0000, bias_twice_less_one = 0x7fd0'0000'0000'0000;
    const double bounded = std::fabs(x) < 0x1p1021 ? std::fabs(x) : 0x1p1021;
    return std::bit_cast<double>(bias_twice_less_one - (std::bit_cast<std::uint64_t>(bounded) & exponent_mask));
}

// The larger of two magnitudes.
inline double larger_magnitude(double a, double b) { return std::fabs(a) > std::fabs(b) ? std::fabs(a) : std::fabs(b); }

// The ball |p| <= r. The line is given about m, its point closest to the centre, so m.d = 0, and |m + t d| = r at
//
//     t = -h and t = h,   h = sqrt((r^2 - m.m) / d.d).
//
// Taken away one by one, the squares lose 0.65 u r^2 (root mean square, near the rim; 3.7 u r^2 at most). The factored form,
// (r - |m|)(r + |m|), loses 1.06 (4.3) by the rounding of |m|, and takes another root.
inline Span ball_span(const LocalLine& line, double radius) {
    const double shrink = normalizing_power_of_two(radius);
    const Vector m = shrink * to_vector(line.closest);
    const double r = shrink * radius;
    const double chord = ((r * r - m.x * m.x) - m.y * m.y) - m.z * m.z;
    if (!(chord > 0)) return Span::none();

    const Vector& v = line.direction;
    const double slow = normalizing_power_of_two(larger_magnitude(v.x, larger_magnitude(v.y, v.z)));
    const Vector d = slow * v;
    const double h = std::sqrt(chord / dot(d, d)) * (slow * (1 / shrink));
    return {-h, h};
}

// The infinite cylinder x^2 + z^2 <= r^2. In the plane across the axis the line is o + t d, o = (x, z), and passes the
// axis at the distance |o x d| / |d|. It is inside where
//
//     t = (-o.d -+ sqrt((r |d| - |o x d|)(r |d| + |o x d|))) / d.d.
//
// Both products of two terms are differences of products, so the chord keeps its digits for lines nearly parallel to
// the axis. A parallel line is a point of that plane: it lies inside altogether, or not at all.
inline Span tube_span(const LocalLine& line, double radius) {
    const double shrink = normalizing_power_of_two(radius);
    const double slow = normalizing_power_of_two(larger_magnitude(line.direction.x, line.direction.z));
    const double ox = shrink * line.closest.x, oz = shrink * line.closest.z, r = shrink * radius;
    const double dx = slow * line.direction.x, dz = slow * line.direction.z;

    const double dd = dx * dx + dz * dz;
    const double reach = r * std::sqrt(dd), moment = std::fabs(difference_of_products(ox, dz, oz, dx));
    const double middle = -difference_of_products(ox, dx, -oz, dz);
    const bool is_met = moment < reach;
    const double half = std::sqrt(is_met ? (reach - moment) * (reach + moment) : 0);
    const double unit = slow * (1 / shrink) / dd;
    const double in = is_met ? (middle - half) * unit : infinity, out = is_met ? (middle + half) * unit : -infinity;

    // Along the axis a line lies inside altogether or not at all. Chosen instead of returned early, so that loops over lines stay
    // vector instructions.
    const double parallel_in = ox * ox + oz * oz < r * r ? -infinity : infinity;
    return {dd > 0 ? in : parallel_in, dd > 0 ? out : -parallel_in};
}

// The part of an axis between two values, low < o + t d < high: the rule of the slab. A line at rest on that axis lies
// inside altogether, or not at all; a d whose reciprocal would overflow counts as rest, which keeps 0 * infinity out.
inline Span slab_span(double origin, double direction, double low, double high) {
    const double above_low = low < origin ? -infinity : infinity, resting_in = origin < high ? above_low : infinity;
    const double pace = 1 / direction, a = (low - origin) * pace, b = (high - origin) * pace;
    const bool rests = std::fabs(direction) < 0x1p-1022;
    return {rests ? resting_in : (a < b ? a : b), rests ? -resting_in : (a < b ? b : a)};
}

// The half-space a x + b y + c z <= d. With n = (a, b, c) the line reaches the plane at t = (d - n.closest) / n.direction
// and is inside before it where it moves along n. A parallel line lies inside altogether or not at all.
inline Span half_space_span(const LocalLine& line, double a, double b, double c, double d) {
    const Vector n{a, b, c};
    const double gap = d - dot(line.closest, n), speed = dot(n, line.direction);
    if (speed > 0) return {-infinity, gap / speed};
    if (speed < 0) return {gap / speed, infinity};
    return gap > 0 ? Span::all() : Span::none();
}

// The double cone x^2 + z^2 <= (slope (apex - y))^2: what its nappes hold of the line, sorted; either may be empty, the
// outer ends may be infinite.
struct DoubleConePieces {
    Span first, second;
};

// In a space where the apex is the origin and heights are measured in units of 1/slope, the double cone is
// x^2 + z^2 <= y^2. With the form q(p, w) = px wx + pz wz - py wy, the line o + t d is inside where
//
//     A t^2 + 2 B t + C <= 0,   A = q(d, d),  B = q(o, d),  C = q(o, o),
//
// and A and C factor into differences of lengths. The discriminant needs no B at all:
//
//     B^2 - A C = cx^2 + cz^2 - cy^2,   c = o x d,
//
// which keeps its digits for lines that pass the apex as closely as doubles can tell. The roots are t = k / A and
// t = C / k with k = -(B + sign(B) sqrt(B^2 - A C)), which never subtracts; A = 0, a line parallel to a generator,
// sends the first of them to infinity, where it belongs.
//
// Where the discriminant is not above 0 the line touches the cone or passes through its apex: it lies in one piece on one
// side. (The roots are then taken and left unused: without branches, loops over this vectorise.)
//
// The cone is given by its slope and by slope (apex - y) at the height of the line's closest point: so given, a cylinder is
// the cone of slope 0.
inline DoubleConePieces double_cone_pieces(const LocalLine& line, double slope, double radius_at_closest) {
    Vector o{line.closest.x, -radius_at_closest, line.closest.z};
    Vector d{line.direction.x, slope * line.direction.y, line.direction.z};
    const double shrink = normalizing_power_of_two(larger_magnitude(o.x, larger_magnitude(o.y, o.z)));
    const double slow = normalizing_power_of_two(larger_magnitude(d.x, larger_magnitude(d.y, d.z)));
    o = shrink * o;
    d = slow * d;

    const auto form = [](const Vector& p) {
        const double across = std::sqrt(p.x * p.x + p.z * p.z), along = std::fabs(p.y);
        return (across - along) * (across + along);
    };
    const double a = form(d), b = o.x * d.x + o.z * d.z - o.y * d.y, constant = form(o), discriminant = form(cross(o, d));
    const double k = -(b + std::copysign(std::sqrt(discriminant), b)), unit = slow * (1 / shrink);
    const double one = k / a * unit, other = constant / k * unit;
    const double low = one < other ? one : other, high = one < other ? other : one;

    const double sense = a != 0 ? a : constant;
    if (!(discriminant > 0)) return {{sense < 0 ? -infinity : infinity, sense < 0 ? infinity : -infinity}, Span::none()};
    return {{a < 0 ? -infinity : low, a < 0 ? low : high}, {a < 0 ? high : infinity, a < 0 ? infinity : -infinity}};
}

// The same as a list: writes none, one or two spans and returns how many.
LAPIDARY_API int double_cone_spans(const LocalLine& line, double slope, double apex, Span out[2]);

// The torus (sqrt(x^2 + z^2) - major)^2 + y^2 <= minor^2. Writes none, one or two spans, sorted, and returns how many.
// Where minor > major the ring covers itself: the set is what lies within the outer skin.
LAPIDARY_API int torus_spans(const LocalLine& line, double major, double minor, Span out[2]);

}  // namespace lapidary
