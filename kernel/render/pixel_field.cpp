// SPDX-License-Identifier: MIT
#include "kernel/render/pixel_field.h"

#include <algorithm>
#include <cmath>

#include "kernel/math/vector.h"

namespace lapidary {

namespace {

constexpr int window_size = block_size + 2;
using Row = std::array<double, block_size>;

}  // namespace

// A block's pixels and those around it, one array for each number, so that loops over the pixels of a row become vector
// instructions.
struct PixelField::Window {
    using Numbers = std::array<std::array<double, window_size>, window_size>;
    Numbers r, g, b;   // not a number where there is nothing
    Numbers variance;  // 0 where there is nothing
    Numbers count, taken, moves;
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

void PixelField::look_around(PixelPlace block, Window& window) const {
    constexpr double nothing = std::numeric_limits<double>::quiet_NaN();
    for (int row = 0; row < window_size; ++row)
        for (int column = 0; column < window_size; ++column) {
            const PixelPlace place{block.x + column - 1, block.y + row - 1};
            const bool is_there = is_in(place, area_);
            const std::size_t index = is_there ? index_of(place) : 0;
            const auto i = static_cast<std::size_t>(row), j = static_cast<std::size_t>(column);
            const Pixel& pixel = pixels_[index];
            const auto count = is_there ? pixel.estimate.count() : 0;
            const Colour colour = count > 0 ? colour_of(index) : Colour::grey(nothing);
            window.r[i][j] = colour.r, window.g[i][j] = colour.g, window.b[i][j] = colour.b;
            window.variance[i][j] = count > 0 ? pixel.variance : 0;
            window.count[i][j] = count;
            window.moves[i][j] = pixel.moves;
            window.taken[i][j] = is_there ? pixel.taken : -1.0;
        }
}

// A pixel's own spread counts among those around it, too: of two samples or more, its own error by it is greater anyway.
void PixelField::estimate_errors(PixelPlace block, std::uint32_t first_samples, BlockErrors& errors) const {
    Window window;
    look_around(block, window);
    for (std::size_t row = 0; row < block_size; ++row) {
        Row variance{}, contrast{}, moves{}, movers{};  // the greatest squares, and sums
        for (std::size_t y = row; y < row + 3; ++y)
            for (std::size_t dx = 0; dx < 3; ++dx)
                for (std::size_t i = 0; i < block_size; ++i) {
                    const std::size_t x = i + dx;
                    const double r = window.r[row + 1][i + 1] - window.r[y][x];
                    const double g = window.g[row + 1][i + 1] - window.g[y][x];
                    const double b = window.b[row + 1][i + 1] - window.b[y][x];
                    const double square = r * r + g * g + b * b;
                    contrast[i] = contrast[i] < square ? square : contrast[i];
                    variance[i] = std::max(variance[i], window.variance[y][x]);
                    const bool is_alike = window.taken[y][x] == window.taken[row + 1][i + 1];
                    moves[i] += is_alike ? window.moves[y][x] : 0;
                    movers[i] += is_alike ? 1 : 0;
                }
        for (std::size_t i = 0; i < block_size; ++i) {
            const double count = window.count[row + 1][i + 1];
            const Colour colour{window.r[row + 1][i + 1], window.g[row + 1][i + 1], window.b[row + 1][i + 1]};
            const double own = error_from_spread(std::sqrt(window.variance[row + 1][i + 1]), count);
            const double around = error_from_around(std::sqrt(variance[i]), std::sqrt(contrast[i] / 3), count);
            const double change = window.taken[row + 1][i + 1] > first_samples ? std::sqrt(moves[i] / movers[i]) : 0;
            const double error = std::max(std::max(own, around), change) / brightness_scale(colour);
            errors[row * block_size + i] = count > 0 ? error : infinity;
        }
    }
}

}  // namespace lapidary
