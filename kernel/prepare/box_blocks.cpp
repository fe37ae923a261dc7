// SPDX-License-Identifier: MIT
#include "kernel/prepare/box_blocks.h"

#include <algorithm>
#include <numeric>

namespace lapidary {

namespace {

class Builder {
public:
    Builder(std::span<const Bounds> boxes, const Point& anchor, std::vector<BoxBlock>& blocks)
        : boxes_(boxes), anchor_(anchor), blocks_(blocks) {}

    // A block over the given boxes: of each one, or of blocks that are full but for the last. Where these hold boxes, the largest
    // ones stand beside them: within a block they would make it as large.
    std::int32_t build(std::span<std::int32_t> order) {
        const auto index = static_cast<std::int32_t>(blocks_.size());
        blocks_.emplace_back();
        std::size_t share = 1;
        while (share * BoxBlock::width < order.size()) share *= BoxBlock::width;
        const std::size_t largest = share == BoxBlock::width ? begin_with_largest(order) : 0;
        for (std::size_t i = 0; i < largest; ++i) add(index, order.subspan(i, 1));
        order = order.subspan(largest);
        fill(index, order, share, (order.size() + share - 1) / share);
        for (int lane = blocks_[index].count; lane < BoxBlock::width; ++lane) set_box(index, lane, Bounds::empty());
        return index;
    }

private:
    // Of more boxes than a block has room for puts as many first as may stand in it beside blocks of the others, the largest
    // ones; returns how many.
    std::size_t begin_with_largest(std::span<std::int32_t> order) const {
        constexpr std::size_t width = BoxBlock::width;
        const std::size_t blocks = (order.size() - 2) / (width - 1), largest = width - blocks;
        const auto size = [&](std::int32_t box) {
            const Vector diagonal = boxes_[box].diagonal();
            return diagonal.x + diagonal.y + diagonal.z;
        };
        std::nth_element(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(largest), order.end(),
                         [&](std::int32_t a, std::int32_t b) { return size(a) > size(b); });
        return largest;
    }

    // Halves what stands in several parts, across the axis along which it extends most.
    void fill(std::int32_t index, std::span<std::int32_t> order, std::size_t share, std::size_t parts) {
        if (parts == 1) {
            add(index, order);
            return;
        }
        Bounds centres;
        for (std::int32_t box : order) centres = unite(centres, centre(box));
        const Vector extent = centres.diagonal();
        const std::size_t left = parts / 2 * share;
        std::nth_element(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(left), order.end(),
                         [&](std::int32_t a, std::int32_t b) {
                             const Point p = centre(a), q = centre(b);
                             if (extent.x >= extent.y && extent.x >= extent.z) return p.x < q.x;
                             return extent.y >= extent.z ? p.y < q.y : p.z < q.z;
                         });
        fill(index, order.first(left), share, parts / 2);
        fill(index, order.subspan(left), share, parts - parts / 2);
    }

    void add(std::int32_t index, std::span<std::int32_t> order) {
        Bounds box;
        for (std::int32_t i : order) box = unite(box, boxes_[i]);
        const std::int32_t content = order.size() == 1 ? ~order[0] : build(order);
        BoxBlock& block = blocks_[index];
        block.content[block.count] = content;
        set_box(index, block.count++, box);
    }

    void set_box(std::int32_t index, int lane, const Bounds& box) {
        BoxBlock& block = blocks_[index];
        if (box.is_empty()) {
            block.low_x[lane] = block.low_y[lane] = block.low_z[lane] = INFINITY;
            block.high_x[lane] = block.high_y[lane] = block.high_z[lane] = -INFINITY;
            return;
        }
        block.low_x[lane] = float_below(box.low.x - anchor_.x), block.high_x[lane] = float_above(box.high.x - anchor_.x);
        block.low_y[lane] = float_below(box.low.y - anchor_.y), block.high_y[lane] = float_above(box.high.y - anchor_.y);
        block.low_z[lane] = float_below(box.low.z - anchor_.z), block.high_z[lane] = float_above(box.high.z - anchor_.z);
    }

    // Of boxes without end: the anchor.
    Point centre(std::int32_t box) const { return boxes_[box].is_finite() ? boxes_[box].centre() : anchor_; }

    std::span<const Bounds> boxes_;
    Point anchor_;
    std::vector<BoxBlock>& blocks_;
};

}  // namespace

std::uint32_t overlapping(const BoxBlock& block, const FloatBox& box) {
    std::uint32_t bits = 0;
    for (std::uint32_t i = 0; i < BoxBlock::width; ++i) {
        const float low_x = block.low_x[i], low_y = block.low_y[i], low_z = block.low_z[i];
        const float high_x = block.high_x[i], high_y = block.high_y[i], high_z = block.high_z[i];
        const bool overlap = (box.low_x <= high_x) & (low_x <= box.high_x) & (box.low_y <= high_y) & (low_y <= box.high_y) &
                             (box.low_z <= high_z) & (low_z <= box.high_z);
        bits |= overlap ? 1u << i : 0u;
    }
    return bits;
}

std::int32_t add_box_blocks(std::span<const Bounds> boxes, const Point& anchor, std::vector<BoxBlock>& blocks) {
    std::vector<std::int32_t> order(boxes.size());
    std::iota(order.begin(), order.end(), 0);
    return Builder(boxes, anchor, blocks).build(order);
}

}  // namespace lapidary
