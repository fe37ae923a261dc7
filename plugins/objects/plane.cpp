// SPDX-License-Identifier: MIT
//
// plane: an infinite slab across the y axis, |y| <= t/2.
//
// A thickness of 0 bounds no volume. It gives a sheet: the surface y = 0 itself, seen from both sides, which a line
// crosses at one t and is never inside of.

#include <lapidary/plugin.h>

namespace lapidary {

class Plane final : public ConvexObject<Plane> {
public:
    static void describe(Schema<Plane>& schema) {
        schema.summary("An infinite slab across the y axis; of thickness 0, a sheet without inside.");
        schema.add("thickness", &Plane::thickness_).unit(Unit::length).at_least(0).help("From face to face; 0 makes a sheet.");
    }

    Bounds bounds() const override { return {{-infinity, -thickness_ / 2, -infinity}, {infinity, thickness_ / 2, infinity}}; }

    bool is_sheet() const override { return thickness_ == 0; }

    // A line that runs along the sheet never crosses it.
    Span span(const LocalLine& line) const {
        return slab_span(line.closest.y, line.direction.y, -thickness_ / 2, thickness_ / 2);
    }

    int face(const Point& p) const override { return p.y < 0 && !is_sheet() ? 1 : 0; }

    Normal normal(const Hit& hit) const override { return {0, hit.face == 0 ? 1.0 : -1.0, 0}; }

    Surfaces surfaces() const override {
        if (is_sheet()) return {Surface::plane(0, 1, 0, 0)};
        return {Surface::plane(0, 1, 0, thickness_ / 2), Surface::plane(0, -1, 0, thickness_ / 2)};
    }

private:
    double thickness_ = 0;
};

LAPIDARY_PLUGIN(Plane)

}  // namespace lapidary
