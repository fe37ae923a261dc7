// SPDX-License-Identifier: MIT
//
// Boxes in blocks of eight, and blocks of such blocks above many of them: which of them does a small box overlap?
//
// Eight boxes stand in lanes, so that a plain loop over them becomes vector instructions. They are kept as floats relative to
// an anchor, rounded outward.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "kernel/math/bounds.h"
#include "kernel/math/outward.h"

namespace lapidary {

struct alignas(32) BoxBlock {
    static constexpr int width = 8;
    using Floats = std::array<float, width>;
    Floats low_x, low_y, low_z, high_x, high_y, high_z;
    std::array<std::int32_t, width> content{};  // a block; or, where negative, ~number of a box
    std::int32_t count = 0;
};

// Adds blocks over boxes numbered from 0; returns the topmost one.
std::int32_t add_box_blocks(std::span<const Bounds> boxes, const Point& anchor, std::vector<BoxBlock>& blocks);

// What the floats of a solid's blocks are relative to.
inline Point anchor_of_blocks(const Bounds& box) { return box.is_finite() ? box.centre() : Point{}; }

// Calls visit(number) for the boxes below a block that overlap `query`.
template <class Visit>
void for_each_overlapping(const std::vector<BoxBlock>& blocks, std::int32_t top, const Bounds& query, const Point& anchor,
                          Visit visit) {
    const float low_x = float_below(query.low.x - anchor.x), high_x = float_above(query.high.x - anchor.x);
    const float low_y = float_below(query.low.y - anchor.y), high_y = float_above(query.high.y - anchor.y);
    const float low_z = float_below(query.low.z - anchor.z), high_z = float_above(query.high.z - anchor.z);
    std::array<std::int32_t, 128> stack;  // each level of at most ten leaves seven behind
    int size = 0;
    stack[size++] = top;
    while (size > 0) {
        const BoxBlock& block = blocks[stack[--size]];
        unsigned overlaps = 0;
        for (unsigned i = 0; i < BoxBlock::width; ++i) {
            const bool overlap = (low_x <= block.high_x[i]) & (block.low_x[i] <= high_x) & (low_y <= block.high_y[i]) &
                                 (block.low_y[i] <= high_y) & (low_z <= block.high_z[i]) & (block.low_z[i] <= high_z);
            overlaps |= (overlap ? 1u : 0u) << i;
        }
        for (; overlaps != 0; overlaps &= overlaps - 1) {
            const std::int32_t content = block.content[std::countr_zero(overlaps)];
            if (content < 0)
                visit(~content);
            else
                stack[size++] = content;
        }
    }
}

}  // namespace lapidary
