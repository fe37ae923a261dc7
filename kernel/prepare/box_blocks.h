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

#include "kernel/export.h"
#include "kernel/math/bounds.h"
#include "kernel/math/float_box.h"

namespace lapidary {

struct alignas(32) BoxBlock {
    static constexpr int width = 8;
    using Floats = std::array<float, width>;
    Floats low_x, low_y, low_z, high_x, high_y, high_z;
    std::array<std::int32_t, width> content{};  // a block; or, where negative, ~number of a box
    std::int32_t count = 0;
};

// Adds blocks over boxes numbered from 0; returns the topmost one.
LAPIDARY_API std::int32_t add_box_blocks(std::span<const Bounds> boxes, const Point& anchor, std::vector<BoxBlock>& blocks);

// What the floats of a solid's blocks are relative to.
inline Point anchor_of_blocks(const Bounds& box) { return box.is_finite() ? box.centre() : Point{}; }

// Which boxes of a block overlap another one: bit i for box i.
LAPIDARY_API std::uint32_t overlapping(const BoxBlock& block, const FloatBox& box);

// Calls visit(number) for the boxes below a block that overlap `query`.
template <class Visit>
void for_each_overlapping(const std::vector<BoxBlock>& blocks, std::int32_t top, const Bounds& query, const Point& anchor,
                          Visit visit) {
    if (query.is_empty()) return;
    const FloatBox box(query, anchor);
    std::array<std::int32_t, 128> stack;  // each level of at most ten leaves seven behind
    int size = 0;
    stack[size++] = top;
    while (size > 0) {
        const BoxBlock& block = blocks[stack[--size]];
        for (std::uint32_t bits = overlapping(block, box); bits != 0; bits &= bits - 1) {
            const std::int32_t content = block.content[std::countr_zero(bits)];
            if (content < 0)
                visit(~content);
            else
                stack[size++] = content;
        }
    }
}

}  // namespace lapidary
