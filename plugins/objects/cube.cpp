// SPDX-License-Identifier: MIT
//
// cube: a solid box with faces across the axes.
//
// The box is |x| <= a, |y| <= b, |z| <= c: what three slabs have in common. Along the line, so is the span.

#include <lapidary/plugin.h>

namespace lapidary {

class Cube final : public ConvexObject<Cube> {
public:
    static void describe(Schema<Cube>& schema) {
        schema.summary("A solid box, centred, with faces across the axes.");
        schema.add("size", &Cube::half_)
            .unit(Unit::length)
            .above(0)
            .help("Distances from the centre to the faces: half the edges.");
    }

    Bounds bounds() const override { return Bounds::box(half_.x, half_.y, half_.z); }

    Span span(const LocalLine& line) const {
        const Span x = slab_span(line.closest.x, line.direction.x, -half_.x, half_.x);
        const Span y = slab_span(line.closest.y, line.direction.y, -half_.y, half_.y);
        const Span z = slab_span(line.closest.z, line.direction.z, -half_.z, half_.z);
        return intersect(intersect(x, y), z);
    }

    // The face whose plane is nearest, faces in the order -x, +x, -y, +y, -z, +z.
    int face(const Point& p) const override {
        const double x = half_.x - std::fabs(p.x), y = half_.y - std::fabs(p.y), z = half_.z - std::fabs(p.z);
        const int along_x = p.x > 0 ? 1 : 0, along_y = p.y > 0 ? 3 : 2, along_z = p.z > 0 ? 5 : 4;
        const int of_other = y <= z ? along_y : along_z;
        return x <= (y < z ? y : z) ? along_x : of_other;
    }

    Normal normal(const Hit& hit) const override {
        const double outward = (hit.face & 1) != 0 ? 1 : -1;
        const int axis = hit.face >> 1;
        return {axis == 0 ? outward : 0, axis == 1 ? outward : 0, axis == 2 ? outward : 0};
    }

    Surfaces surfaces() const override {
        return {Surface::plane(-1, 0, 0, half_.x), Surface::plane(1, 0, 0, half_.x),  Surface::plane(0, -1, 0, half_.y),
                Surface::plane(0, 1, 0, half_.y),  Surface::plane(0, 0, -1, half_.z), Surface::plane(0, 0, 1, half_.z)};
    }

private:
    Vector half_{1, 1, 1};
};

LAPIDARY_PLUGIN(Cube)

}  // namespace lapidary
