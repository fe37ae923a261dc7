// SPDX-License-Identifier: MIT
//
// A picture in squares: tiles of 32 x 32 pixels, which threads share, of parts of 16 x 16 pixels, whose rays travel together, of
// blocks of 8 x 8 pixels, a bit for each of which fits a word. Both the blocks of a tile and the pixels of a block or a part are
// walked along the Z-shaped curve of Morton: what is close together in time is close together in the picture.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "kernel/interfaces/output.h"

namespace lapidary {

inline constexpr int tile_size = 32;
inline constexpr int block_size = 8;
inline constexpr std::size_t pixels_of_block = 64, blocks_of_tile = 16;
inline constexpr int part_size = 16;
inline constexpr std::size_t pixels_of_part = 256;

struct PixelPlace {
    int x = 0, y = 0;
};

inline PixelRegion intersection(const PixelRegion& a, const PixelRegion& b) {
    return {std::max(a.x0, b.x0), std::max(a.y0, b.y0), std::min(a.x1, b.x1), std::min(a.y1, b.y1)};
}

inline PixelRegion grown(const PixelRegion& region, int margin) {
    return {region.x0 - margin, region.y0 - margin, region.x1 + margin, region.y1 + margin};
}

inline std::size_t pixel_count(const PixelRegion& region) {
    if (region.is_empty()) return 0;
    return static_cast<std::size_t>(region.width()) * static_cast<std::size_t>(region.height());
}

inline bool is_in(PixelPlace place, const PixelRegion& region) {
    return place.x >= region.x0 && place.x < region.x1 && place.y >= region.y0 && place.y < region.y1;
}

// Parts of the tiles that the whole picture is divided into.
inline std::vector<PixelRegion> tiles_of(const PixelRegion& region) {
    std::vector<PixelRegion> tiles;
    if (region.is_empty()) return tiles;
    for (int y = region.y0 / tile_size * tile_size; y < region.y1; y += tile_size)
        for (int x = region.x0 / tile_size * tile_size; x < region.x1; x += tile_size)
            tiles.push_back(intersection({x, y, x + tile_size, y + tile_size}, region));
    return tiles;
}

// The first `count` places along the curve.
template <std::size_t count>
constexpr std::array<PixelPlace, count> places_along_curve() {
    std::array<PixelPlace, count> places;
    for (unsigned code = 0; code < count; ++code)
        for (unsigned bit = 0; bit < 4; ++bit) {  // the even bits make x, the odd ones y
            places[code].x |= static_cast<int>((code >> 2 * bit & 1u) << bit);
            places[code].y |= static_cast<int>((code >> (2 * bit + 1) & 1u) << bit);
        }
    return places;
}
inline constexpr std::array<PixelPlace, pixels_of_block> places_in_block = places_along_curve<pixels_of_block>();
inline constexpr std::array<PixelPlace, pixels_of_part> places_in_part = places_along_curve<pixels_of_part>();
inline constexpr std::array<PixelPlace, blocks_of_tile> blocks_in_tile = places_along_curve<blocks_of_tile>();

// Where a place is among those along the curve.
constexpr std::size_t number_along_curve(int x, int y) {
    std::size_t number = 0;
    for (unsigned bit = 0; bit < 4; ++bit)
        number |= (static_cast<std::size_t>(x >> bit & 1) << 2 * bit) | (static_cast<std::size_t>(y >> bit & 1) << (2 * bit + 1));
    return number;
}

// Some of the pixels of a tile, at first none: a bit for each of a block's, in a word for each block.
class PixelSet {
public:
    void fill() { blocks_.fill(~std::uint64_t{0}); }
    bool is_empty() const {
        return std::ranges::all_of(blocks_, [](std::uint64_t block) { return block == 0; });
    }

    void clear() { blocks_.fill(0); }
    void add(PixelPlace place) { blocks_[block_of(place)] |= bit_of(place); }
    bool contains(PixelPlace place) const { return (blocks_[block_of(place)] & bit_of(place)) != 0; }

    // Takes the pixels out of the set that lie in a part of the tile and of which `is_of_no_more_interest(place, index)` says so,
    // with the index in the block row by row. Calls `begin(first)` before it comes to the first pixel of a block, with the
    // block's top left.
    template <typename Begin, typename Test>
    void remove_if(const PixelRegion& part, Begin&& begin, Test&& is_of_no_more_interest) {
        for (std::size_t i = 0; i < blocks_of_tile; ++i) {
            const PixelPlace first = first_of(i, part);
            const std::uint64_t pixels = blocks_[i] & within(part, first);
            if (pixels == 0) continue;
            begin(first);
            for (std::uint64_t left = pixels; left != 0; left &= left - 1) {
                const PixelPlace& in_block = places_in_block[static_cast<std::size_t>(std::countr_zero(left))];
                if (is_of_no_more_interest(
                        PixelPlace{first.x + in_block.x, first.y + in_block.y},
                        static_cast<std::size_t>(in_block.y) * block_size + static_cast<std::size_t>(in_block.x)))
                    blocks_[i] &= ~(left & -left);
            }
        }
    }

    // Calls `visit(place)` for all of the pixels that lie in a part of the tile.
    template <typename Visit>
    void for_each(const PixelRegion& part, Visit&& visit) const {
        for (std::size_t i = 0; i < blocks_of_tile; ++i) {
            const PixelPlace first = first_of(i, part);
            for (std::uint64_t pixels = blocks_[i] & within(part, first); pixels != 0; pixels &= pixels - 1) {
                const PixelPlace& in_block = places_in_block[static_cast<std::size_t>(std::countr_zero(pixels))];
                visit(PixelPlace{first.x + in_block.x, first.y + in_block.y});
            }
        }
    }

private:
    static std::size_t block_of(PixelPlace place) {
        return number_along_curve(place.x % tile_size / block_size, place.y % tile_size / block_size);
    }
    static std::uint64_t bit_of(PixelPlace place) {
        return std::uint64_t{1} << number_along_curve(place.x % block_size, place.y % block_size);
    }
    static PixelPlace first_of(std::size_t block, const PixelRegion& part) {
        return {part.x0 / tile_size * tile_size + blocks_in_tile[block].x * block_size,
                part.y0 / tile_size * tile_size + blocks_in_tile[block].y * block_size};
    }

    // The pixels of a block that lie in a region.
    static std::uint64_t within(const PixelRegion& region, PixelPlace first) {
        if (region.x0 <= first.x && region.y0 <= first.y && region.x1 >= first.x + block_size &&
            region.y1 >= first.y + block_size)
            return ~std::uint64_t{0};
        std::uint64_t pixels = 0;
        for (std::size_t i = 0; i < pixels_of_block; ++i)
            pixels |= std::uint64_t{is_in({first.x + places_in_block[i].x, first.y + places_in_block[i].y}, region)} << i;
        return pixels;
    }

    std::array<std::uint64_t, blocks_of_tile> blocks_{};
};

}  // namespace lapidary
