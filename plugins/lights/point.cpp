// SPDX-License-Identifier: MIT
//
// point: light from one place in all directions, falling off with the square of the distance.
//
// With a radius it is a ball that sends the same light as the point: soft shadows.

#include <lapidary/batched_light.h>
#include <lapidary/light_geometry.h>
#include <lapidary/plugin.h>

namespace lapidary {

class PointLight final : public BatchedLight<PointLight> {
public:
    static void describe(Schema<PointLight>& schema) {
        schema.summary("Light from one place in all directions.");
        schema.add("colour", &PointLight::colour_).help("Colour of the light.");
        schema.add("intensity", &PointLight::intensity_).at_least(0).help("Factor to the colour, at a distance of 1.");
        schema.add("location", &PointLight::location_).unit(Unit::length).help("Where the light is.");
        schema.add("radius", &PointLight::radius_)
            .unit(Unit::length)
            .at_least(0)
            .help("Makes the light a ball of this size; above 0, shadows are soft.");
    }

    Illumination from_middle(const Point& point) const { return point_light(location_ - point, colour_, intensity_); }

    Illumination from_sample(const Point& point, const LightSample& sample) const {
        return ball_light(location_ - point, radius_, colour_, intensity_, sample);
    }

    bool has_extent() const override { return radius_ > 0; }
    std::optional<Bounds> place() const override { return ball_bounds(location_, radius_); }

private:
    Colour colour_ = Colour::white();
    double intensity_ = 1;
    Point location_;
    double radius_ = 0;
};

LAPIDARY_PLUGIN(PointLight)

}  // namespace lapidary
