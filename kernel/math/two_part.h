// SPDX-License-Identifier: MIT
//
// Numbers of twice the precision: an unevaluated sum hi + lo of two doubles with |lo| <= ulp(hi)/2.
// The error-free transformations are Knuth's TwoSum and Dekker's TwoProduct.
#pragma once

#include <cmath>

#include "kernel/math/vector.h"

namespace lapidary {

struct TwoPart {
    double hi = 0, lo = 0;

    TwoPart() = default;
    TwoPart(double value) : hi(value) {}  // NOLINT: a double is a two-part number
    TwoPart(double h, double l) : hi(h), lo(l) {}
    explicit operator double() const { return hi + lo; }
};

// a + b exactly.
inline TwoPart two_sum(double a, double b) {
    const double sum = a + b;
    const double part = sum - a;
    return {sum, (a - (sum - part)) + (b - part)};
}

// a + b exactly, where |a| >= |b|.
inline TwoPart quick_two_sum(double a, double b) {
    const double sum = a + b;
    return {sum, b - (sum - a)};
}

// a - b exactly.
inline TwoPart two_difference(double a, double b) { return two_sum(a, -b); }

// a * b exactly.
inline TwoPart two_product(double a, double b) {
    const double product = a * b;
    return {product, product_error(a, b, product)};
}

inline TwoPart operator-(const TwoPart& a) { return {-a.hi, -a.lo}; }

inline TwoPart operator+(const TwoPart& a, const TwoPart& b) {
    TwoPart s = two_sum(a.hi, b.hi);
    TwoPart t = two_sum(a.lo, b.lo);
    s.lo += t.hi;
    s = quick_two_sum(s.hi, s.lo);
    s.lo += t.lo;
    return quick_two_sum(s.hi, s.lo);
}
inline TwoPart operator-(const TwoPart& a, const TwoPart& b) { return a + (-b); }

inline TwoPart operator*(const TwoPart& a, const TwoPart& b) {
    TwoPart p = two_product(a.hi, b.hi);
    p.lo += a.hi * b.lo + a.lo * b.hi;
    return quick_two_sum(p.hi, p.lo);
}

inline TwoPart operator/(const TwoPart& a, const TwoPart& b) {
    const double q1 = a.hi / b.hi;
    TwoPart r = a - b * TwoPart(q1);
    const double q2 = r.hi / b.hi;
    r = r - b * TwoPart(q2);
    const double q3 = r.hi / b.hi;
    return quick_two_sum(q1, q2) + TwoPart(q3);
}

// A place given as anchor + offset, so that a point near a far-away surface keeps its digits.
struct TwoPartPoint {
    Point anchor;
    Vector offset;

    TwoPartPoint() = default;
    TwoPartPoint(const Point& p) : anchor(p) {}  // NOLINT: a point is a two-part point
    TwoPartPoint(const Point& p, const Vector& v) : anchor(p), offset(v) {}
    Point rounded() const { return anchor + offset; }
};

// from + t v. Its anchor is what one double for each coordinate holds best, its offset the rest, to about u^2 |from|.
inline TwoPartPoint point_along(const TwoPartPoint& from, double t, const Vector& v) {
    const auto along = [t](double anchor, double offset, double component) {
        return two_sum(anchor, offset) + two_product(t, component);
    };
    const TwoPart x = along(from.anchor.x, from.offset.x, v.x);
    const TwoPart y = along(from.anchor.y, from.offset.y, v.y);
    const TwoPart z = along(from.anchor.z, from.offset.z, v.z);
    return {{x.hi, y.hi, z.hi}, {x.lo, y.lo, z.lo}};
}

// a - b, exact in its first part and with what was lost in its second.
struct TwoPartVector {
    Vector hi, lo;
};

inline TwoPartVector operator-(const TwoPartPoint& a, const TwoPartPoint& b) {
    const TwoPart x = two_difference(a.anchor.x, b.anchor.x);
    const TwoPart y = two_difference(a.anchor.y, b.anchor.y);
    const TwoPart z = two_difference(a.anchor.z, b.anchor.z);
    return {{x.hi, y.hi, z.hi}, Vector{x.lo, y.lo, z.lo} + (a.offset - b.offset)};
}

}  // namespace lapidary
