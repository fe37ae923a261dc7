// SPDX-License-Identifier: MIT
#include "stress/exact.h"

#include <algorithm>

namespace lapidary::test {

Exact evaluate(const Polynomial& p, const Exact& t) {
    Exact value = 0;
    for (auto c = p.rbegin(); c != p.rend(); ++c) value = value * t + *c;
    return value;
}

namespace {

Polynomial derivative(const Polynomial& p) {
    Polynomial d;
    for (std::size_t i = 1; i < p.size(); ++i) d.push_back(Exact(static_cast<int>(i)) * p[i]);
    return d;
}

Exact bisect(const Polynomial& p, Exact low, Exact high) {
    const bool negative_low = evaluate(p, low) < 0;
    for (int i = 0; i < 190; ++i) {
        const Exact middle = (low + high) / 2;
        ((evaluate(p, middle) < 0) == negative_low ? low : high) = middle;
    }
    return (low + high) / 2;
}

Polynomial multiply(const Polynomial& a, const Polynomial& b) {
    Polynomial product(a.size() + b.size() - 1, Exact(0));
    for (std::size_t i = 0; i < a.size(); ++i)
        for (std::size_t j = 0; j < b.size(); ++j) product[i + j] += a[i] * b[j];
    return product;
}

}  // namespace

// Between neighbouring roots of the derivative a polynomial is monotone: one bisection finds its one sign change.
std::vector<Exact> sign_changes(const Polynomial& p, const Exact& low, const Exact& high) {
    if (p.size() < 2) return {};
    std::vector<Exact> stops{low};
    for (const Exact& t : sign_changes(derivative(p), low, high)) stops.push_back(t);
    stops.push_back(high);
    std::vector<Exact> roots;
    for (std::size_t i = 1; i < stops.size(); ++i)
        if ((evaluate(p, stops[i - 1]) < 0) != (evaluate(p, stops[i]) < 0)) roots.push_back(bisect(p, stops[i - 1], stops[i]));
    return roots;
}

std::vector<Exact> quadratic_roots(const Polynomial& p) {
    const Exact discriminant = p[1] * p[1] - 4 * p[0] * p[2];
    if (p[2] == 0 || discriminant <= 0) return {};
    const Exact root = sqrt(discriminant);
    std::vector<Exact> roots{(-p[1] - root) / (2 * p[2]), (-p[1] + root) / (2 * p[2])};
    std::sort(roots.begin(), roots.end());
    return roots;
}

Polynomial sphere_polynomial(const ExactVector& o, const ExactVector& d, double radius) {
    return {dot(o, o) - Exact(radius) * radius, 2 * dot(o, d), dot(d, d)};
}

Polynomial cylinder_polynomial(const ExactVector& o, const ExactVector& d, double radius) {
    return {o.x * o.x + o.z * o.z - Exact(radius) * radius, 2 * (o.x * d.x + o.z * d.z), d.x * d.x + d.z * d.z};
}

Polynomial cone_polynomial(const ExactVector& o, const ExactVector& d, double slope, double apex) {
    const Exact square = Exact(slope) * slope, y = o.y - apex;
    return {o.x * o.x + o.z * o.z - square * y * y, 2 * (o.x * d.x + o.z * d.z - square * y * d.y),
            d.x * d.x + d.z * d.z - square * d.y * d.y};
}

Polynomial torus_polynomial(const ExactVector& o, const ExactVector& d, double major, double minor) {
    const Exact ring = Exact(major) * major, tube = Exact(minor) * minor;
    const Polynomial square_distance{dot(o, o) + ring - tube, 2 * dot(o, d), dot(d, d)};
    const Polynomial across{o.x * o.x + o.z * o.z, 2 * (o.x * d.x + o.z * d.z), d.x * d.x + d.z * d.z};
    Polynomial p = multiply(square_distance, square_distance);
    for (std::size_t i = 0; i < across.size(); ++i) p[i] -= 4 * ring * across[i];
    return p;
}

Recentred recentre(const Point& origin, const Vector& direction) {
    const double a = dot(direction, direction);
    const LocalLine raw{origin, direction};
    const double shift = -dot(origin, direction) / a;
    const LocalLine near{raw.at(shift), direction};
    const double correction = -dot(near.closest, direction) / a;
    return {{near.at(correction), direction}, shift, correction};
}

Vector Random::direction() {
    for (;;) {
        const Vector v{uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)};
        const double square = dot(v, v);
        if (square > 0.01 && square < 1) return normalize(v);
    }
}

LocalLine Random::line(double distance) {
    const Vector d = direction();
    return recentre(to_point(uniform(0, distance) * normalize(cross(d, direction()))), d).line;
}

}  // namespace lapidary::test
