// SPDX-License-Identifier: MIT
//
// The hierarchy over boxes: nothing that stands in it is lost, and rays meet few of its nodes.
#include "kernel/prepare/hierarchy.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <set>
#include <span>
#include <vector>

#include "support/catch.h"

namespace lapidary {
namespace {

std::vector<Bounds> random_boxes(std::size_t count, double extent, double size, unsigned seed) {
    std::mt19937 engine(seed);
    std::uniform_real_distribution<double> place(-extent, extent), half(0, size);
    std::vector<Bounds> boxes;
    for (std::size_t i = 0; i < count; ++i) {
        const Point centre{place(engine), place(engine), place(engine)};
        const Vector reach{half(engine), half(engine), half(engine)};
        boxes.push_back({centre - reach, centre + reach});
    }
    return boxes;
}

Hierarchy hierarchy_over(const std::vector<Bounds>& boxes) {
    std::vector<std::int32_t> left_out;
    Hierarchy hierarchy(boxes, 0, left_out);
    CHECK(left_out.empty());
    return hierarchy;
}

std::multiset<std::int32_t> items_at(const Hierarchy& hierarchy, const Point& point) {
    std::multiset<std::int32_t> items;
    hierarchy.for_each_at(point, 0, [&](std::int32_t item) { items.insert(item); });
    return items;
}

// Every box is found, once, at its corners and in its middle.
void check_nothing_is_lost(const std::vector<Bounds>& boxes) {
    const Hierarchy hierarchy = hierarchy_over(boxes);
    CHECK(hierarchy.nodes().size() == std::max<std::size_t>(1, boxes.size() - 1));
    for (std::size_t i = 0; i < boxes.size(); ++i)
        for (const Point& point : {boxes[i].low, boxes[i].centre(), boxes[i].high})
            if (items_at(hierarchy, point).count(static_cast<std::int32_t>(i)) != 1) FAIL_CHECK("box " << i << " is lost");
}

TEST_CASE("every box is found where it stands") {
    for (const std::size_t count : {1, 2, 3, 7, 8, 9, 16, 17, 1000}) check_nothing_is_lost(random_boxes(count, 10, 0.5, 1));
}

TEST_CASE("boxes too large for floats are left out, and numbers count from where they are told to") {
    const std::vector<Bounds> boxes{Bounds::cube(1), Bounds::everything(), {{3, 0, 0}, {4, 1, 1}}, Bounds::cube(1e31)};
    std::vector<std::int32_t> left_out;
    const Hierarchy hierarchy(boxes, 5, left_out);
    CHECK(left_out == std::vector<std::int32_t>{6, 8});
    CHECK(items_at(hierarchy, {0.5, 0.5, 0.5}) == std::multiset<std::int32_t>{5});
    CHECK(items_at(hierarchy, {3.5, 0.5, 0.5}) == std::multiset<std::int32_t>{7});
}

TEST_CASE("boxes far from the origin, tiny, flat and enormous ones are found") {
    for (const double extent : {1e-30, 1e-3, 1e9, 1e29}) check_nothing_is_lost(random_boxes(200, extent, 1e-3 * extent, 2));
    auto far = random_boxes(200, 1, 0.01, 3);
    for (Bounds& box : far) box.low.x += 1e9, box.high.x += 1e9;
    check_nothing_is_lost(far);
    auto flat = random_boxes(200, 1, 0, 4);
    for (Bounds& box : flat) box.low.z = box.high.z = 0;
    check_nothing_is_lost(flat);
}

TEST_CASE("boxes that all stand in one place are found") {
    check_nothing_is_lost(std::vector<Bounds>(1000, Bounds::cube(1)));
    // Each twice as large as the one before: cuts by area take one off at a time.
    std::vector<Bounds> growing;
    for (int i = 0; i < 90; ++i) growing.push_back({{0, 0, 0}, {std::ldexp(1.0, i), 1, 1}});
    check_nothing_is_lost(growing);
}

TEST_CASE("lines meet near boxes first and none is lost") {
    const auto boxes = random_boxes(2000, 10, 0.5, 5);
    const Hierarchy hierarchy = hierarchy_over(boxes);
    std::mt19937 engine(6);
    std::normal_distribution<double> normal;
    for (int i = 0; i < 200; ++i) {
        const Point origin{normal(engine), normal(engine), normal(engine)};
        const Vector direction = normalize(Vector{normal(engine), normal(engine), normal(engine)});
        std::set<std::int32_t> met, found;
        const SlabLine line(origin, direction);
        double near = 0;
        for (std::size_t b = 0; b < boxes.size(); ++b) {
            const std::array<double, 3> low{boxes[b].low.x, boxes[b].low.y, boxes[b].low.z};
            const std::array<double, 3> high{boxes[b].high.x, boxes[b].high.y, boxes[b].high.z};
            if (line.meets(low, high, 0, infinity, near)) met.insert(static_cast<std::int32_t>(b));
        }
        hierarchy.for_each_along(origin, direction, infinity, [&](std::int32_t item) { return found.insert(item), infinity; });
        CHECK(std::includes(found.begin(), found.end(), met.begin(), met.end()));
        CHECK(found.size() <= met.size() + 1);  // boxes are hardly larger than what they hold
    }
}

// What a ray is expected to cost by the surface-area heuristic: the areas of the boxes below a node.
double half_area(const Bounds& box) {
    const Vector size = box.diagonal();
    return size.x * size.y + size.y * size.z + size.z * size.x;
}

double cost_of(const Hierarchy& hierarchy) {
    double sum = 0;
    for (const Hierarchy::Node& node : hierarchy.nodes())
        for (std::size_t i = 0; i < 2; ++i) {
            const auto &low = node.low[i], &high = node.high[i];
            sum += half_area({{low[0], low[1], low[2]}, {high[0], high[1], high[2]}});
        }
    return sum;
}

// The same of a tree for which every cut along every axis is tried.
double cost_of_best_cuts(std::span<Bounds> boxes) {
    if (boxes.size() < 2) return 0;
    const auto sort_along = [&](int axis) {
        std::sort(boxes.begin(), boxes.end(), [axis](const Bounds& a, const Bounds& b) {
            const Point p = a.centre(), q = b.centre();
            return axis == 0 ? p.x < q.x : axis == 1 ? p.y < q.y : p.z < q.z;
        });
    };
    double least = infinity, areas = 0;
    int best_axis = 0;
    std::size_t best_cut = 1;
    for (int axis = 0; axis < 3; ++axis) {
        sort_along(axis);
        std::vector<double> right(boxes.size());
        Bounds box;
        for (std::size_t i = boxes.size() - 1; i > 0; --i) right[i] = half_area(box = unite(box, boxes[i]));
        box = Bounds::empty();
        for (std::size_t i = 1; i < boxes.size(); ++i) {
            const double left = half_area(box = unite(box, boxes[i - 1]));
            const double cost = left * static_cast<double>(i) + right[i] * static_cast<double>(boxes.size() - i);
            if (cost < least) least = cost, areas = left + right[i], best_axis = axis, best_cut = i;
        }
    }
    sort_along(best_axis);
    return areas + cost_of_best_cuts(boxes.first(best_cut)) + cost_of_best_cuts(boxes.subspan(best_cut));
}

TEST_CASE("bins make nearly as good a tree as trying every cut") {
    for (const double size : {0.05, 0.5, 5.0}) {
        auto boxes = random_boxes(1000, 10, size, 7);
        const double ratio = cost_of(hierarchy_over(boxes)) / cost_of_best_cuts(boxes);
        INFO("boxes of up to " << size << ": " << ratio);
        CHECK(ratio < 1.1);
    }
}

}  // namespace
}  // namespace lapidary
