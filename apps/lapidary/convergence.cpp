// SPDX-License-Identifier: MIT
#include "apps/lapidary/convergence.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "kernel/render/pixel_estimate.h"

namespace lapidary {

namespace {

// Other samples than the pictures', and than each other's.
constexpr std::array<std::uint32_t, 2> reference_sequences{1, 2};

Colour colour_at(const Frame& frame, int x, int y) {
    const auto channels = frame.pixel(Layer::colour, x, y);
    return {channels[0], channels[1], channels[2]};
}

RenderOptions common_options(const ConvergenceOptions& options) {
    RenderOptions common;
    common.threads = options.threads;
    common.cancel = options.cancel;
    return common;
}

// The mean of two pictures. They are independent and equally good: it is off by half of what they differ by.
struct Reference {
    explicit Reference(const Scene& scene) : mean(scene.output.width, scene.output.height, {}) {}

    Frame mean;
    double error = 0, seconds = 0;
    bool complete = false;
};

void average(const Frame& a, const Frame& b, Frame& mean) {
    for (int y = 0; y < mean.height(); ++y)
        for (int x = 0; x < mean.width(); ++x)
            std::ranges::transform(a.pixel(Layer::colour, x, y), b.pixel(Layer::colour, x, y),
                                   mean.pixel(Layer::colour, x, y).begin(), [](float u, float v) { return (u + v) / 2; });
}

void render_reference(const World& world, const Scene& scene, const ConvergenceOptions& options, Reference& reference) {
    Frame first(scene.output.width, scene.output.height, {}), second(scene.output.width, scene.output.height, {});
    RenderOptions of_reference = common_options(options);
    of_reference.samples = std::max(1, options.reference_samples / 2);
    for (Frame* const half : {&first, &second}) {
        of_reference.sequence = half == &first ? reference_sequences[0] : reference_sequences[1];
        const RenderReport report = render(world, scene, *half, of_reference);
        reference.seconds += report.seconds;
        if (!report.complete) return;
    }
    average(first, second, reference.mean);
    reference.error = measure_error(first, second, 1).rmse / 2;
    reference.complete = true;
}

}  // namespace

MeasuredError measure_error(const Frame& picture, const Frame& reference, double requested) {
    MeasuredError measured;
    double squares = 0;
    std::size_t within_twice = 0;
    for (int y = 0; y < reference.height(); ++y)
        for (int x = 0; x < reference.width(); ++x) {
            const Colour truth = colour_at(reference, x, y);
            const double error = contrast(colour_at(picture, x, y), truth) / brightness_scale(truth);
            squares += error * error;
            measured.largest = std::max(measured.largest, error);
            within_twice += error <= 2 * requested;
        }
    const auto pixels = static_cast<double>(reference.width()) * reference.height();
    measured.rmse = std::sqrt(squares / pixels);
    measured.within_twice = static_cast<double>(within_twice) / pixels;
    return measured;
}

Convergence measure_convergence(const World& world, const Scene& scene, const ConvergenceOptions& options) {
    Convergence convergence;
    Reference reference(scene);
    render_reference(world, scene, options, reference);
    if (!reference.complete) return convergence;
    convergence.reference_error = reference.error;
    convergence.reference_seconds = reference.seconds;

    for (const double error : options.errors) {
        Frame picture(scene.output.width, scene.output.height, {});
        RenderOptions of_picture = common_options(options);
        of_picture.error = error;
        const RenderReport report = render(world, scene, picture, of_picture);
        if (!report.complete) return convergence;

        const double samples_per_pixel = static_cast<double>(report.samples) / static_cast<double>(report.pixels);
        convergence.points.push_back(
            {error, measure_error(picture, reference.mean, error), samples_per_pixel, report.seconds, report.processor_seconds});
        if (options.on_point) options.on_point(convergence.points.back());
    }
    convergence.complete = true;
    return convergence;
}

}  // namespace lapidary
