// SPDX-License-Identifier: MIT
//
// direct: light from infinitely far away, in one direction, as from the sun.
//
// With an angle it is a disc in the sky of that diameter, as bright in all: soft shadows.

#include <lapidary/light_geometry.h>
#include <lapidary/plugin.h>

namespace lapidary {

class Direct final : public Light {
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
    }

    Illumination toward(const Point&, const LightSample& sample) const override {
        const Vector axis = -normalize(direction_);
        const double half_sine = std::sin(angle_ / 4);  // 1 - cos(a/2) = 2 sin(a/4)^2
        const Vector direction = angle_ > 0 ? direction_in_cone(axis, 2 * half_sine * half_sine, sample) : axis;
        return {direction, infinity, intensity_ * colour_};
    }

    bool has_extent() const override { return angle_ > 0; }

private:
    Colour colour_ = Colour::white();
    double intensity_ = 1;
    Vector direction_{0, 0, 1};
    double angle_ = 0;
};

LAPIDARY_PLUGIN(Direct)

}  // namespace lapidary
