// SPDX-License-Identifier: MIT
#include "kernel/prepare/hierarchy.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace lapidary {

namespace {

constexpr int bin_count = 16;
constexpr int depth_limit = 100;  // the traversal's stack holds 128 entries; beyond it, split in the middle

double half_area(const Bounds& b) {
    if (b.is_empty()) return 0;
    const Vector d = b.diagonal();
    return d.x * d.y + d.y * d.z + d.z * d.x;
}

std::array<double, 3> components(const Point& p) { return {p.x, p.y, p.z}; }

// Floats outward: a float below the low end and one above the high end, relative to the anchor, with the padding that
// 1e-6 of a box's own size and the rounding of the subtraction need.
float below(double v) { return std::nextafterf(static_cast<float>(v), -INFINITY); }
float above(double v) { return std::nextafterf(static_cast<float>(v), INFINITY); }

}  // namespace

Hierarchy::Hierarchy(std::span<const Bounds> boxes, std::span<const std::int32_t> items) {
    if (boxes.empty()) return;
    Bounds all;
    for (const Bounds& box : boxes) all = unite(all, box);
    anchor_ = all.centre();
    std::vector<std::int32_t> order(boxes.size());
    std::iota(order.begin(), order.end(), 0);
    nodes_.reserve(boxes.size());
    build(boxes, order, items, 0);
}

// Returns the index of the node over `order`, whose items it sorts so that each subtree is contiguous.
std::int32_t Hierarchy::build(std::span<const Bounds> boxes, std::span<std::int32_t> order, std::span<const std::int32_t> items,
                              int depth) {
    const auto index = static_cast<std::int32_t>(nodes_.size());
    nodes_.emplace_back();

    // The axis along which the centres spread most, in bins.
    Bounds centres;
    for (std::int32_t i : order) centres = unite(centres, boxes[i].centre());
    const auto extent = components(to_point(centres.diagonal()));
    const int axis = static_cast<int>(std::max_element(extent.begin(), extent.end()) - extent.begin());
    const double low = components(centres.low)[axis];

    std::size_t middle = order.size() / 2;
    if (order.size() > 2 && extent[axis] > 0 && depth < depth_limit) {
        const double per_bin = bin_count / extent[axis];
        const auto bin_of = [&](std::int32_t i) {
            return std::clamp(static_cast<int>((components(boxes[i].centre())[axis] - low) * per_bin), 0, bin_count - 1);
        };
        std::array<Bounds, bin_count> bin_boxes;
        std::array<std::size_t, bin_count> bin_items{};
        for (std::int32_t i : order) {
            const int bin = bin_of(i);
            bin_boxes[bin] = unite(bin_boxes[bin], boxes[i]);
            ++bin_items[bin];
        }
        // The cost of a split after each bin: area times number, left and right.
        std::array<double, bin_count> right_cost{};
        Bounds box;
        std::size_t count = 0;
        for (int bin = bin_count - 1; bin > 0; --bin) {
            box = unite(box, bin_boxes[bin]);
            count += bin_items[bin];
            right_cost[bin] = half_area(box) * static_cast<double>(count);
        }
        box = Bounds::empty();
        count = 0;
        double best = infinity;
        int best_bin = -1;
        for (int bin = 0; bin + 1 < bin_count; ++bin) {
            box = unite(box, bin_boxes[bin]);
            count += bin_items[bin];
            const double cost = half_area(box) * static_cast<double>(count) + right_cost[bin + 1];
            if (count > 0 && count < order.size() && cost < best) best = cost, best_bin = bin;
        }
        if (best_bin >= 0)
            middle = static_cast<std::size_t>(
                std::partition(order.begin(), order.end(), [&](std::int32_t i) { return bin_of(i) <= best_bin; }) -
                order.begin());
    }

    const std::array<std::span<std::int32_t>, 2> halves{order.first(middle), order.subspan(middle)};
    for (int i = 0; i < 2; ++i) {
        Bounds box;
        for (std::int32_t item : halves[i]) box = unite(box, boxes[item]);
        Node& node = nodes_[index];
        if (halves[i].empty()) {
            node.child[i] = no_child;
            node.low[i] = {INFINITY, INFINITY, INFINITY};
            node.high[i] = {-INFINITY, -INFINITY, -INFINITY};
            continue;
        }
        const Vector size = box.diagonal();
        const double padding = 1e-6 * std::max({size.x, size.y, size.z});
        const Vector relative_low = box.low - anchor_, relative_high = box.high - anchor_;
        node.low[i] = {below(relative_low.x - padding), below(relative_low.y - padding), below(relative_low.z - padding)};
        node.high[i] = {above(relative_high.x + padding), above(relative_high.y + padding), above(relative_high.z + padding)};
        const std::int32_t child = halves[i].size() == 1 ? ~items[halves[i][0]] : build(boxes, halves[i], items, depth + 1);
        nodes_[index].child[i] = child;
    }
    return index;
}

}  // namespace lapidary
