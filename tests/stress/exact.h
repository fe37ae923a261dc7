// SPDX-License-Identifier: MIT
//
// The oracle of the stress tests: the same geometry on the same doubles in 200-bit arithmetic, by textbook formulas that
// share nothing with the code under test.
#pragma once

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <random>
#include <vector>

#include "kernel/interfaces/object.h"
#include "kernel/math/vector.h"

namespace lapidary::test {

using Exact = boost::multiprecision::number<boost::multiprecision::cpp_bin_float<200, boost::multiprecision::digit_base_2>,
                                            boost::multiprecision::et_off>;

// The unit of rounding: half the distance from 1 to the next double.
inline constexpr double u = 0x1p-53;

struct ExactVector {
    Exact x, y, z;

    ExactVector(const Vector& v) : x(v.x), y(v.y), z(v.z) {}
    ExactVector(const Point& p) : x(p.x), y(p.y), z(p.z) {}
    ExactVector(Exact px, Exact py, Exact pz) : x(std::move(px)), y(std::move(py)), z(std::move(pz)) {}
};
inline Exact dot(const ExactVector& a, const ExactVector& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline ExactVector at(const ExactVector& o, const ExactVector& d, const Exact& t) {
    return {o.x + t * d.x, o.y + t * d.y, o.z + t * d.z};
}

// A polynomial by its coefficients, the constant one first.
using Polynomial = std::vector<Exact>;
Exact evaluate(const Polynomial& p, const Exact& t);
// All places in [low, high] where the polynomial changes sign, sorted.
std::vector<Exact> sign_changes(const Polynomial& p, const Exact& low, const Exact& high);
// The roots of a quadratic with two different ones, sorted; nothing otherwise.
std::vector<Exact> quadratic_roots(const Polynomial& p);

// Along o + t d: the sphere |p| = r, the cylinder x^2 + z^2 = r^2, the double cone x^2 + z^2 = (slope (apex - y))^2 and the
// torus with its inner skin, as polynomials in t that are negative inside.
Polynomial sphere_polynomial(const ExactVector& o, const ExactVector& d, double radius);
Polynomial cylinder_polynomial(const ExactVector& o, const ExactVector& d, double radius);
Polynomial cone_polynomial(const ExactVector& o, const ExactVector& d, double slope, double apex);
Polynomial torus_polynomial(const ExactVector& o, const ExactVector& d, double major, double minor);

// A line about its point closest to the origin, and where on the original line that is, in two parts.
struct Recentred {
    LocalLine line;
    double shift, correction;

    double t(double local) const { return shift + (correction + local); }
};
Recentred recentre(const Point& origin, const Vector& direction);

// Random numbers for all tests of the folder, the same in every run.
class Random {
public:
    explicit Random(unsigned seed) : engine_(seed) {}
    double uniform(double low, double high) { return low + (high - low) * unit_(engine_); }
    // A unit vector.
    Vector direction();
    // Of any size between two powers of ten.
    double magnitude(double low_exponent, double high_exponent) { return std::pow(10, uniform(low_exponent, high_exponent)); }
    // A line about its point closest to the origin, at most `distance` from it; the direction is of unit length.
    LocalLine line(double distance);

private:
    std::mt19937_64 engine_;
    std::uniform_real_distribution<double> unit_{0, 1};
};

}  // namespace lapidary::test
