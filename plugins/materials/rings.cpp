// SPDX-License-Identifier: MIT
//
// rings: concentric shells of unit thickness, dealt alternately to two materials. Every plane through the centre shows
// rings.
//
// The shells are spheres about the origin, or cylinders about an axis: then the component along the axis is left out of
// the radius.

#include <lapidary/plugin.h>

namespace lapidary {

class Rings final : public BatchedSelection<Rings> {
public:
    static void describe(Schema<Rings>& schema) {
        schema.summary("Concentric shells of two materials, of unit thickness.");
        schema.add("axis", &Rings::axis_, {"none", "x", "y", "z"})
            .help("Cylinders about this axis, as in wood; none: spheres about the origin.");
        schema.child("even", &Rings::even_).help("The ball in the middle and every second shell.");
        schema.child("odd", &Rings::odd_).help("The shells between them.");
    }

    std::int64_t choose(const Point& p) const {
        const double shell = std::floor(length(across(to_vector(p))));
        return shell - 2 * std::floor(shell / 2) == 1 ? 1 : 0;
    }

    Crossing next_cut(const MaterialLine& line, double from, double) const {
        const Vector origin = across(to_vector(line.origin)), direction = across(line.direction);
        const double t = next_shell(origin, direction, from);
        return t < infinity ? Crossing{t, Normal(origin + t * direction)} : Crossing{};
    }

    double clearance_of_cuts(const Point& p) const {
        const double radius = length(across(to_vector(p)));
        return radius < 1 ? 1 - radius : distance_to_integer(radius);
    }

    std::array<const Child*, 2> children() const { return {&even_, &odd_}; }

private:
    enum class Axis { none, x, y, z };

    // What is left of a vector without its component along the axis.
    Vector across(const Vector& v) const {
        return {axis_ == Axis::x ? 0 : v.x, axis_ == Axis::y ? 0 : v.y, axis_ == Axis::z ? 0 : v.z};
    }

    Axis axis_ = Axis::none;
    Child even_, odd_;
};

LAPIDARY_PLUGIN(Rings)

}  // namespace lapidary
