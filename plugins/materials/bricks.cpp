// SPDX-License-Identifier: MIT
//
// bricks: a wall of bricks in running bond, solid all through.
//
// A brick and the joints beyond it, in the direction of each axis, take a block of space of a given size. Courses lie
// along y, and every second one is shifted by half a brick along x. In each coordinate, taken modulo the block, the
// brick reaches from 0 to size - joint; mortar is what is not brick in all three.

#include <lapidary/plugin.h>

namespace lapidary {

class Bricks final : public BatchedSelection<Bricks> {
public:
    static void describe(Schema<Bricks>& schema) {
        schema.summary("Bricks in running bond, and the mortar between them.");
        schema.add("size", &Bricks::size_x_, &Bricks::size_y_, &Bricks::size_z_)
            .unit(Unit::length)
            .above(0)
            .help("Length, height and depth of a brick with its joints.");
        schema.add("joint", &Bricks::joint_).unit(Unit::length).at_least(0).help("Thickness of the mortar between bricks.");
        schema.require("the joint must be thinner than half the length, the height and the depth of a brick",
                       [](const Bricks& b) {
                           return b.joint_ < std::min({b.size_x_ / 2, b.size_y_, b.size_z_});
                       });
        schema.child("brick", &Bricks::brick_).help("The bricks.");
        schema.child("mortar", &Bricks::mortar_).help("What is between them.");
    }

    std::int64_t choose(const Point& p) const {
        const bool x = rows_x(p.y).holds(p.x), y = rows_y().holds(p.y), z = rows_z().holds(p.z);
        return (x & y & z) ? 0 : 1;
    }

    // Cell by cell, until being in a brick changes. In a joint across z or y there is mortar until the line leaves it,
    // whatever the other coordinates do; in one across x until it leaves it or the course. So a few jumps lead out.
    Crossing next_cut(const MaterialLine& line, double from, double to) const {
        const Along x{line.origin.x, line.direction.x, {1, 0, 0}};
        const Along y{line.origin.y, line.direction.y, {0, 1, 0}};
        const Along z{line.origin.z, line.direction.z, {0, 0, 1}};

        Crossing here{from, {}};
        bool started_in_brick = false;
        for (int jumps = 0; jumps < most_jumps && here.t < to; ++jumps) {
            const Crossing leave_y = y.next(rows_y(), here.t), leave_z = z.next(rows_z(), here.t);
            const Rows rows = rows_x(y.at(between(here.t, leave_y.t)));
            const Crossing leave_x = x.next(rows, here.t), leave_course = earliest(leave_x, leave_y);

            const double middle = between(here.t, std::fmin(leave_course.t, leave_z.t));
            const bool x_holds = rows.holds(x.at(middle));
            const bool y_holds = rows_y().holds(y.at(middle));
            const bool z_holds = rows_z().holds(z.at(middle));
            const bool in_brick = x_holds && y_holds && z_holds;
            if (jumps == 0) started_in_brick = in_brick;
            if (in_brick != started_in_brick) return here;
            here = in_brick ? earliest(leave_course, leave_z) : !z_holds ? leave_z : !y_holds ? leave_y : leave_course;
        }
        return {};
    }

    double clearance_of_cuts(const Point& p) const {
        return std::min({rows_x(p.y).clearance(p.x), rows_y().clearance(p.y), rows_z().clearance(p.z)});
    }

    std::array<const Child*, 2> children() const { return {&brick_, &mortar_}; }

private:
    // Where bricks are along one coordinate: `brick` of every `period`, from `shift` on.
    struct Rows {
        double period, brick, shift;

        bool holds(double c) const {
            const double blocks = (c - shift) / period;
            return (blocks - std::floor(blocks)) * period < brick;
        }
        double clearance(double c) const {
            const double blocks = (c - shift) / period;
            return std::fmin(distance_to_integer(blocks), distance_to_integer(blocks, brick / period)) * period;
        }
    };

    // A coordinate along the line.
    struct Along {
        double origin, slope;
        Normal normal;

        double at(double t) const { return fused_multiply_add(t, slope, origin); }
        Crossing next(const Rows& rows, double from) const {
            const double start = (origin - rows.shift) / rows.period, pace = slope / rows.period;
            const double t =
                std::fmin(next_integer(start, pace, from), next_integer(start, pace, from, rows.brick / rows.period));
            return {t, normal};
        }
    };

    // Out of a joint across z, one across y, one across x, the one above it, and into the next course; the rest is for
    // edges that rounding crosses one after the other. (Without joints there is nothing to find, however far.)
    static constexpr int most_jumps = 16;

    static const Crossing& earliest(const Crossing& a, const Crossing& b) { return b.t < a.t ? b : a; }

    Rows rows_y() const { return {size_y_, size_y_ - joint_, 0}; }
    Rows rows_z() const { return {size_z_, size_z_ - joint_, 0}; }
    Rows rows_x(double y) const {
        const double course = std::floor(y / size_y_);
        const bool shifted = course - 2 * std::floor(course / 2) == 1;
        return {size_x_, size_x_ - joint_, shifted ? size_x_ / 2 : 0};
    }

    double size_x_ = 2, size_y_ = 0.75, size_z_ = 1, joint_ = 0.1;
    Child brick_, mortar_;
};

LAPIDARY_PLUGIN(Bricks)

}  // namespace lapidary
