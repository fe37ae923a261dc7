// SPDX-License-Identifier: MIT
//
// Solids on a grid: trees of operations over leaves whose faces lie at whole numbers, so that many of them coincide. Each is
// known twice: exactly, as spans in 200-bit arithmetic, and as nodes of a scene, every leaf placed by another chain of
// rotations, scales and translations, so that faces which coincide differ by rounding.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "kernel/scene/scene.h"
#include "stress/exact.h"
#include "support/measurement.h"
#include "support/solids.h"

namespace lapidary::test {

// A leaf with its own y axis along one of the grid's axes, up or down it.
struct GridLeaf {
    enum class Kind { box, half_space, ball, rod, frustum, ring };
    Kind kind = Kind::box;
    int axis = 1;
    bool reversed = false;
    std::array<double, 3> centre{};
    // Of a box: half-edges along the grid's axes. Of others: radius or radii, and the height last.
    std::array<double, 3> sizes{1, 1, 1};
};

struct GridSolid {
    Operation operation = Operation::leaf;
    GridLeaf leaf;
    std::vector<GridSolid> operands;
};

// Where the grid is: a place p of it is at offset + size p in the world.
struct GridPlace {
    double size = 1, offset = 0;

    Point world(const std::array<double, 3>& p) const {
        return {offset + size * p[0], offset + size * p[1], offset + size * p[2]};
    }
    // What coordinates in the world may be off by rounding, in the grid's units.
    double rounding() const { return 64 * u * (std::fabs(offset) / size + 16); }
};

GridSolid combine(Operation operation, std::vector<GridSolid> operands);
// A solid of one leaf, with its y axis along the grid's.
GridSolid box(const std::array<double, 3>& low, const std::array<double, 3>& high);
GridSolid ball(const std::array<double, 3>& centre, double radius);
GridSolid rod(const std::array<double, 3>& centre, double radius, double height);

GridLeaf random_leaf(std::mt19937_64& random, bool all_kinds);
GridSolid random_solid(std::mt19937_64& random, int leaves, bool all_kinds);

// A tree of scene nodes; `maker` gives every leaf a chain of its own.
SceneNodePtr scene_node(const GridSolid& solid, const GridPlace& place, SolidMaker& maker, int chain_length = 3);
SceneNodePtr scene_node(const GridLeaf& leaf, const GridPlace& place, const Factors& chain, SolidMaker& maker);

// The end of an exact span; the cosine between line and normal tells how well it is defined.
struct ExactEnd {
    Exact t;
    Exact cosine{1};

    bool is_finite() const { return abs(t) < Exact("1e39"); }
};
struct ExactSpan {
    ExactEnd in, out;
};

// Without spans, and then without gaps, that are not longer than that.
std::vector<ExactSpan> without_slivers(std::vector<ExactSpan> spans, const Exact& longest);
std::vector<Span> without_slivers(std::vector<Span> spans, double longest);

bool same_bits(const std::vector<Span>& a, const std::vector<Span>& b);

// From outside the grid to a place in the cube from 0 to 8: at random, on an edge of the grid, or at one of its vertices. No
// component of the direction is small.
enum class Aim { anywhere, edge, vertex };
Ray aim_at_grid(std::mt19937_64& random, const GridPlace& place, Aim aim);

// Compares spans with those of the ideal solid, and their ends in units of the rounding that the size of the numbers makes
// inevitable, by the cosine between line and normal.
class GridComparison {
public:
    GridComparison(const GridPlace& place, std::string test, std::string what)
        : place_(place), measured_({std::move(test), std::move(what), "u size / cos", 8}) {}

    // Of a ray that is aimed at an edge or a vertex, cells of rounding length are left out on both sides.
    void compare(const GridSolid& solid, const Ray& ray, std::vector<Span> spans, Aim aim);

    int cells() const { return cells_; }
    Measurement& measured() { return measured_; }

private:
    bool agree(double t, const ExactEnd& exact, const std::vector<ExactEnd>& of_leaves, const Exact& reach);

    GridPlace place_;
    Measurement measured_;
    int cells_ = 0, wrong_ = 0;
};

}  // namespace lapidary::test
