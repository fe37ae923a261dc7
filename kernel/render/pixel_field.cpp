// SPDX-License-Identifier: MIT
#include "kernel/render/pixel_field.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "kernel/math/vector.h"

namespace lapidary {

namespace {

constexpr int window_size = block_size + 2;

// Calls `visit(y, x)` for the nine places around and at one, from (0, 0) to (2, 2), all written out: what they find stays in
// registers.
template <typename Visit>
void for_each_around(Visit&& visit) {
    [&]<std::size_t... place>(std::index_sequence<place...>) { (visit(place / 3, place % 3), ...); }
    (std::make_index_sequence<9>());
}

}  // namespace

// A block's pixels and those around it, one array for each number, so that loops over the pixels of a row become vector
// instructions.
struct PixelField::Window {
    using Numbers = std::array<std::array<double, window_size>, window_size>;
    Numbers r, g, b;   // not a number where there is nothing
    Numbers variance;  // 0 where there is nothing
    Numbers count, taken, moves;
    bool has_moved = false;  // some pixel has taken more than the first samples
};

void PixelField::resize(const PixelRegion& area, bool has_negative_lobes) {
    area_ = area;
    pixels_.resize(pixel_count(area));
    if (has_negative_lobes) negative_.resize(pixels_.size());
}

// (p·positive - n·negative) / (p - n), exact where both are equal.
Colour PixelField::colour_without_negative(std::size_t index) const {
    const PixelEstimate& estimate = pixels_[index].estimate;
    const PixelEstimate& negative = negative_[index];
    if (negative.count() == 0 || 2 * negative.count() > estimate.count()) return estimate.mean();
    const double weight = static_cast<double>(negative.count()) / (estimate.count() - negative.count());
    return estimate.mean() + weight * (estimate.mean() - negative.mean());
}

void PixelField::look_around(PixelPlace block, std::uint32_t first_samples, Window& window) const {
    constexpr double nothing = std::numeric_limits<double>::quiet_NaN();
    const PixelRegion around = grown({block.x, block.y, block.x + block_size, block.y + block_size}, 1);
    const PixelRegion there = intersection(around, area_);
    if (pixel_count(there) < pixel_count(around)) {
        for (Window::Numbers* numbers : {&window.r, &window.g, &window.b})
            for (auto& row : *numbers) row.fill(nothing);
        window.variance = {}, window.count = {}, window.taken = {}, window.moves = {};
    }
    for (int y = there.y0; y < there.y1; ++y)
        for (int x = there.x0; x < there.x1; ++x) {
            const auto i = static_cast<std::size_t>(y - around.y0), j = static_cast<std::size_t>(x - around.x0);
            const std::size_t index = index_of({x, y});
            const Pixel& pixel = pixels_[index];
            const Colour colour = pixel.estimate.count() > 0 ? colour_of(index) : Colour::grey(nothing);
            window.r[i][j] = colour.r, window.g[i][j] = colour.g, window.b[i][j] = colour.b;
            window.variance[i][j] = pixel.variance;
            window.count[i][j] = pixel.estimate.count();
            window.taken[i][j] = pixel.taken;
            window.moves[i][j] = pixel.moves;
            window.has_moved |= pixel.taken > first_samples;
        }
}

void PixelField::estimate_errors(PixelPlace block, std::uint32_t first_samples, BlockErrors& errors) const {
    Window window;
    look_around(block, first_samples, window);
    for (std::size_t row = 0; row < block_size; ++row)
        estimate_by_samples(window, row, first_samples, std::span(errors).subspan(row * block_size).first<block_size>());
}

// A pixel's own spread counts among those around it, too: of two samples or more, its own error by it is greater anyway.
void PixelField::estimate_by_samples(const Window& window, std::size_t row, std::uint32_t first_samples,
                                     std::span<double, block_size> errors) {
    const Row moves = window.has_moved ? mean_moves(window, row) : Row{};
    for (std::size_t i = 0; i < block_size; ++i) {
        const double count = window.count[row + 1][i + 1], own_variance = window.variance[row + 1][i + 1];
        const Colour colour{window.r[row + 1][i + 1], window.g[row + 1][i + 1], window.b[row + 1][i + 1]};
        double variance = 0, contrast = 0;  // the greatest squares
        for_each_around([&](std::size_t y, std::size_t x) {
            const double r = colour.r - window.r[row + y][i + x];
            const double g = colour.g - window.g[row + y][i + x];
            const double b = colour.b - window.b[row + y][i + x];
            contrast = std::max(contrast, r * r + g * g + b * b);
            variance = std::max(variance, window.variance[row + y][i + x]);
        });
        const double own = error_from_spread(std::sqrt(own_variance), count);
        const double around = error_from_around(std::sqrt(variance), std::sqrt(contrast / 3), count);
        const double change = window.taken[row + 1][i + 1] > first_samples ? std::sqrt(moves[i]) : 0;
        const double error = std::max(std::max(own, around), change) / brightness_scale(colour);
        errors[i] = count > 0 ? error : infinity;
    }
}

// Over those around each pixel that have taken as many samples.
PixelField::Row PixelField::mean_moves(const Window& window, std::size_t row) {
    Row mean;
    for (std::size_t i = 0; i < block_size; ++i) {
        double moves = 0, movers = 0;
        for_each_around([&](std::size_t y, std::size_t x) {
            const bool is_alike = window.taken[row + y][i + x] == window.taken[row + 1][i + 1];
            moves += is_alike ? window.moves[row + y][i + x] : 0;
            movers += is_alike ? 1 : 0;
        });
        mean[i] = moves / movers;
    }
    return mean;
}

}  // namespace lapidary
