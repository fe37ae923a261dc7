// SPDX-License-Identifier: MIT
//
// gradient: colours that run into one another along x.
//
// The n colours stand at equal distances from x = 0 to x = 1, with straight lines between them. Outside, the end colours
// go on, or the gradient is mirrored at each end; either way it is continuous, so that there are no boundaries.

#include <lapidary/plugin.h>

namespace lapidary {

class Gradient final : public Leaf {
public:
    static void describe(Schema<Gradient>& schema) {
        schema.summary("Colours that run into one another along x, from 0 to 1.");
        schema.add("colour", &Gradient::colours_)
            .at_least(0)
            .help("Written once for each colour, in order along x; black and white by default.");
        schema.add("extend", &Gradient::extend_, {"hold", "mirror"})
            .help("Beyond 0 and 1: the colours at the ends go on, or all run back and forth.");
        describe_finish(schema);
    }

    Matter evaluate(const Site& site) const override { return matter(colour_at(place(site.point.x)), site.point); }

    bool is_uniform() const override { return colours_.size() == 1 && Leaf::is_uniform(); }

private:
    enum class Extend { hold, mirror };

    // x taken into 0 … 1.
    double place(double x) const {
        if (extend_ == Extend::mirror) x = 1 - std::fabs(x - 2 * std::floor(x / 2) - 1);
        return std::fmin(std::fmax(x, 0), 1);
    }

    Colour colour_at(double place) const {
        if (colours_.empty()) return Colour::grey(place);
        const std::size_t last = colours_.size() - 1;
        const double scaled = place * static_cast<double>(last);
        const std::size_t i = std::min(static_cast<std::size_t>(scaled), last);
        return i == last ? colours_[last] : mix(colours_[i], colours_[i + 1], scaled - static_cast<double>(i));
    }

    std::vector<Colour> colours_;
    Extend extend_ = Extend::hold;
};

LAPIDARY_PLUGIN(Gradient)

}  // namespace lapidary
