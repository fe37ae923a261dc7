// SPDX-License-Identifier: MIT
#include "kernel/render/filter.h"

#include <algorithm>
#include <cmath>

namespace lapidary {

namespace {

using Shape = RenderSettings::Filter;

// A bell that is cut off at three standard deviations, lowered so that it ends at zero.
double gaussian(double x, double radius) {
    const double deviations = 3 * x / radius;
    return std::exp(-deviations * deviations / 2) - std::exp(-4.5);
}

// Mitchell and Netravali 1988 with B = C = 1/3, stretched to the radius (2 in the paper).
double mitchell(double x, double radius) {
    const double t = 2 * std::fabs(x) / radius;
    if (t < 1) return (7 * t * t * t - 12 * t * t + 16.0 / 3) / 6;
    return (-7.0 / 3 * t * t * t + 12 * t * t - 20 * t + 32.0 / 3) / 6;
}

}  // namespace

double default_radius(Shape shape) {
    switch (shape) {
        case Shape::box:
            return 0.5;
        case Shape::gaussian:
            return 1.5;
        case Shape::mitchell:
            return 2;
    }
    return 0.5;
}

PixelFilter::PixelFilter(Shape shape, double radius) : radius_(radius) {
    if (shape == Shape::box) return;

    // Tabulate |f| at the middles of narrow cells and add up.
    constexpr int cells = 1024;
    cumulative_.assign(cells + 1, 0);
    negative_.assign(cells, false);
    for (int i = 0; i < cells; ++i) {
        const double x = ((i + 0.5) / cells * 2 - 1) * radius_;
        const double f = shape == Shape::gaussian ? gaussian(x, radius_) : mitchell(x, radius_);
        const auto cell = static_cast<std::size_t>(i);
        negative_[cell] = f < 0;
        has_negative_lobes_ |= f < 0;
        cumulative_[cell + 1] = cumulative_[cell] + std::fabs(f);
    }
    const double total = cumulative_.back();
    for (double& value : cumulative_) value /= total;
}

PixelFilter::Position PixelFilter::position(double u) const {
    if (cumulative_.empty()) return {(2 * u - 1) * radius_, false};

    // The cell that holds u, and how far u lies into it.
    const auto above = std::upper_bound(cumulative_.begin() + 1, cumulative_.end() - 1, u);
    const auto cell = static_cast<std::size_t>(above - cumulative_.begin()) - 1;
    const double width = cumulative_[cell + 1] - cumulative_[cell];
    const double part = width > 0 ? (u - cumulative_[cell]) / width : 0.5;
    return {((static_cast<double>(cell) + part) / static_cast<double>(negative_.size()) * 2 - 1) * radius_, negative_[cell]};
}

PixelFilter::Placement PixelFilter::place(SamplePair square) const {
    const Position across = position(square.u);
    const Position down = position(square.v);
    return {across.x, down.x, across.negative != down.negative};
}

}  // namespace lapidary
