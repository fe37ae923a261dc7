// SPDX-License-Identifier: MIT
//
// Grids along edges: straight ones are told as well as their ends are known, even shading is exact, and what a grid cannot tell
// it says so.

#include <cmath>
#include <functional>
#include <limits>

#include "kernel/render/edge_grid.h"
#include "support/catch.h"

using namespace lapidary;

namespace {

using Picture = std::function<Colour(double x, double y)>;
constexpr PixelRegion tile{64, 32, 96, 64};
constexpr double least_change = 0.02;

void answer(EdgeGrid& grid, const Picture& picture) {
    for (std::span places = grid.ask(); !places.empty(); places = grid.ask())
        for (std::size_t i = 0; i < places.size(); ++i) grid.tell(i, picture(places[i].x, places[i].y));
}

void know(EdgeGrid& grid, PixelPlace pixel, const Picture& picture) {
    grid.know_middle(pixel, to_floats(picture(pixel.x + 0.5, pixel.y + 0.5)));
}

// Of one pixel, in a part of the picture that begins at `corner`.
EdgeGrid::Estimate estimate(EdgeGrid& grid, const Picture& picture, PixelPlace pixel, int fineness,
                            const PixelRegion& part = tile) {
    grid.begin({part.x0, part.y0}, fineness, least_change);
    if (fineness == 1) {
        for (int y = part.y0 - 1; y <= part.y1; ++y)
            for (int x = part.x0 - 1; x <= part.x1; ++x) know(grid, {x, y}, picture);
        grid.want_all(part);
    } else {
        know(grid, pixel, picture);
        grid.want(pixel);
    }
    answer(grid, picture);
    return grid.estimate(pixel);
}

// By brute force.
Colour mean(const Picture& picture, PixelPlace pixel) {
    constexpr int across = 200;
    Colour sum;
    for (int j = 0; j < across; ++j)
        for (int i = 0; i < across; ++i) sum += picture(pixel.x + (i + 0.5) / across, pixel.y + (j + 0.5) / across);
    return 1.0 / (across * across) * sum;
}

}  // namespace

TEST_CASE("a straight edge is told to a sixteenth of a cell's side") {
    EdgeGrid grid;
    for (int trial = 0; trial < 300; ++trial) {
        const PixelPlace pixel{tile.x0 + trial % 32, tile.y0 + trial / 32};
        const double angle = 0.021 * trial, beyond = 1.2 * std::fmod(0.618034 * trial, 1) - 0.6;
        const Picture edge = [&](double x, double y) {
            const double u = x - pixel.x - 0.5, v = y - pixel.y - 0.5;
            return u * std::cos(angle) + v * std::sin(angle) < beyond ? Colour{0.1, 0.2, 0.3} : Colour{0.9, 0.7, 0.5};
        };
        const Colour exact = mean(edge, pixel);
        for (const int fineness : {1, 2, 4}) {
            INFO("angle " << angle << ", beyond " << beyond << ", fineness " << fineness);
            const Colour told = estimate(grid, edge, pixel, fineness).colour;
            // A cell without its corner, which the line may cut off between nodes, costs no more than an eighth of a cell.
            CHECK(std::fabs(told.r - exact.r) <= 0.8 * 0.13 / fineness);
            CHECK(std::fabs((told.g - 0.2) / 0.5 - (told.r - 0.1) / 0.8) < 1e-6);  // a mixture of both colours
        }
    }
}

TEST_CASE("even shading is exact, gentle or steep, and takes few rays") {
    EdgeGrid grid;
    for (const double slope : {0.001, 0.1, 1.0}) {
        const Picture shading = [&](double x, double y) { return Colour::grey(slope * (0.01 * (x - 60) + 0.02 * (y - 30))); };
        const PixelPlace pixel{70, 40};
        for (const int fineness : {1, 2, 4}) {
            INFO("slope " << slope << ", fineness " << fineness);
            const EdgeGrid::Estimate told = estimate(grid, shading, pixel, fineness);
            CHECK(std::fabs(told.colour.g - shading(70.5, 40.5).g) < 1e-6);
            CHECK(told.error < 1e-6);
            CHECK(told.rays <= fineness * fineness - 1 + 2 * fineness * fineness);  // nodes, and a look at each side at most
        }
    }
}

