// SPDX-License-Identifier: MIT
//
// Noise and its gradient against exact rational arithmetic, in the form in which it was published: a cascade of
// conditions in place of the gradient table, dual numbers in place of the worked-out derivative.

#include "lapidary/noise.h"

#include <boost/multiprecision/cpp_int.hpp>
#include <random>

#include "support/catch.h"
#include "support/measurement.h"

namespace lapidary {

namespace {

using Rational = boost::multiprecision::cpp_rational;

// A value with its three derivatives.
struct Dual {
    Rational value, slope[3];
};

Dual constant(const Rational& value) { return {value, {0, 0, 0}}; }

Dual operator+(const Dual& a, const Dual& b) {
    Dual sum{a.value + b.value, {}};
    for (int i = 0; i < 3; ++i) sum.slope[i] = a.slope[i] + b.slope[i];
    return sum;
}
Dual operator*(const Dual& a, const Dual& b) {
    Dual product{a.value * b.value, {}};
    for (int i = 0; i < 3; ++i) product.slope[i] = a.value * b.slope[i] + a.slope[i] * b.value;
    return product;
}
Dual operator-(const Dual& a) { return constant(-1) * a; }

Dual fade(const Dual& t) { return t * t * t * (t * (t * constant(6) + constant(-15)) + constant(10)); }
Dual lerp(const Dual& t, const Dual& a, const Dual& b) { return a + t * (b + -a); }

Dual published_gradient(int hash, const Dual& x, const Dual& y, const Dual& z) {
    const int h = hash & 15;
    const Dual& u = h < 8 ? x : y;
    const Dual& v = h < 4 ? y : h == 12 || h == 14 ? x : z;
    return ((h & 1) == 0 ? u : -u) + ((h & 2) == 0 ? v : -v);
}

Dual published_noise(const double (&place)[3]) {
    const auto p = [](int i) { return static_cast<int>(noise_detail::published_permutation[i & 255]); };
    const Dual one = constant(1);
    int cell[3];
    Dual r[3];
    for (int i = 0; i < 3; ++i) {
        const double floor = std::floor(place[i]);
        cell[i] = static_cast<int>(floor - 256 * std::floor(floor / 256));
        r[i] = constant(Rational(place[i]) - Rational(floor));
        r[i].slope[i] = 1;
    }
    const auto &x = r[0], &y = r[1], &z = r[2];
    const auto corner = [&](int i, int j, int k) {
        const int hash = p(p(p(cell[0] + i) + cell[1] + j) + cell[2] + k);
        return published_gradient(hash, i ? x + -one : x, j ? y + -one : y, k ? z + -one : z);
    };
    const auto edge = [&](int j, int k) { return lerp(fade(x), corner(0, j, k), corner(1, j, k)); };
    const auto face = [&](int k) { return lerp(fade(y), edge(0, k), edge(1, k)); };
    return lerp(fade(z), face(0), face(1));
}

}  // namespace

TEST_CASE("noise and its gradient are exact to rounding") {
    std::mt19937_64 generator(11);
    std::uniform_real_distribution<double> coordinate(-300, 300);
    // The published polynomial of the fade loses up to 1.8e-15 next to 1, where 10 - 9 is left of its terms.
    test::Measurement values({"T77", "noise at random places", "value", 2e-15}), slopes({"T82", "its gradient", "slope", 1e-14});
    for (int i = 0; i < 300; ++i) {
        const double place[3] = {coordinate(generator), coordinate(generator), coordinate(generator)};
        const Dual exact = published_noise(place);
        const Point p{place[0], place[1], place[2]};
        const NoiseSample sample = noise_with_gradient(p);
        const auto error = [](double value, const Rational& truth) {
            return std::fabs(static_cast<double>(Rational(value) - truth));
        };
        values.record(error(noise(p), exact.value));
        values.record(error(sample.value, exact.value));
        slopes.record(error(sample.gradient.x, exact.slope[0]));
        slopes.record(error(sample.gradient.y, exact.slope[1]));
        slopes.record(error(sample.gradient.z, exact.slope[2]));
    }
}

}  // namespace lapidary
