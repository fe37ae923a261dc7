// SPDX-License-Identifier: MIT
//
// spot: light from one place into a cone with a soft edge.
//
// It is a point light times s^2 (3 - 2 s), where s runs from 0 at the angle b from the axis to 1 at the angle a:
//
//     s = (cos t - cos b) / (cos a - cos b)
//
// for the angle t between the axis and the way to the point. Close to the axis cosines say nothing (cos 1e-8 = 1), so
// the difference of two of them is taken from the sines of half the angles, which keep every digit:
//
//     cos t - cos b = 2 (sin^2(b/2) - sin^2(t/2)),   sin^2(t/2) = |v - d|^2/4 for unit vectors v and d.

#include <lapidary/batched_light.h>
#include <lapidary/light_geometry.h>
#include <lapidary/plugin.h>

namespace lapidary {

class Spot final : public BatchedLight<Spot> {
public:
    static void describe(Schema<Spot>& schema) {
        schema.summary("Light from one place into a cone with a soft edge.");
        schema.add("colour", &Spot::colour_).help("Colour of the light.");
        schema.add("intensity", &Spot::intensity_).at_least(0).help("Factor to the colour, at a distance of 1.");
        schema.add("location", &Spot::location_).unit(Unit::length).help("Where the light is.");
        schema.add("direction", &Spot::direction_).help("Where the light's axis points; of any length.");
        schema.add("angles", &Spot::inner_, &Spot::outer_)
            .unit(Unit::angle)
            .between(0, std::numbers::pi)
            .arguments("a, b")
            .help("From the axis to where the full light ends, and to where all of it ends.");
        schema.add("radius", &Spot::radius_)
            .unit(Unit::length)
            .at_least(0)
            .help("Makes the light a ball of this size; above 0, shadows are soft.");
        schema.require("the first angle must not be larger than the second", [](const Spot& s) { return s.inner_ <= s.outer_; });
        schema.derive([](Spot& s) {
            s.axis_ = normalize(s.direction_);
            s.squared_sine_of_half_inner_ = std::pow(std::sin(s.inner_ / 2), 2);
            s.squared_sine_of_half_outer_ = std::pow(std::sin(s.outer_ / 2), 2);
            // Two angles that are next to each other, too, differ in all digits of this product.
            s.inverse_of_edge_ = 1 / (std::sin((s.outer_ - s.inner_) / 2) * std::sin((s.outer_ + s.inner_) / 2));
            s.sine_of_outer_ = std::sin(s.outer_), s.cosine_of_outer_ = std::cos(s.outer_);
        });
    }

    Illumination from_middle(const Point& point) const {
        const Heading to_centre = heading_along(location_ - point);
        return point_light(to_centre, part_within_cone(-to_centre.direction) * colour_, intensity_);
    }

    Illumination from_sample(const Point& point, const LightSample& sample) const {
        const Vector to_centre = location_ - point;
        const double part = part_within_cone(-heading_along(to_centre).direction);
        if (!(part > 0)) return {};
        return ball_light(to_centre, radius_, part * colour_, intensity_, sample);
    }

    bool has_extent() const override { return radius_ > 0; }
    std::optional<Bounds> place() const override { return ball_bounds(location_, radius_); }

    // The ball around a box is seen under a half-angle a from the light, sin a = its radius / its distance. It lies outside of
    // the cone where the way to its middle makes more than the angle b + a with the axis.
    bool may_reach(const Bounds& box) const override {
        constexpr double rounding = 1e-9;
        const Vector to_middle = box.centre() - location_;
        const double size = largest_magnitude(box.low) + largest_magnitude(box.high) + largest_magnitude(location_);
        const double radius = length(box.diagonal()) / 2 + 0x1p-46 * size, distance = length(to_middle);
        if (!(radius < distance && distance < infinity)) return true;
        const double sine = radius / distance, cosine = std::sqrt((1 - sine) * (1 + sine));
        const double sine_of_sum = sine_of_outer_ * cosine + cosine_of_outer_ * sine;
        const double cosine_of_sum = cosine_of_outer_ * cosine - sine_of_outer_ * sine;
        const bool is_everywhere = sine_of_sum <= rounding;  // the sum is half a turn or more
        return is_everywhere || dot(axis_, to_middle) >= (cosine_of_sum - rounding) * distance;
    }

private:
    // Chosen instead of returned early, so that a loop over points stays vector instructions.
    double part_within_cone(const Vector& way) const {
        const double inner = squared_sine_of_half_inner_, outer = squared_sine_of_half_outer_;
        const double off_axis = length_squared(way - axis_) / 4, s = (outer - off_axis) * inverse_of_edge_;
        const double between = off_axis < outer ? s * s * (3 - 2 * s) : 0;
        const bool is_full = inner > 0 && off_axis <= inner;  // angles of 0 let nothing through, angles of 180deg everything
        return is_full ? 1 : between;
    }

    Colour colour_ = Colour::white();
    double intensity_ = 1;
    Point location_;
    Vector direction_{0, 0, 1};
    double inner_ = std::numbers::pi / 9, outer_ = std::numbers::pi / 6;
    double radius_ = 0;

    Vector axis_;  // a unit vector
    double squared_sine_of_half_inner_ = 0, squared_sine_of_half_outer_ = 0, inverse_of_edge_ = 0;
    double sine_of_outer_ = 0, cosine_of_outer_ = 1;
};

LAPIDARY_PLUGIN(Spot)

}  // namespace lapidary