TEST_CASE("without changes around, a pixel's middle says all") {
    EdgeGrid grid;
    const Picture edge = [](double x, double) { return Colour::grey(x < 80.3 ? 0 : 1); };
    estimate(grid, edge, {80, 40}, 1);
    const auto has_changes = [&](PixelPlace pixel) { return (grid.changes_in_row(pixel.y) >> (pixel.x - tile.x0) & 1) != 0; };
    CHECK(has_changes({80, 40}));
    CHECK(has_changes({79, 40}));
    CHECK(has_changes({79, 63}));
    CHECK_FALSE(has_changes({78, 40}));
    CHECK_FALSE(has_changes({81, 32}));
}

TEST_CASE("what is told of a pixel does not depend on the part of the picture that it is asked in") {
    EdgeGrid grid;
    const Picture rings = [](double x, double y) {
        return std::fmod(std::hypot(x - 71, y - 44), 3) < 1.3 ? Colour{0.2, 0.8, 0.1} : Colour{0.7, 0.3, 0.4};
    };
    for (int y = 40; y < 48; ++y)
        for (int x = 66; x < 76; ++x)
            for (const int fineness : {1, 2, 4}) {
                const EdgeGrid::Estimate whole = estimate(grid, rings, {x, y}, fineness);
                const EdgeGrid::Estimate part = estimate(grid, rings, {x, y}, fineness, {65, 39, 80, 50});
                CHECK(whole.colour == part.colour);
                CHECK(whole.error == part.error);
                CHECK(whole.rays == part.rays);
            }
}

TEST_CASE("the more a pixel holds, the more is said to be left out") {
    EdgeGrid grid;
    const auto stripes = [](double width) {
        return Picture(
            [width](double x, double y) { return Colour::grey(std::fmod(x + 0.3 * y + 100, 2 * width) < width ? 0 : 1); });
    };
    const auto error = [&](double width, int fineness) { return estimate(grid, stripes(width), {75, 45}, fineness).error; };
    CHECK(error(0.23, 1) == 1);
    CHECK(error(0.23, 2) == 0.5);
    CHECK(error(20.07, 2) < 0.1);
    CHECK(error(20.07, 4) <= error(20.07, 2));

    // What finer grids would not help with is told, but not by middles alone, which may have missed lines between a few edges.
    const auto is_tangled = [&](double width, int fineness) {
        return estimate(grid, stripes(width), {75, 45}, fineness).is_tangled;
    };
    CHECK(is_tangled(0.23, 2));
    CHECK(is_tangled(0.23, 4));
    CHECK(is_tangled(0.9, 1));
    CHECK(error(1.2, 1) == 1);
    CHECK(!is_tangled(1.2, 1));
    CHECK(!is_tangled(20.07, 2));
}

TEST_CASE("a probe tells of a pattern that fits the grid") {
    EdgeGrid grid;
    const Picture fitting = [](double x, double) { return Colour::grey(std::fmod(x + 0.1, 0.5) < 0.2 ? 0 : 1); };
    const PixelPlace pixel{70, 40};
    grid.begin({tile.x0, tile.y0}, 2, least_change);
    for (const bool with_probe : {false, true}) {
        grid.begin({tile.x0, tile.y0}, 2, least_change);
        know(grid, pixel, fitting);
        grid.want(pixel);
        if (with_probe) grid.probe({70.3, 40.2});
        answer(grid, fitting);
        CHECK(grid.estimate(pixel).is_surprising == with_probe);
        CHECK((grid.estimate(pixel).error == 0.5) == with_probe);
    }
}

TEST_CASE("of what is not a number nothing is believed") {
    EdgeGrid grid;
    const Picture hole = [](double x, double y) {
        return std::hypot(x - 70.5, y - 40.5) < 0.1 ? Colour::grey(std::numeric_limits<double>::quiet_NaN()) : Colour::white();
    };
    for (const int fineness : {1, 2, 4}) CHECK(std::isinf(estimate(grid, hole, {70, 40}, fineness).error));
    CHECK(estimate(grid, hole, {75, 40}, 2).error == 0);
}
