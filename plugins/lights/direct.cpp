// SPDX-License-Identifier: MIT
//
// direct: light from infinitely far away, in one direction, as from the sun.
//
// With an angle it is a disc in the sky of that diameter: soft shadows. A surface that faces the disc's middle meets its
// rays at a mean cosine of (1 + cos(angle/2))/2; the disc is brighter by as much, so that the surface gets the same light.

#include <lapidary/batched_light.h>
#include <lapidary/light_geometry.h>
#include <lapidary/plugin.h>

namespace lapidary {

class Direct final : public BatchedLight<Direct> {
public:
    static void describe(Schema<Direct>& schema) {
        schema.summary("Light from infinitely far away, as from the sun.");
        schema.add("colour", &Direct::colour_).help("Colour of the light.");
        schema.add("intensity", &Direct::intensity_).at_least(0).help("Factor to the colour.");
        schema.add("direction", &Direct::direction_).help("Where the light travels; of any length.");
        schema.add("angle", &Direct::angle_)
            .unit(Unit::angle)
            .between(0, std::numbers::pi)
            .help("How wide the light's disc is in the sky (the sun: 0.53deg); above 0, shadows are soft.");
        schema.derive([](Direct& d) {
            const double sine = std::sin(d.angle_ / 4);
            d.to_middle_ = -normalize(d.direction_), d.versine_ = 2 * sine * sine;
        });
    }

    Illumination from_middle(const Point&) const { return {to_middle_, infinity, intensity_ * colour_}; }

    Illumination from_sample(const Point&, const LightSample& sample) const {
        return {direction_in_cone(to_middle_, versine_, sample), infinity, intensity_ / (1 - versine_ / 2) * colour_};
    }

    bool has_extent() const override { return angle_ > 0; }

private:
    Colour colour_ = Colour::white();
    double intensity_ = 1;
    Vector direction_{0, 0, 1};
    double angle_ = 0;

    Vector to_middle_;    // of the disc, a unit vector
    double versine_ = 0;  // 1 - cos(angle/2)
};

LAPIDARY_PLUGIN(Direct)

}  // namespace lapidary
