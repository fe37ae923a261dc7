// SPDX-License-Identifier: MIT
//
// Reconstruction filters, by importance sampling: a pixel's samples are placed where its filter has weight, so that
// every sample counts alike, samples are never shared between pixels, and a pixel stays a function of its own samples.
// A filter is the product of f(x) and f(y), x and y the distance from the pixel's centre in pixels.
//
// Where f is negative (the lobes of Mitchell's filter) samples are drawn from |f| and count as negative.
#pragma once

#include <vector>

#include "kernel/export.h"
#include "kernel/render/sampler.h"
#include "kernel/scene/scene.h"

namespace lapidary {

class LAPIDARY_API PixelFilter {
public:
    PixelFilter(RenderSettings::Filter shape, double radius);

    struct Placement {
        double x = 0, y = 0;    // from the pixel's centre, in pixels
        bool negative = false;  // the sample stands in a negative lobe
    };
    Placement place(SamplePair square) const;

    double radius() const { return radius_; }
    // It weighs all places of the pixel alike, and no other ones.
    bool is_pixel() const { return cumulative_.empty() && radius_ == 0.5; }
    bool has_negative_lobes() const { return has_negative_lobes_; }

private:
    struct Position {
        double x;
        bool negative;
    };
    Position position(double u) const;

    double radius_;
    bool has_negative_lobes_ = false;
    std::vector<double> cumulative_;  // of |f| over -radius … radius, from 0 to 1; empty for the box
    std::vector<bool> negative_;      // of each cell between two values
};

// The radius that a filter has where the scene gives none.
LAPIDARY_API double default_radius(RenderSettings::Filter shape);

}  // namespace lapidary
