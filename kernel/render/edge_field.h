// SPDX-License-Identifier: MIT
//
// What is known of the pixels of an area while edges are followed between their middles (edge_grid.h): little, as most of them
// are done with after one look.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "kernel/render/edge_grid.h"
#include "kernel/render/tile.h"
#include "kernel/render/zero_memory.h"

namespace lapidary {

class EdgeField {
public:
    struct Followed {
        float error = 0;                 // as estimated last; of middles alone, none is known
        float move = 0;                  // of its colour from one grid to the next, the greatest
        std::uint16_t rays = 0;          // that tell of the pixel
        std::uint8_t fineness = 0;       // of the grid that it was estimated from last; 0: its middle is all there is
        bool is_surprising : 1 = false;  // what was found within a cell was not what its corners suggest
        bool is_given_up : 1 = false;    // to be sampled, as no finer grid would do
    };

    void resize(const PixelRegion& area) {
        area_ = area;
        middles_.resize(pixel_count(area)), colours_.resize(pixel_count(area)), followed_.resize(pixel_count(area));
    }
    bool is_empty() const { return followed_.empty(); }
    const PixelRegion& area() const { return area_; }

    std::size_t index_of(PixelPlace place) const {
        return static_cast<std::size_t>(place.y - area_.y0) * static_cast<std::size_t>(area_.width()) +
               static_cast<std::size_t>(place.x - area_.x0);
    }
    void keep_middle(PixelPlace place, const FloatColour& colour) {
        const std::size_t index = index_of(place);
        middles_[index] = colour;
        followed_[index].rays = 1;
    }
    // The middles of a part's pixels, to be written there, and how far it is from one row of them to the next.
    FloatColour* begin_middles(const PixelRegion& part) {
        for (int y = part.y0; y < part.y1; ++y)
            std::fill_n(followed_.begin() + static_cast<std::ptrdiff_t>(index_of({part.x0, y})), part.width(),
                        Followed{.rays = 1});
        return &middles_[index_of({part.x0, part.y0})];
    }
    std::ptrdiff_t row_of_middles() const { return area_.width(); }

    const FloatColour& middle_of(PixelPlace place) const { return middles_[index_of(place)]; }
    // Of a pixel and others on its right.
    std::span<const FloatColour> middles_from(PixelPlace place, int count) const {
        return {&middles_[index_of(place)], static_cast<std::size_t>(count)};
    }
    // As estimated last; its middle's, before.
    const FloatColour& colour_of(PixelPlace place) const {
        const std::size_t index = index_of(place);
        return followed_[index].fineness > 0 ? colours_[index] : middles_[index];
    }
    void keep_colour(PixelPlace place, const FloatColour& colour, int fineness) {
        const std::size_t index = index_of(place);
        colours_[index] = colour;
        followed_[index].fineness = static_cast<std::uint8_t>(fineness);
    }
    Followed& operator[](PixelPlace place) { return followed_[index_of(place)]; }
    const Followed& operator[](PixelPlace place) const { return followed_[index_of(place)]; }
    float greatest_move_in(const PixelRegion& part) const {
        float greatest = 0;
        for (int y = part.y0; y < part.y1; ++y)
            for (int x = part.x0; x < part.x1; ++x) greatest = std::max(greatest, (*this)[{x, y}].move);
        return greatest;
    }

private:
    PixelRegion area_;
    std::vector<FloatColour, ZeroMemory<FloatColour>> middles_, colours_;
    std::vector<Followed, ZeroMemory<Followed>> followed_;
};

}  // namespace lapidary
