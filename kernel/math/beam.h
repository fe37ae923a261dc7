// SPDX-License-Identifier: MIT
//
// What holds all camera rays of a rectangle of the picture: the space between four planes through the eye.
//
// A box that lies wholly outside one of the planes is met by none of the rays. (One that lies outside of the beam, but not of any
// one plane, counts as met: that costs a test, and loses nothing.)
#pragma once

#include <array>
#include <cmath>

#include "kernel/math/ball.h"
#include "kernel/math/bounds.h"
#include "kernel/math/vector.h"

namespace lapidary {

struct Beam {
    Point eye;
    std::array<Vector, 4> inward;    // normals of the planes, not shorter than 1
    Vector middle;                   // along the middle of the rectangle, not shorter than 1
    Vector half_width, half_height;  // directions of rays: middle + a half_width + b half_height, a and b from -1 to 1
    Vector to_right, to_top;         // normals of the planes that divide it there in quarters, like the others

    // Whether in some coordinate the eye lies beside a box, and all rays run away from it: then none meets the box, even if it is
    // infinite. (Such a box lies behind the eye, too, where planes through the eye tell nothing.)
    bool runs_away_from(const Bounds& box) const {
        return runs_away(box.low.x, box.high.x, &Vector::x, eye.x) || runs_away(box.low.y, box.high.y, &Vector::y, eye.y) ||
               runs_away(box.low.z, box.high.z, &Vector::z, eye.z);
    }

private:
    // All rays run the same way in this coordinate, from `start` on, and the box lies the other way. What rounding may do to
    // places and to directions is allowed for.
    bool runs_away(double low, double high, double Vector::*coordinate, double start) const {
        constexpr double rounding = 0x1p-44;
        const double pace = middle.*coordinate;
        const double variation = std::fabs(half_width.*coordinate) + std::fabs(half_height.*coordinate);
        if (!(std::fabs(pace) > variation + rounding * largest_magnitude(middle))) return false;
        const double side = pace > 0 ? high : low;
        const double behind = pace > 0 ? start - side : side - start;
        return behind > rounding * (largest_magnitude(eye) + std::fabs(side));
    }
};

// A beam among boxes that are given relative to an anchor.
class BeamAmongBoxes {
public:
    // Boxes are not further than `reach` from the anchor. What rounding may do to a distance from a plane is allowed for: that
    // of the eye's place and of the box's corner, and a few ulp of the sums of their products.
    BeamAmongBoxes(const Beam& beam, const Point& anchor, double reach) {
        const Vector eye = beam.eye - anchor;
        const double slack = rounding_of(beam, anchor, reach);
        for (std::size_t i = 0; i < sides_.size(); ++i) {
            const Vector& inward = beam.inward[i];
            const double sum = std::fabs(inward.x) + std::fabs(inward.y) + std::fabs(inward.z);
            sides_[i] = {inward, dot(inward, eye) - slack * sum, length(inward)};
        }
    }

    // Whether any ray may meet a box. What is no number counts as met.
    template <class Corner>
    bool may_meet(const Corner& low, const Corner& high) const {
        for (const Side& side : sides_)
            if (furthest(side.inward, low, high) < side.begin) return false;
        return true;
    }

    // The same of a ball, which reaches as far along every normal as its radius.
    bool may_meet(const Ball& ball) const {
        for (const Side& side : sides_)
            if (dot(side.inward, ball.centre) + ball.radius * side.length < side.begin) return false;
        return true;
    }

    // Of distances from planes through the eye.
    static double rounding_of(const Beam& beam, const Point& anchor, double reach) {
        const double from_anchor = largest_magnitude(beam.eye - anchor);
        return 0x1p-48 * (largest_magnitude(beam.eye) + largest_magnitude(anchor) + from_anchor + reach);
    }

    // Of the corners of a box, the furthest one along a vector.
    template <class Corner>
    static double furthest(const Vector& along, const Corner& low, const Corner& high) {
        return along.x * (along.x > 0 ? high[0] : low[0]) + along.y * (along.y > 0 ? high[1] : low[1]) +
               along.z * (along.z > 0 ? high[2] : low[2]);
    }

private:
    struct Side {
        Vector inward;
        double begin = 0;  // what dot(inward, p) is at least, inside
        double length = 0;
    };

    std::array<Side, 4> sides_;
};

// Quarters of a beam among boxes, likewise.
class QuartersOfBeam {
public:
    enum Quarter : unsigned { top_left = 1, top_right = 2, bottom_left = 4, bottom_right = 8, all = 15 };

    QuartersOfBeam(const Beam& beam, const Point& anchor, double reach)
        : right_(beam.to_right, beam, anchor, reach), top_(beam.to_top, beam, anchor, reach) {}

    // Those whose rays may meet what lies in a box and in a ball.
    template <class Corner>
    unsigned that_may_meet(const Corner& low, const Corner& high, const Ball& ball = {}) const {
        unsigned quarters = all;
        if (right_.is_all_behind(low, high) || right_.is_all_behind(ball)) quarters &= top_left | bottom_left;
        if (right_.is_all_before(low, high) || right_.is_all_before(ball)) quarters &= top_right | bottom_right;
        if (top_.is_all_behind(low, high) || top_.is_all_behind(ball)) quarters &= bottom_left | bottom_right;
        if (top_.is_all_before(low, high) || top_.is_all_before(ball)) quarters &= top_left | top_right;
        return quarters;
    }

private:
    // What lies behind the normal of a plane and what before it, rounding allowed for.
    class Divide {
    public:
        Divide(const Vector& normal, const Beam& beam, const Point& anchor, double reach)
            : normal_(normal), length_(length(normal)) {
            const double sum = std::fabs(normal.x) + std::fabs(normal.y) + std::fabs(normal.z);
            const double slack = BeamAmongBoxes::rounding_of(beam, anchor, reach) * sum, at = dot(normal, beam.eye - anchor);
            behind_ = at - slack, before_ = at + slack;
        }
        template <class Corner>
        bool is_all_behind(const Corner& low, const Corner& high) const {
            return BeamAmongBoxes::furthest(normal_, low, high) < behind_;
        }
        template <class Corner>
        bool is_all_before(const Corner& low, const Corner& high) const {
            return -BeamAmongBoxes::furthest(-normal_, low, high) > before_;
        }
        bool is_all_behind(const Ball& ball) const { return dot(normal_, ball.centre) + ball.radius * length_ < behind_; }
        bool is_all_before(const Ball& ball) const { return dot(normal_, ball.centre) - ball.radius * length_ > before_; }

    private:
        Vector normal_;
        double length_, behind_, before_;
    };

    Divide right_, top_;
};

// How far along the middle of a beam boxes begin. No ray meets a box before it has come as far.
class DepthInBeam {
public:
    // As of BeamAmongBoxes.
    DepthInBeam(const Beam& beam, const Point& anchor, double reach)
        : back_(-normalize(beam.middle)),
          of_eye_(4 * BeamAmongBoxes::rounding_of(beam, anchor, reach) - dot(back_, beam.eye - anchor)) {}

    template <class Corner>
    double operator()(const Corner& low, const Corner& high) const {
        return -BeamAmongBoxes::furthest(back_, low, high) - of_eye_;
    }

private:
    Vector back_;  // of unit length
    double of_eye_;
};

}  // namespace lapidary
