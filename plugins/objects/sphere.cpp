// SPDX-License-Identifier: MIT
//
// sphere: a solid ball.
//
// In its own space the ball is |p| <= r. The line arrives about m, its point closest to the centre, so m.d = 0
// and the surface |m + t d| = r is met at
//
//     t = -h and t = h,   h = sqrt((r^2 - m.m) / d.d).
//
// A line that only touches the ball has no length inside it: a miss. The kernel asks the same question, so the formula lives in
// kernel/math/roots.h.

#include <lapidary/plugin.h>

namespace lapidary {

class Sphere final : public ConvexObject<Sphere> {
public:
    static void describe(Schema<Sphere>& schema) {
        schema.summary("A solid ball.");
        schema.add("radius", &Sphere::radius_).unit(Unit::length).above(0).help("Distance from the centre to the surface.");
    }

    Bounds bounds() const override { return Bounds::cube(radius_); }

    Span span(const LocalLine& line) const { return ball_span(line, radius_); }

    Normal normal(const Hit& hit) const override { return Normal(hit.local); }

    Surfaces surfaces() const override { return {Surface::sphere(radius_)}; }

private:
    double radius_ = 1;
};

LAPIDARY_PLUGIN(Sphere)

}  // namespace lapidary
