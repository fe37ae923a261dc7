// SPDX-License-Identifier: MIT
//
// cylinder: a solid rod about the y axis, infinite or cut off by two caps.
//
// The rod is x^2 + z^2 <= r^2, the part between the caps |y| <= h/2; along the line, both are spans.

#include <lapidary/plugin.h>

#include <optional>

namespace lapidary {

class Cylinder final : public ConvexObject<Cylinder> {
public:
    static void describe(Schema<Cylinder>& schema) {
        schema.summary("A solid rod about the y axis.");
        schema.add("radius", &Cylinder::radius_).unit(Unit::length).above(0).help("Distance from the axis to the surface.");
        schema.add("height", &Cylinder::height_)
            .unit(Unit::length)
            .above(0)
            .help("From cap to cap, half of it above the centre and half below; without it the rod is infinite.");
        schema.derive([](Cylinder& c) { c.half_height_ = c.height_ ? *c.height_ / 2 : infinity; });
    }

    Bounds bounds() const override { return Bounds::box(radius_, half_height_, radius_); }

    Span span(const LocalLine& line) const {
        return intersect(tube_span(line, radius_), slab_span(line.closest.y, line.direction.y, -half_height_, half_height_));
    }

    int face(const Point& p) const override {
        const double to_side = std::fabs(radius_ - std::hypot(p.x, p.z)), to_cap = std::fabs(half_height_ - std::fabs(p.y));
        if (to_side <= to_cap) return side;
        return p.y > 0 ? top : bottom;
    }

    Normal normal(const Hit& hit) const override {
        if (hit.face == side) return {hit.local.x, 0, hit.local.z};
        return {0, hit.face == top ? 1.0 : -1.0, 0};
    }

    Surfaces surfaces() const override {
        if (!height_) return {Surface::cylinder(radius_)};
        return {Surface::cylinder(radius_), Surface::plane(0, 1, 0, half_height_), Surface::plane(0, -1, 0, half_height_)};
    }

private:
    enum Face { side, top, bottom };

    double radius_ = 1;
    std::optional<double> height_;
    double half_height_ = infinity;
};

LAPIDARY_PLUGIN(Cylinder)

}  // namespace lapidary
