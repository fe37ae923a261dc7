// SPDX-License-Identifier: MIT
//
// noise: space cut along two levels of Perlin's noise into three materials: where it is low, where it is high, and a
// band between.
//
// Along a line, noise is twice continuously differentiable, so the cuts are isolated with its derivative and a bound on
// the second one: none is stepped over.

#include <lapidary/plugin.h>

#include <bit>

#include "lapidary/noise_search.h"

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

    std::int64_t choose(const Point& p) const { return child_where(noise(p)); }

    void choose_batch(const PointBatch& points, unsigned lanes, ChoiceBatch& choices) const {
        if (std::popcount(lanes) < points_worth_batch) return Selection::choose_batch(points, lanes, choices);
        double values[batch_size];
        noise_batch(points, batch_size, values);
        for (int lane = 0; lane < batch_size; ++lane) choices.child[lane] = child_where(values[lane]);
    }

    Crossing next_cut(const MaterialLine& line, double from, double to) const {
        return next_change_of_noise(line, from, to, [this](double value) { return value < low_ ? -1 : value > high_ ? 1 : 0; });
    }

    // Noise changes by no more than its steepest slope times the way.
    double clearance_of_cuts(const Point& p) const {
        const double value = noise(p);
        return std::fmin(std::fabs(value - low_), std::fabs(value - high_)) / noise_slope_bound;
    }

    std::array<const Child*, 3> children() const { return {&below_, &above_, &between_}; }

private:
    std::int64_t child_where(double value) const {
        const std::int64_t above_or_between = value > high_ ? 1 : 2;
        return value < low_ ? 0 : above_or_between;
    }

    double low_ = -0.05, high_ = 0.05;
    Child below_, above_, between_;
};

LAPIDARY_PLUGIN(NoiseTexture)

}  // namespace lapidary
