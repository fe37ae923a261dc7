// SPDX-License-Identifier: MIT
#include "kernel/render/medium.h"

#include <algorithm>
#include <array>
#include <optional>

namespace lapidary {

namespace {

double largest_component(const Point& p) { return std::max({std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)}); }

// What is left of light after a length of uniform matter. Colour 1 lets everything through, however long the way.
Colour transmittance(const Matter& matter, double length) {
    const auto channel = [&](double c) { return c >= 1 ? 1.0 : std::pow(std::fmax(c, 0), length / matter.depth); };
    return {channel(matter.colour.r), channel(matter.colour.g), channel(matter.colour.b)};
}

// The absorption per length, as a colour; opaque matter counts as clear here, its faces stop the ray.
Colour absorption(const Material& material, const MaterialLine& line, double t) {
    const Matter matter = material.evaluate({line.at(t), 0});
    if (!matter.is_transparent()) return Colour::black();
    const auto channel = [&](double c) { return c >= 1 ? 0.0 : -std::log(std::fmax(c, 1e-300)) / matter.depth; };
    return {channel(matter.colour.r), channel(matter.colour.g), channel(matter.colour.b)};
}

// The places of Gauss-Legendre integration with five points on [-1, 1].
constexpr std::array<double, 5> nodes{0, -0.5384693101056831, 0.5384693101056831, -0.9061798459386640, 0.9061798459386640};

// The matter of a piece between two boundaries, if it is the same at all five places: then it is taken to be so all along,
// which is the rule, and nothing has to be integrated.
std::optional<Matter> common_matter(const Material& material, const MaterialLine& line, double t0, double t1) {
    const double middle = 0.5 * (t0 + t1), half = 0.5 * (t1 - t0);
    const Matter first = material.evaluate({line.at(middle), 0});
    for (std::size_t i = 1; i < nodes.size(); ++i) {
        const Matter other = material.evaluate({line.at(middle + half * nodes[i]), 0});
        if (!(other.colour == first.colour) || other.depth != first.depth || other.is_transparent() != first.is_transparent())
            return std::nullopt;
    }
    return first;
}

Colour integrate_once(const Material& material, const MaterialLine& line, double t0, double t1) {
    constexpr std::array<double, 5> weights{0.5688888888888889, 0.4786286704993665, 0.4786286704993665, 0.2369268850561891,
                                            0.2369268850561891};
    const double middle = 0.5 * (t0 + t1), half = 0.5 * (t1 - t0);
    Colour sum;
    for (std::size_t i = 0; i < nodes.size(); ++i) sum += weights[i] * absorption(material, line, middle + half * nodes[i]);
    return half * sum;
}

// Halves the stretch until two halves agree with the whole.
Colour integrate(const Material& material, const MaterialLine& line, double t0, double t1, const Colour& whole, int depth) {
    const double middle = 0.5 * (t0 + t1);
    const Colour left = integrate_once(material, line, t0, middle), right = integrate_once(material, line, middle, t1);
    const Colour sum = left + right, change = sum - whole;
    const double apart = std::max({std::fabs(change.r), std::fabs(change.g), std::fabs(change.b)});
    if (depth == 0 || apart <= 1e-12 + 1e-11 * largest(sum)) return sum;
    return integrate(material, line, t0, middle, left, depth - 1) + integrate(material, line, middle, t1, right, depth - 1);
}

}  // namespace

Matter matter_beside(const MaterialInstance& instance, const MatterSite& site, const Vector& toward) {
    if (instance.is_uniform()) return instance.matter();
    const Transform& placement = instance.placement();
    const Matrix3& inverse = placement.inverse_linear();
    const TwoPartVector from_centre = site.point - placement.centre();
    const double footprint = site.footprint * instance.scale();
    const auto beside = placement.has_identity_linear() ? point_beside<true, true>
                        : placement.keeps_shapes()      ? point_beside<false, true>
                                                        : point_beside<false, false>;
    const Point point = beside(from_centre, footprint, toward, inverse, instance.scale());
    return instance.material().evaluate({point, footprint});
}

// Apart is measured across the boundary, not along the line: rounding moves a point by some ulps, and on a line that grazes the
// boundary this moves the crossing by many times as much.
Crossing next_crossing(const Material& material, const MaterialLine& line, double t0, double t1) {
    for (double from = t0;;) {
        const Crossing crossing = material.next_boundary(line, from, t1);
        if (!(crossing.t < t1)) return {};
        const double rounding =
            0x1p-44 * (std::max(largest_component(line.origin), largest_component(line.at(crossing.t))) + 0x1p-10);
        const double slope = std::fabs(dot(normalize(crossing.normal), line.direction));
        if ((crossing.t - t0) * slope > rounding && (t1 - crossing.t) * slope > rounding) return crossing;
        from = crossing.t;
    }
}

// A line that comes from afar has lost digits of the crossing: a line about the point found finds them again.
TwoPartPoint crossing_point(const MaterialInstance& instance, const TwoPartPoint& origin, const Vector& direction, double t) {
    const TwoPartPoint found{origin.anchor, origin.offset + t * direction};
    const TwoPartVector rest = found - TwoPartPoint(found.rounded());
    const TwoPartPoint nearby{found.rounded(), rest.hi + rest.lo};
    const MaterialLine line = material_line(instance, nearby, direction);
    if (t * length(line.direction) < 16 * (largest_component(line.origin) + 0x1p-10)) return found;
    const double lost = 0x1p-48 * t;
    const Crossing again = instance.material().next_boundary(line, -lost, lost);
    return again.t < lost ? TwoPartPoint{nearby.anchor, nearby.offset + again.t * direction} : found;
}

Colour transmittance(const MaterialInstance& instance, const MaterialLine& line, double t0, double t1) {
    if (instance.is_uniform()) return transmittance(instance.matter(), t1 - t0);
    if (t1 == infinity) return transmittance(instance.material().evaluate({line.at(t0), 0}), infinity);
    if (const auto matter = common_matter(instance.material(), line, t0, t1))
        return matter->is_transparent() ? transmittance(*matter, t1 - t0) : Colour::white();
    const Colour whole = integrate_once(instance.material(), line, t0, t1);
    const Colour depth = integrate(instance.material(), line, t0, t1, whole, 20);
    return {std::exp(-depth.r), std::exp(-depth.g), std::exp(-depth.b)};
}

}  // namespace lapidary
