// SPDX-License-Identifier: MIT
//
// The pixels of an area between passes: what is known of each, and what they and those around them say of their errors.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "kernel/render/pixel_estimate.h"
#include "kernel/render/tile.h"
#include "kernel/render/zero_memory.h"

namespace lapidary {

// As much as a line of the processor's cache.
struct Pixel {
    PixelEstimate estimate;
    double variance = 0;                                   // of its samples, after the last pass
    float moves = no_moves;                                // of its colour, as remembered_moves() keeps them
    float error = std::numeric_limits<float>::infinity();  // as estimated last
    std::uint32_t taken = 0;                               // samples traced, also those that were not finite
    std::uint32_t followed = 0;                            // rays traced before, along edges

    // Where edges tell its colour well enough: that stands for its samples.
    void begin_with(const Colour& colour) { estimate.add(colour); }
    std::uint32_t rays() const { return taken + followed; }
};

static_assert(sizeof(Pixel) == 64);

class PixelField {
public:
    // Errors of the pixels of a block, row by row.
    using BlockErrors = std::array<double, pixels_of_block>;

    void resize(const PixelRegion& area, bool has_negative_lobes);
    bool is_empty() const { return pixels_.empty(); }

    std::size_t index_of(PixelPlace place) const {
        return static_cast<std::size_t>(place.y - area_.y0) * static_cast<std::size_t>(area_.width()) +
               static_cast<std::size_t>(place.x - area_.x0);
    }
    Pixel& operator[](std::size_t index) { return pixels_[index]; }
    const Pixel& operator[](std::size_t index) const { return pixels_[index]; }
    Pixel& operator[](PixelPlace place) { return pixels_[index_of(place)]; }

    // Where the samples in negative lobes of the filter are collected.
    PixelEstimate& negative_of(const Pixel& pixel) { return negative_[static_cast<std::size_t>(&pixel - pixels_.data())]; }

    Colour colour_of(std::size_t index) const {
        return negative_.empty() ? pixels_[index].estimate.mean() : colour_without_negative(index);
    }

    // By the witnesses of pixel_estimate.h. The `first_samples` of a pixel cannot have moved its colour.
    void estimate_errors(PixelPlace block, std::uint32_t first_samples, BlockErrors& errors) const;

private:
    struct Window;
    using Row = std::array<double, block_size>;

    Colour colour_without_negative(std::size_t index) const;
    void look_around(PixelPlace block, std::uint32_t first_samples, Window& window) const;
    static void estimate_by_samples(const Window& window, std::size_t row, std::uint32_t first_samples,
                                    std::span<double, block_size> errors);
    static Row mean_moves(const Window& window, std::size_t row);

    PixelRegion area_;
    std::vector<Pixel, PixelMemory<Pixel>> pixels_;
    std::vector<PixelEstimate> negative_;  // for filters that have negative lobes
};

}  // namespace lapidary
