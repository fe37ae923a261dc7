// SPDX-License-Identifier: MIT
//
// Run time against error, on pictures that are formulas: how fast the error falls, and whether the promised error is kept.
// The reference is made with another sequence than the sampler's.

#include <cmath>
#include <vector>

#include "support/catch.h"
#include "support/error_ladder.h"
#include "support/stand_in_picture.h"

using namespace lapidary;

namespace {

struct Difference {
    double rmse;
    double within_twice;  // share of pixels off by less than twice the tolerance
};

// The mean over the points of a sequence of Roberts (2018) in four dimensions: place in the pixel, place on the light.
std::vector<Colour> reference_of(const StandInPicture& picture) {
    constexpr int count = 2048;
    constexpr double step = 1 / 1.16730397826141868426;  // x^5 = x + 1
    const auto coordinate = [](int i, double alpha) { return std::fmod(0.5 + i * alpha, 1); };
    std::vector<Colour> pixels;
    for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width; ++x) {
            Colour sum;
            for (int i = 0; i < count; ++i) {
                const SamplePair light{coordinate(i, step * step * step), coordinate(i, step * step * step * step)};
                sum += picture.at(x + coordinate(i, step), y + coordinate(i, step * step), light);
            }
            pixels.push_back(1.0 / count * sum);
        }
    return pixels;
}

Difference difference(const Frame& frame, const std::vector<Colour>& reference, double tolerance) {
    double squares = 0;
    std::size_t good = 0;
    for (std::size_t i = 0; i < reference.size(); ++i) {
        const auto pixel = frame.layer(Layer::colour).subspan(3 * i, 3);
        const Colour d = Colour{pixel[0], pixel[1], pixel[2]} - reference[i];
        const double square = (d.r * d.r + d.g * d.g + d.b * d.b) / 3;
        squares += square;
        good += std::sqrt(square) < 2 * tolerance;
    }
    return {std::sqrt(squares / static_cast<double>(reference.size())),
            static_cast<double>(good) / static_cast<double>(reference.size())};
}

test::ErrorLadder uniform_ladder(const StandInPicture& picture, const std::vector<Colour>& reference) {
    test::ErrorLadder ladder;
    for (int samples = 4; samples <= 256; samples *= 2) {
        Frame frame = picture.frame();
        SamplingPlan plan;
        plan.samples = samples;
        picture.render(frame, plan);
        ladder.rmse[samples] = difference(frame, reference, 1).rmse;
    }
    return ladder;
}

}  // namespace

TEST_CASE("the error falls as fast as edges allow, and adaptive sampling keeps its word", "[slow]") {
    struct Case {
        bool soft_shadow;
        double exponent;
    };
    for (const auto& [soft_shadow, exponent] : {Case{false, 0.70}, Case{true, 0.60}}) {
        StandInPicture picture;
        picture.width = 48, picture.height = 36;
        picture.soft_shadow = soft_shadow;
        const std::vector<Colour> reference = reference_of(picture);
        const test::ErrorLadder uniform = uniform_ladder(picture, reference);
        INFO((soft_shadow ? "soft shadow" : "edges") << ": exponent " << uniform.exponent(4, 256));
        CHECK(uniform.exponent(4, 256) >= exponent);

        for (const double tolerance : {0.1, 0.03, 0.01}) {
            Frame frame = picture.frame();
            SamplingPlan plan;
            plan.error = tolerance;
            const RenderReport report = picture.render(frame, plan);
            const auto [rmse, within_twice] = difference(frame, reference, tolerance);
            INFO("asked " << tolerance << ", measured " << rmse << ", within twice " << within_twice);
            CHECK(rmse <= tolerance);
            CHECK(within_twice >= 0.99);
            CHECK(report.within_error >= 0.98 * static_cast<double>(report.pixels));
        }
    }
}

TEST_CASE("place in the pixel and place on a light leave no bias", "[slow]") {
    // A slanted edge across both pairs of dimensions: tied pairs would leave a floor.
    constexpr double truth = 1 - 0.9 * 0.9 / 2;
    const auto beyond_edge = [](const SampleKey& key) {
        const SamplePair pixel = sample_pair(key, dimension_pair::pixel), light = sample_pair(key, dimension_pair::first_light);
        return pixel.u + light.u > 0.9 ? 1.0 : 0.0;
    };
    double previous = 1;
    for (const std::uint32_t samples : {64u, 256u, 1024u, 4096u}) {
        double squares = 0;
        constexpr int pixels = 256;
        for (int pixel = 0; pixel < pixels; ++pixel) {
            double sum = 0;
            for (std::uint32_t i = 0; i < samples; ++i) sum += beyond_edge(sample_key(pixel, 3, i));
            squares += std::pow(sum / samples - truth, 2) / pixels;
        }
        const double rmse = std::sqrt(squares);
        CHECK(rmse < 0.7 * previous);
        previous = rmse;
    }
    // Random sampling would have 0.0077 here.
    CHECK(previous < 0.0015);
}
