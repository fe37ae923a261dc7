// SPDX-License-Identifier: MIT
//
// The three kinds of triple that geometry needs, kept apart by the type system:
// a Point is a place, a Vector is a way from one place to another, a Normal is a
// direction that stands on a surface and transforms with the inverse transpose.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "kernel/math/fused.h"

namespace lapidary {

inline constexpr double infinity = std::numeric_limits<double>::infinity();

struct Vector {
    double x = 0, y = 0, z = 0;
};

struct Point {
    double x = 0, y = 0, z = 0;
};

struct Normal {
    double x = 0, y = 0, z = 0;

    Normal() = default;
    Normal(double nx, double ny, double nz) : x(nx), y(ny), z(nz) {}
    // A normal has no length of its own: any vector that stands on the surface will do.
    explicit Normal(const Vector& v) : x(v.x), y(v.y), z(v.z) {}
    // The outward direction at a point of a surface whose level sets are centred on the origin.
    explicit Normal(const Point& p) : x(p.x), y(p.y), z(p.z) {}
};

inline Vector operator+(const Vector& a, const Vector& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Vector operator-(const Vector& a, const Vector& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Vector operator-(const Vector& v) { return {-v.x, -v.y, -v.z}; }
inline Vector operator*(double s, const Vector& v) { return {s * v.x, s * v.y, s * v.z}; }
inline Vector operator*(const Vector& v, double s) { return s * v; }
inline Vector operator/(const Vector& v, double s) { return {v.x / s, v.y / s, v.z / s}; }
inline bool operator==(const Vector& a, const Vector& b) { return a.x == b.x && a.y == b.y && a.z == b.z; }

inline Point operator+(const Point& p, const Vector& v) { return {p.x + v.x, p.y + v.y, p.z + v.z}; }
inline Point operator-(const Point& p, const Vector& v) { return {p.x - v.x, p.y - v.y, p.z - v.z}; }
inline Vector operator-(const Point& a, const Point& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline bool operator==(const Point& a, const Point& b) { return a.x == b.x && a.y == b.y && a.z == b.z; }

inline Normal operator-(const Normal& n) { return {-n.x, -n.y, -n.z}; }
inline bool operator==(const Normal& a, const Normal& b) { return a.x == b.x && a.y == b.y && a.z == b.z; }

inline Vector to_vector(const Point& p) { return {p.x, p.y, p.z}; }
inline Vector to_vector(const Normal& n) { return {n.x, n.y, n.z}; }
inline Point to_point(const Vector& v) { return {v.x, v.y, v.z}; }

inline double dot(const Vector& a, const Vector& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline double dot(const Normal& a, const Vector& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline double dot(const Vector& a, const Normal& b) { return dot(b, a); }
inline double dot(const Normal& a, const Normal& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline double dot(const Point& p, const Vector& v) { return p.x * v.x + p.y * v.y + p.z * v.z; }

// ab - cd to 1.5 ulp (Kahan): the fma recovers what the rounding of cd took away.
inline double difference_of_products(double a, double b, double c, double d) {
    const double cd = c * d;
    const double lost = product_error(-c, d, -cd);
    return fused_multiply_add(a, b, -cd) + lost;
}

inline Vector cross(const Vector& a, const Vector& b) {
    return {difference_of_products(a.y, b.z, a.z, b.y), difference_of_products(a.z, b.x, a.x, b.z),
            difference_of_products(a.x, b.y, a.y, b.x)};
}

inline double length_squared(const Vector& v) { return dot(v, v); }
inline double length(const Vector& v) { return std::sqrt(dot(v, v)); }
// The distance of a point from the origin of its space.
inline double length(const Point& p) { return std::sqrt(p.x * p.x + p.y * p.y + p.z * p.z); }

// Of the coordinates.
template <class Triple>
double largest_magnitude(const Triple& t) {
    const double x = std::fabs(t.x), y = std::fabs(t.y), z = std::fabs(t.z);
    const double larger = x > y ? x : y;
    return larger > z ? larger : z;
}

// The exponent of a positive size as it stands in a double's bits; kept away from where its inverse's would leave them. Without a
// branch, so that a loop over lanes stays vector instructions.
inline std::int64_t exponent_bits(double size) {
    constexpr std::int64_t smallest = 1, largest = 2045;
    const std::int64_t exponent = (std::bit_cast<std::int64_t>(size) >> 52) & 2047;
    const std::int64_t not_small = exponent > smallest ? exponent : smallest;
    return not_small < largest ? not_small : largest;
}
// The power of two that brings a positive size to about 1, and the one that brings it back. Multiplying by them rounds nothing.
inline double scale_to_one(double size) { return std::bit_cast<double>((2046 - exponent_bits(size)) << 52); }
inline double scale_from_one(double size) { return std::bit_cast<double>(exponent_bits(size) << 52); }

// The unit vector along v. Scaled by a power of two first, so that neither 1e-300 nor 1e300 is lost;
// the zero vector stays zero, and so does what is not finite.
inline Vector normalize(const Vector& v) {
    const double largest = largest_magnitude(v);
    const Vector scaled = scale_to_one(largest) * v;
    const double length_of_scaled = length(scaled);
    const bool has_direction = largest > 0 && length_of_scaled < infinity;
    const Vector unit = scaled / length_of_scaled;
    return {has_direction ? unit.x : 0, has_direction ? unit.y : 0, has_direction ? unit.z : 0};
}

inline Normal normalize(const Normal& n) { return Normal(normalize(to_vector(n))); }

// A vector as where it points to and how long it is. With one division in place of normalize()'s three: what matters where it is
// asked for each ray. The direction may be an ulp longer or shorter than a unit vector, also along an axis.
struct Heading {
    Vector direction;  // of the zero vector and of what is not finite: zero
    double distance;
    double inverse_distance;  // infinite for the zero vector
};

inline Heading heading_along(const Vector& v) {
    const double largest = largest_magnitude(v), scale = scale_to_one(largest);
    const Vector scaled = scale * v;
    const double distance = length(scaled), inverse = 1 / distance;
    const bool has_direction = largest > 0 && distance < infinity;
    return {
        {has_direction ? inverse * scaled.x : 0, has_direction ? inverse * scaled.y : 0, has_direction ? inverse * scaled.z : 0},
        distance * scale_from_one(largest),
        inverse * scale};
}

}  // namespace lapidary
