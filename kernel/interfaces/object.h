// SPDX-License-Identifier: MIT
//
// The interface of a solid: a closed set of points in its own space, asked where a line runs inside it.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "kernel/export.h"
#include "kernel/math/bounds.h"
#include "kernel/math/vector.h"

namespace lapidary {

// A line in an object's own space, given about its point closest to the origin: closest . direction = 0 to rounding.
// Positions on it are closest + t direction; t counts from the closest point. The direction is not of unit length
// (it is the world's unit direction taken into the object's space, so that t is a length in the world).
struct LocalLine {
    Point closest;
    Vector direction;

    Point at(double t) const {
        return {fused_multiply_add(t, direction.x, closest.x), fused_multiply_add(t, direction.y, closest.y),
                fused_multiply_add(t, direction.z, closest.z)};
    }
};

// A piece of a line inside a solid: in <= t < out. Either end may be infinite.
struct Span {
    double in = infinity, out = -infinity;

    static Span none() { return {}; }
    static Span all() { return {-infinity, infinity}; }
    bool is_empty() const { return !(in < out); }
};

inline Span intersect(const Span& a, const Span& b) { return {a.in > b.in ? a.in : b.in, a.out < b.out ? a.out : b.out}; }

// What crosses the boundary for a batch of lines at once: plain arrays, so that libraries built for different instruction
// sets fit together.
inline constexpr int batch_size = 16;

// 2^i for lane i, as sets of lanes are written. Sums of these over the lanes that something holds for become vector instructions;
// shifts do not.
inline constexpr std::array<std::int64_t, batch_size> bits_of_lanes = [] {
    std::array<std::int64_t, batch_size> bits{};
    for (std::size_t i = 0; i < bits.size(); ++i) bits[i] = std::int64_t{1} << i;
    return bits;
}();
constexpr std::int64_t bit_of(int lane) { return bits_of_lanes[static_cast<std::size_t>(lane)]; }

// Calls f(lane) for each lane of a set.
template <class F>
void for_each_lane(unsigned lanes, const F& f) {
    for (unsigned rest = lanes; rest != 0; rest &= rest - 1) f(std::countr_zero(rest));
}

struct alignas(64) LineBatch {
    double closest_x[batch_size], closest_y[batch_size], closest_z[batch_size];
    double direction_x[batch_size], direction_y[batch_size], direction_z[batch_size];

    LocalLine line(int lane) const {
        return {{closest_x[lane], closest_y[lane], closest_z[lane]}, {direction_x[lane], direction_y[lane], direction_z[lane]}};
    }
};

struct alignas(64) PointBatch {
    double x[batch_size], y[batch_size], z[batch_size];

    Point point(int lane) const { return {x[lane], y[lane], z[lane]}; }
    void set(int lane, const Point& p) { x[lane] = p.x, y[lane] = p.y, z[lane] = p.z; }
};

struct alignas(64) NormalBatch {
    double x[batch_size], y[batch_size], z[batch_size];

    void set(int lane, const Normal& n) { x[lane] = n.x, y[lane] = n.y, z[lane] = n.z; }
};

struct alignas(64) SpanBatch {
    double in[batch_size], out[batch_size];  // empty: in >= out
};

// A point of a solid's boundary, in its own space.
struct Hit {
    Point local;
    int face = 0;  // as face() numbers them
};

// A face as a known surface, so that faces of different solids that lie on the same surface are recognised before
// rendering and met at the same t, bit for bit. The solid is what lies inside all of its surfaces.
struct Surface {
    enum class Kind {
        plane,     // a x + b y + c z <= d, with (a, b, c) of any length
        sphere,    // |p| <= a
        cylinder,  // x^2 + z^2 <= a^2
        cone,      // x^2 + z^2 <= (a (b - y))^2: slope a, apex at y = b; both nappes
        torus      // (sqrt(x^2 + z^2) - a)^2 + y^2 <= b^2
    };
    Kind kind = Kind::plane;
    double a = 0, b = 0, c = 0, d = 0;

    static Surface plane(double a, double b, double c, double d) { return {Kind::plane, a, b, c, d}; }
    static Surface sphere(double radius) { return {Kind::sphere, radius, 0, 0, 0}; }
    static Surface cylinder(double radius) { return {Kind::cylinder, radius, 0, 0, 0}; }
    static Surface cone(double slope, double apex) { return {Kind::cone, slope, apex, 0, 0}; }
    static Surface torus(double major, double minor) { return {Kind::torus, major, minor, 0, 0}; }
};
using Surfaces = std::vector<Surface>;

class LAPIDARY_API Object {
public:
    Object() = default;
    Object(const Object&) = delete;
    Object& operator=(const Object&) = delete;
    virtual ~Object();

    // A box around the solid in its own space; infinite where the solid is.
    virtual Bounds bounds() const = 0;

    // The most spans a line can have: 1 for a convex solid, 2 for a torus.
    virtual int max_spans() const { return 1; }

    // Where the line runs inside: sorted, disjoint, none empty. Writes at most max_spans(), returns how many.
    // A line that only touches the solid has no length inside it: no span.
    virtual int spans(const LocalLine& line, Span* out) const = 0;

    // The same for the first `count` lanes of a batch, lane by lane: spans of rank k of all lanes stand in out[k];
    // lanes with fewer have empty ones. The default asks spans() for each lane.
    virtual void spans_batch(const LineBatch& lines, int count, SpanBatch* out) const;

    // Which face a local point of the boundary belongs to, the nearest one; faces count from 0 in the order of surfaces().
    virtual int face(const Point& local) const;

    // The outward normal at a point of a face, of any length; the same all over a face that is a plane.
    virtual Normal normal(const Hit& hit) const = 0;

    // The normals at the first `count` points of a batch, each of the face nearest to it. The default asks face() and
    // normal() for each lane.
    virtual void normals_batch(const PointBatch& points, int count, NormalBatch* out) const;

    // The solid's faces as known surfaces, or nothing where they are of another kind.
    virtual Surfaces surfaces() const;

    // A surface without inside (a plane of thickness 0): visible from both sides, opaque to shadows. spans() then
    // gives one span with in == out where the line crosses it.
    virtual bool is_sheet() const { return false; }
};

}  // namespace lapidary
