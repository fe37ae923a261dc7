// SPDX-License-Identifier: MIT
//
// cone: a solid cone about the y axis, cut off at both ends.
//
// Its radius falls linearly from a at y = -h/2 to b at y = h/2. With the slope s = (a - b)/h and the apex at
// y = h/2 + b/s it is the part of the double cone
//
//     x^2 + z^2 <= (s (apex - y))^2
//
// between the planes of its ends; the apex lies outside them or on one, so only one nappe is left. Equal radii make it
// a cylinder.

#include <lapidary/plugin.h>

namespace lapidary {

class Cone final : public ConvexObject<Cone> {
public:
    static void describe(Schema<Cone>& schema) {
        schema.summary("A solid cone about the y axis, pointed or cut off.");
        schema.add("radii", &Cone::bottom_radius_, &Cone::top_radius_)
            .unit(Unit::length)
            .at_least(0)
            .arguments("a, b")
            .help("Radius of the lower end and of the upper one; 0 makes a point.");
        schema.add("height", &Cone::height_).unit(Unit::length).above(0).help("From end to end.");
        schema.require("one of the radii must be above 0", [](const Cone& c) { return c.bottom_radius_ + c.top_radius_ > 0; });
    }

    Bounds bounds() const override {
        const double widest = std::fmax(bottom_radius_, top_radius_);
        return Bounds::box(widest, height_ / 2, widest);
    }

    Span span(const LocalLine& line) const {
        const Span between = slab_span(line.closest.y, line.direction.y, -height_ / 2, height_ / 2);
        const double radius = is_cylinder() ? bottom_radius_ : slope() * (apex() - line.closest.y);

        // The ends leave what is in one nappe; rounding at the apex may leave a trace of the other.
        const DoubleConePieces pieces = double_cone_pieces(line, slope(), radius);
        const Span first = intersect(pieces.first, between), second = intersect(pieces.second, between);
        return second.out - second.in > first.out - first.in ? second : first;
    }

    int face(const Point& p) const override {
        const double slant = std::hypot(1, slope());
        const double to_side = std::fabs(std::hypot(p.x, p.z) - radius_at(p.y)) / slant;
        const double to_bottom = std::fabs(p.y + height_ / 2), to_top = std::fabs(p.y - height_ / 2);
        if (to_side <= to_bottom && to_side <= to_top) return side;
        return to_top < to_bottom ? top : bottom;
    }

    // The gradient of |(x, z)| + slope y; at the point itself, the axis.
    Normal normal(const Hit& hit) const override {
        if (hit.face == top) return {0, 1, 0};
        if (hit.face == bottom) return {0, -1, 0};
        const Point& p = hit.local;
        return {p.x, slope() * std::hypot(p.x, p.z), p.z};
    }

    Surfaces surfaces() const override {
        return {is_cylinder() ? Surface::cylinder(bottom_radius_) : Surface::cone(slope(), apex()),
                Surface::plane(0, 1, 0, height_ / 2), Surface::plane(0, -1, 0, height_ / 2)};
    }

private:
    enum Face { side, top, bottom };

    bool is_cylinder() const { return bottom_radius_ == top_radius_; }
    double slope() const { return (bottom_radius_ - top_radius_) / height_; }
    double apex() const { return height_ / 2 + top_radius_ / slope(); }
    double radius_at(double y) const {
        const double up = y / height_ + 0.5;
        return bottom_radius_ * (1 - up) + top_radius_ * up;
    }

    double bottom_radius_ = 1, top_radius_ = 0;
    double height_ = 2;
};

LAPIDARY_PLUGIN(Cone)

}  // namespace lapidary
