// SPDX-License-Identifier: MIT
//
// Random trees of operations on a grid (T24), and the same rays backward (T40): leaves of which many share faces, each placed
// by another chain of rotations and scales, against the ideal solid in 200-bit arithmetic.
#include <algorithm>

#include "stress/grid_solids.h"
#include "support/first_hits.h"

using namespace lapidary;
using namespace lapidary::test;

namespace {

void check_random_trees(int trees, int rays, bool all_kinds) {
    const GridPlace place = GENERATE(GridPlace{1, 0}, GridPlace{1, 1e3}, GridPlace{1, 1e6}, GridPlace{1e-6, 0},
                                     GridPlace{1e-6, 1e3}, GridPlace{1e6, 0});
    CAPTURE(place.size, place.offset);
    std::mt19937_64 random(24);
    GridComparison forward(place, "T24", "random trees on a grid"), backward(place, "T40", "random trees on a grid, backward");
    Measurement first({"T24", "first hits of random trees", "", 0});
    for (int tree = 0; tree < trees; ++tree) {
        SolidMaker maker(static_cast<unsigned>(1000 + tree));
        const GridSolid solid = random_solid(random, 6 + tree * 34 / std::max(trees - 1, 1), all_kinds);
        SpansThrough through(scene_node(solid, place, maker));
        std::vector<Ray> aimed;
        std::vector<std::vector<Span>> found;
        for (int i = 0; i < rays; ++i) {
            const Aim aim = i % 4 == 3 ? Aim::vertex : i % 4 == 2 ? Aim::edge : Aim::anywhere;
            for (GridComparison* way : {&forward, &backward}) {
                const Ray ray = way == &forward ? aim_at_grid(random, place, aim) : reversed(aimed.back(), 64 * place.size);
                aimed.push_back(ray);
                found.push_back(way->measured().timed([&] { return through(ray); }));
                way->compare(solid, ray, found.back(), aim);
            }
        }
        FirstHits(through.world()).expect(first, aimed, found);
    }
    CHECK(forward.cells() > trees * rays / 4);
}

}  // namespace

TEST_CASE("T24, T40 random trees of boxes, half-spaces and balls on a grid are the ideal ones, both ways") {
    check_random_trees(12, 45, false);
}

TEST_CASE("T24, T40 random trees of all primitives on a grid are the ideal ones, both ways") { check_random_trees(12, 20, true); }

TEST_CASE("T24, T40 random trees on a grid, in a million rays", "[.long]") { check_random_trees(200, 420, true); }
