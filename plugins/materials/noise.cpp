// SPDX-License-Identifier: MIT
//
// noise: space cut along two levels of Perlin's noise into three materials: where it is low, where it is high, and a
// band between.
//
// Along a line, noise is twice continuously differentiable, so the cuts are isolated with its derivative and a bound on
// the second one: none is stepped over.

#include <lapidary/plugin.h>

namespace lapidary {

class NoiseTexture final : public Selection<NoiseTexture> {
public:
    static void describe(Schema<NoiseTexture>& schema) {
        schema.summary("Three materials where noise is low, high and between.");
        schema.add("band", &NoiseTexture::low_, &NoiseTexture::high_)
            .arguments("low, high")
            .help("The values of noise, about -1 to 1, between which the third material lies.");
        schema.require("the band must begin below its end", [](const NoiseTexture& t) { return t.low_ <= t.high_; });
        schema.child("low", &NoiseTexture::below_).help("Where noise is below the band.");
        schema.child("high", &NoiseTexture::above_).help("Where noise is above the band.");
        schema.child("between", &NoiseTexture::between_).help("In the band.");
    }

    const Child& choose(const Point& p) const {
        const double value = noise(p);
        return value < low_ ? below_ : value > high_ ? above_ : between_;
    }

    Crossing next_cut(const MaterialLine& line, double from, double to) const {
        if (!is_in_reach(low_) && !is_in_reach(high_)) return {};
        const double speed = length(line.direction);
        if (!(speed > 0) || !(speed < infinity)) return {};

        const auto noise_along = [&](double t) {
            const NoiseSample sample = noise_with_gradient(line.at(t));
            return Slope{sample.value, dot(sample.gradient, line.direction)};
        };
        const auto range_of = [&](double value) { return value < low_ ? -1 : value > high_ ? 1 : 0; };
        const FirstChange search(noise_along, noise_curvature_bound * speed * speed, range_of);
        const double t = search.find(from, std::fmin(to, from + search_limit / speed), search_step / speed);
        if (!(t < to)) return {};
        return {t, Normal(noise_with_gradient(line.at(t)).gradient)};
    }

    // Noise changes by no more than its steepest slope times the way.
    double clearance_of_cuts(const Point& p) const {
        const double value = noise(p);
        return std::fmin(std::fabs(value - low_), std::fabs(value - high_)) / noise_slope_bound;
    }

    std::array<const Child*, 3> children() const { return {&below_, &above_, &between_}; }

private:
    // A line that meets no cut within so many cells is taken to meet none. Only an endless line through a band at the
    // very ends of noise's values comes so far.
    static constexpr double search_limit = 0x1p16;
    static constexpr double search_step = 0.25;

    static bool is_in_reach(double level) { return std::fabs(level) <= noise_bound; }

    double low_ = -0.05, high_ = 0.05;
    Child below_, above_, between_;
};

LAPIDARY_PLUGIN(NoiseTexture)

}  // namespace lapidary
