// SPDX-License-Identifier: MIT
//
// torus: a ring about the y axis.
//
// With R the radius of the ring and r that of its tube, the solid is (rho - R)^2 + y^2 <= r^2, rho = sqrt(x^2 + z^2). Where r > R
// the ring covers itself and the solid is what lies within its outer skin. A line meets it in up to two pieces, which
// kernel/math/roots.cpp finds from a quartic.

#include <lapidary/plugin.h>

namespace lapidary {

class Torus final : public Object {
public:
    static void describe(Schema<Torus>& schema) {
        schema.summary("A solid ring about the y axis.");
        schema.add("radii", &Torus::ring_, &Torus::tube_)
            .unit(Unit::length)
            .above(0)
            .arguments("R, r")
            .help("From the centre to the middle of the tube, and of the tube itself.");
    }

    Bounds bounds() const override { return Bounds::box(ring_ + tube_, tube_, ring_ + tube_); }

    int max_spans() const override { return 2; }

    int spans(const LocalLine& line, Span* out) const override { return torus_spans(line, ring_, tube_, out); }

    // Away from the middle of the tube: the gradient of (rho - R)^2 + y^2. On the axis there is no way outward but y.
    Normal normal(const Hit& hit) const override {
        const Point& p = hit.local;
        const double rho = std::hypot(p.x, p.z);
        if (rho == 0) return {0, p.y, 0};
        const double outward = (rho - ring_) / rho;
        return {p.x * outward, p.y, p.z * outward};
    }

    Surfaces surfaces() const override { return {Surface::torus(ring_, tube_)}; }

private:
    double ring_ = 1, tube_ = 0.25;
};

LAPIDARY_PLUGIN(Torus)

}  // namespace lapidary
