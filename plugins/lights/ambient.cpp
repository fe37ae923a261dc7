// SPDX-License-Identifier: MIT
//
// ambient: light from everywhere, equally, without direction or shadow.

#include <lapidary/batched_light.h>
#include <lapidary/plugin.h>

namespace lapidary {

class Ambient final : public BatchedLight<Ambient> {
public:
    static void describe(Schema<Ambient>& schema) {
        schema.summary("Light from everywhere, without direction or shadow.");
        schema.add("colour", &Ambient::colour_).help("Colour of the light.");
        schema.add("intensity", &Ambient::intensity_).at_least(0).help("Factor to the colour.");
    }

    Illumination from_middle(const Point&) const { return {{}, infinity, intensity_ * colour_}; }

    bool is_ambient() const override { return true; }

private:
    Colour colour_ = Colour::white();
    double intensity_ = 0.05;
};

LAPIDARY_PLUGIN(Ambient)

}  // namespace lapidary
