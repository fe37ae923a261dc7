// SPDX-License-Identifier: MIT
//
// Time against error: pictures at a ladder of errors, each measured against a reference that is far closer to the truth.
//
// The reference takes many samples of every pixel, none of them one of the measured pictures' (RenderOptions::sequence):
// an error that both share would go unseen. It is made of two halves, whose difference tells how far it is off itself. That
// adds to the measured errors; it never hides any. Differences are those that the promise is about: the root mean square over a
// pixel's channels, absolute up to white, relative to the brightest channel above.
#pragma once

#include <atomic>
#include <functional>
#include <vector>

#include "kernel/render/render.h"

namespace lapidary {

// How far a picture is off.
struct MeasuredError {
    double rmse = 0, largest = 0;
    double within_twice = 0;  // share of the pixels that are off by at most twice the error asked for
};

struct ConvergencePoint {
    double requested = 0;
    MeasuredError measured;
    double samples_per_pixel = 0;
    double seconds = 0, processor_seconds = 0;

    // RMSE at most what was asked for, 99 % of the pixels within twice of it.
    bool keeps_promise() const { return measured.rmse <= requested && measured.within_twice >= 0.99; }
};

struct ConvergenceOptions {
    std::vector<double> errors;
    int reference_samples = 4096;
    int threads = 0;
    const std::atomic<bool>* cancel = nullptr;
    std::function<void(const ConvergencePoint&)> on_point;
};

struct Convergence {
    bool complete = false;       // false: cancelled; the points are those until then
    double reference_error = 0;  // how far the reference itself is off: RMSE
    double reference_seconds = 0;
    std::vector<ConvergencePoint> points;
};

MeasuredError measure_error(const Frame& picture, const Frame& reference, double requested);
Convergence measure_convergence(const World& world, const Scene& scene, const ConvergenceOptions& options);

}  // namespace lapidary
