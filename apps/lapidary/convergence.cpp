// SPDX-License-Identifier: MIT
#include "apps/lapidary/convergence.h"

#include <algorithm>
#include <cmath>

#include "kernel/render/pixel_estimate.h"

namespace lapidary {

namespace {

constexpr std::uint32_t reference_sequence = 1;

Colour colour_at(const Frame& frame, int x, int y) {
    const auto channels = frame.pixel(Layer::colour, x, y);
    return {channels[0], channels[1], channels[2]};
}

// Of the estimates in the layer of errors.
double estimated_rmse(const Frame& frame) {
    double squares = 0;
    for (const float error : frame.layer(Layer::error))
        if (std::isfinite(error)) squares += static_cast<double>(error) * error;
    return std::sqrt(squares / static_cast<double>(frame.layer(Layer::error).size()));
}

RenderOptions common_options(const ConvergenceOptions& options) {
    RenderOptions common;
    common.threads = options.threads;
    common.cancel = options.cancel;
    return common;
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
    const int width = scene.output.width, height = scene.output.height;

    Frame reference(width, height, {Layer::error});
    RenderOptions of_reference = common_options(options);
    of_reference.samples = options.reference_samples;
    of_reference.sequence = reference_sequence;
    const RenderReport reference_report = render(world, scene, reference, of_reference);
    if (!reference_report.complete) return convergence;
    convergence.reference_error = estimated_rmse(reference);
    convergence.reference_seconds = reference_report.seconds;

    for (const double error : options.errors) {
        Frame picture(width, height, {});
        RenderOptions of_picture = common_options(options);
        of_picture.error = error;
        const RenderReport report = render(world, scene, picture, of_picture);
        if (!report.complete) return convergence;

        const double samples_per_pixel = static_cast<double>(report.samples) / static_cast<double>(report.pixels);
        convergence.points.push_back(
            {error, measure_error(picture, reference, error), samples_per_pixel, report.seconds, report.processor_seconds});
        if (options.on_point) options.on_point(convergence.points.back());
    }
    convergence.complete = true;
    return convergence;
}

}  // namespace lapidary
