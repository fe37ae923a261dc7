// SPDX-License-Identifier: MIT
//
// checkers: space cut into unit cubes, dealt alternately to two materials.
//
// A cube is even when its three integer coordinates add up to an even number, so cubes that share a face always
// differ. The cuts are the integer planes.

#include <lapidary/plugin.h>

namespace lapidary {

class Checkers final : public BatchedSelection<Checkers> {
public:
    static void describe(Schema<Checkers>& schema) {
        schema.summary("Unit cubes of two materials, alternating along each axis.");
        schema.child("even", &Checkers::even_).help("The cube at the origin and every second one.");
        schema.child("odd", &Checkers::odd_).help("The cubes between them.");
    }

    // The parity of a sum is that of the sum of the parities, which stays exact at any coordinate.
    std::int64_t choose(const Point& p) const {
        const auto is_odd = [](double x) {
            const double cell = std::floor(x);
            return cell - 2 * std::floor(cell / 2) == 1;
        };
        return (is_odd(p.x) ^ is_odd(p.y) ^ is_odd(p.z)) ? 1 : 0;
    }

    Crossing next_cut(const MaterialLine& line, double from, double) const {
        const Point& o = line.origin;
        const Vector& d = line.direction;
        Crossing first;
        const auto meet = [&](double t, const Normal& normal) {
            if (t < first.t) first = {t, normal};
        };
        meet(next_integer(o.x, d.x, from), {1, 0, 0});
        meet(next_integer(o.y, d.y, from), {0, 1, 0});
        meet(next_integer(o.z, d.z, from), {0, 0, 1});
        return first;
    }

    double clearance_of_cuts(const Point& p) const {
        return std::min({distance_to_integer(p.x), distance_to_integer(p.y), distance_to_integer(p.z)});
    }

    std::array<const Child*, 2> children() const { return {&even_, &odd_}; }

private:
    Child even_, odd_;
};

LAPIDARY_PLUGIN(Checkers)

}  // namespace lapidary
