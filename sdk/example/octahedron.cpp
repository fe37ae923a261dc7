// SPDX-License-Identifier: MIT
//
// octahedron: eight triangles, one for each octant; an example of a plugin that is built outside of Lapidary.
//
//     cmake -S . -B build -DCMAKE_PREFIX_PATH=<where Lapidary is installed> && cmake --build build
//     lapidary --plugin-path build/lib/lapidary/plugins my.scene
//
// In its own space the solid is |x| + |y| + |z| <= r: what lies between four pairs of parallel planes s.p = -r and
// s.p = r, with s = (1, 1, 1), (1, 1, -1), (1, -1, 1) and (1, -1, -1). A line p = m + t d is between the planes of a pair where
//
//     -r <= s.m + t s.d <= r,
//
// and inside the solid where it is between all four pairs.

#include <lapidary/plugin.h>

namespace lapidary {

class Octahedron final : public ConvexObject<Octahedron> {
public:
    static void describe(Schema<Octahedron>& schema) {
        schema.summary("A solid of eight triangles, its corners on the axes.");
        schema.add("radius", &Octahedron::radius_).unit(Unit::length).above(0).help("Distance from the centre to a corner.");
    }

    Bounds bounds() const override { return Bounds::cube(radius_); }

    Span span(const LocalLine& line) const {
        Span inside = Span::all();
        for (const Vector& s : pairs)
            inside = intersect(inside, slab_span(dot(line.closest, s), dot(line.direction, s), -radius_, radius_));
        return inside;
    }

    // Faces count in pairs, each with the one on the side of s first.
    int face(const Point& local) const override {
        int nearest = 0;
        double farthest_out = -infinity;
        for (int i = 0; i < 4; ++i) {
            const double side = dot(local, pairs[i]);
            if (std::fabs(side) <= farthest_out) continue;
            farthest_out = std::fabs(side);
            nearest = 2 * i + (side < 0);
        }
        return nearest;
    }

    Normal normal(const Hit& hit) const override {
        const Vector& s = pairs[hit.face / 2];
        return Normal(hit.face % 2 == 0 ? s : -s);
    }

    Surfaces surfaces() const override {
        Surfaces faces;
        for (const Vector& s : pairs) {
            faces.push_back(Surface::plane(s.x, s.y, s.z, radius_));
            faces.push_back(Surface::plane(-s.x, -s.y, -s.z, radius_));
        }
        return faces;
    }

private:
    static constexpr Vector pairs[4] = {{1, 1, 1}, {1, 1, -1}, {1, -1, 1}, {1, -1, -1}};

    double radius_ = 1;
};

LAPIDARY_PLUGIN(Octahedron)

}  // namespace lapidary
