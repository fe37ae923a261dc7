// SPDX-License-Identifier: MIT
//
// The passes that a picture is made of. All of them are deterministic functions of the integrand; threads only share
// the work of one pass.
//
// - Preview (on demand): one ray for each block of pixels, blocks from coarse to fine; overwritten later.
// - With a fixed number of samples: one pass in which every pixel takes all of them.
// - Adaptive: a first pass takes a few samples of every pixel; for small errors a second one takes as many again. Then,
//   again and again, every pixel whose estimated error is above the tolerance doubles its samples, where the estimates of a
//   pass are made from the state *between* passes. Whether a pixel goes on in pass k depends on its neighbours after pass
//   k-1, those on theirs after pass k-2 …, never on tiles. A region therefore renders a margin around itself: pixels at
//   distance d take part in the first K-d of at most K passes, and every pixel of the region ends bit for bit as in the full
//   picture. Margin pixels that are flat cost the first passes only.
//   A coarse picture begins with the middles of the pixels and the edges between them (edge_grid.h), where these depend on
//   nothing else. Only what no grid tells well enough takes samples.
// - Against the clock: the same with a tolerance that is halved again and again until the time is up.
//
// Tiles are walked along a Z-shaped curve, so that consecutive rays lie close together; they are traced in batches that
// are small enough to notice a cancellation in time.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>

#include "kernel/export.h"
#include "kernel/render/camera_rays.h"
#include "kernel/render/filter.h"
#include "kernel/render/frame.h"
#include "kernel/render/render.h"

namespace lapidary {

// What is integrated over each pixel: rays to samples. One per thread; what it returns for a ray depends on nothing but
// the ray. Samples that were under way at a cancellation are not looked at.
class Integrand {
public:
    virtual ~Integrand() = default;
    // Ray i stands in lane i % width of packet i / width; all packets but the last are full. `faces` is empty where only colours
    // are wanted, else as long as `colours`.
    virtual void trace(std::span<const RayPacket> rays, std::span<Colour> colours, std::span<FirstFace> faces) = 0;
    // The rays to come lie within a tile's beam; null: anywhere.
    virtual void begin_tile(const Beam*) {}
    // Of these, the next within a part of it. The colour that all of them bring back from nowhere, where it is known that they
    // meet nothing: they need not be traced.
    // `in_quarters`: each quarter of the packets holds rays of one of the part's: left before right, top before bottom.
    virtual std::optional<Colour> begin_part(const Beam*, bool in_quarters [[maybe_unused]]) { return std::nullopt; }
    virtual TraceStatistics statistics() const { return {}; }
};

using IntegrandMaker = std::function<std::unique_ptr<Integrand>()>;

struct SamplingPlan {
    int samples = 0;                       // of every pixel; 0: as many as the error asks for
    double error = 0.004;                  // where samples is 0
    bool refine_until_time_is_up = false;  // as good as the time allows, with samples 0
    bool lights_are_sampled = false;       // what a ray brings back depends on its number, too
    bool rays_are_bent = false;            // something is transparent

    bool has_error_to_reach() const { return samples == 0 && !refine_until_time_is_up; }
};

LAPIDARY_API SamplingPlan plan_sampling(const Scene& scene, const RenderOptions& options);

LAPIDARY_API RenderReport render_passes(const IntegrandMaker& make_integrand, const CameraRays& camera, const PixelFilter& filter,
                                        const SamplingPlan& plan, Frame& frame, const RenderOptions& options);

}  // namespace lapidary
