// SPDX-License-Identifier: MIT
//
// World + Camera -> Frame: samples, tiles over threads, progress, cancellation.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>

#include "kernel/export.h"
#include "kernel/interfaces/output.h"
#include "kernel/render/frame.h"
#include "kernel/render/tracer.h"
#include "kernel/scene/scene.h"

namespace lapidary {

class World;

struct RenderOptions {
    int threads = 0;                                       // 0: as many as the machine has
    std::optional<PixelRegion> region;                     // nothing: the whole picture
    std::optional<int> samples;                            // --samples: exactly this many a pixel
    std::optional<double> error;                           // --error: overrides the scene's
    std::optional<std::chrono::duration<double>> time;     // --time: the best picture in that time
    std::function<std::chrono::duration<double>()> clock;  // what time is told by, asked from any thread; nothing: the wall's
    std::uint32_t sequence = 0;                            // another one renders the picture with independent samples
    const std::atomic<bool>* cancel = nullptr;             // set from anywhere; noticed within 50 ms
    bool one_by_one = false;                               // no packets of rays: what these are compared with
    bool preview = false;  // begin with a coarse picture of the whole region, for somebody who looks on
    // Called once, by the first thread that traces rays, or after the first coarse picture: all that a render sets up for
    // itself is there.
    std::function<void()> on_begin;
    // Called whenever a tile has changed, one at a time, while only that tile may be read: its first samples, then each
    // refinement.
    std::function<void(const Frame& frame, const PixelRegion& tile)> on_tile;
};

struct RenderReport {
    bool complete = false;  // false: cancelled, or the time was too short for a sample of every pixel
    std::size_t pixels = 0, finished = 0;
    std::size_t within_error = 0;  // pixels that met the bound
    std::uint64_t samples = 0;
    double seconds = 0;                // on the clock
    std::optional<double> first_view;  // seconds until the first coarse picture was whole; nothing where there was none
    double processor_seconds = 0;      // of all rendering threads together
    TraceStatistics trace;
};

// Same bits for any number of threads, any region.
LAPIDARY_API RenderReport render(const World& world, const Scene& scene, Frame& frame, const RenderOptions& options);

}  // namespace lapidary
