// SPDX-License-Identifier: MIT
#include "kernel/prepare/box_blocks.h"

#include <algorithm>
#include <random>

#include "support/catch.h"

namespace lapidary {
namespace {

std::vector<std::int32_t> overlapping(const std::vector<Bounds>& boxes, const Point& anchor, const Bounds& query) {
    std::vector<BoxBlock> blocks(3);  // others' blocks
    const std::int32_t top = add_box_blocks(boxes, anchor, blocks);
    std::vector<std::int32_t> found;
    for_each_overlapping(blocks, top, query, anchor, [&](std::int32_t number) { found.push_back(number); });
    std::sort(found.begin(), found.end());
    return found;
}

TEST_CASE("blocks find every box that overlaps, once, and hardly any other") {
    std::mt19937 random(1);
    for (const std::size_t count : {1u, 2u, 7u, 8u, 9u, 63u, 64u, 65u, 200u, 513u, 4100u}) {
        for (const double place : {0.0, 1e3, -1e8}) {
            CAPTURE(count, place);
            const Point anchor{place, -place, 2 * place};
            std::uniform_real_distribution<double> coordinate(-1, 1);
            const auto random_box = [&](double size) {
                const Point low{anchor.x + coordinate(random), anchor.y + coordinate(random), anchor.z + coordinate(random)};
                return Bounds{low, low + size * Vector{1, 1, 1}};
            };
            std::vector<Bounds> boxes;
            for (std::size_t i = 0; i < count; ++i) boxes.push_back(random_box(0.2));
            const Bounds query = random_box(0.1);
            // One that touches the query, one that shares its centre with others, one without end.
            boxes.push_back({query.high, query.high + Vector{1, 1, 1}});
            boxes.push_back(boxes.front());
            boxes.push_back(Bounds::everything());

            const auto found = overlapping(boxes, anchor, query);
            CHECK(std::adjacent_find(found.begin(), found.end()) == found.end());
            std::size_t expected = 0;
            for (std::size_t i = 0; i < boxes.size(); ++i) {
                if (!boxes[i].overlaps(query)) continue;
                ++expected;
                CHECK(std::binary_search(found.begin(), found.end(), static_cast<std::int32_t>(i)));
            }
            CHECK(found.size() <= expected + 1);
        }
    }
}

TEST_CASE("blocks find nothing for an empty box") {
    CHECK(overlapping({Bounds::cube(1), Bounds::everything()}, {}, Bounds::empty()).empty());
}

}  // namespace
}  // namespace lapidary
