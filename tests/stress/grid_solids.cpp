// SPDX-License-Identifier: MIT
#include "stress/grid_solids.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <numbers>
#include <string>
#include <utility>

namespace lapidary::test {
namespace {

constexpr int grid_size = 8;

int pick(std::mt19937_64& random, int low, int high) { return std::uniform_int_distribution<>(low, high)(random); }

const Exact& beyond_all() {
    static const Exact value("1e40");
    return value;
}

// The pieces of a line on which something holds, sorted.
using Pieces = std::vector<ExactSpan>;

Pieces everywhere() { return {{{-beyond_all()}, {beyond_all()}}}; }

Pieces common(const Pieces& a, const Pieces& b) {
    Pieces shared;
    for (const ExactSpan& x : a)
        for (const ExactSpan& y : b) {
            const ExactEnd &in = x.in.t > y.in.t ? x.in : y.in, &out = x.out.t < y.out.t ? x.out : y.out;
            if (in.t < out.t) shared.push_back({in, out});
        }
    return shared;
}

// Where slope t + value < 0.
Pieces negative_linear(const Exact& value, const Exact& slope, const Exact& normal_length) {
    if (slope == 0) return value < 0 ? everywhere() : Pieces{};
    const ExactEnd end{-value / slope, abs(slope) / normal_length};
    if (slope > 0) return {{{-beyond_all()}, end}};
    return {{end, {beyond_all()}}};
}

// Where a quadratic is negative; `cosine(t, slope)` is that of the end at t, where the quadratic has that slope.
template <class Cosine>
Pieces negative_quadratic(const Polynomial& p, Cosine cosine) {
    if (p[2] == 0) return negative_linear(p[0], p[1], 1);
    const std::vector<Exact> roots = quadratic_roots(p);
    if (roots.empty()) return p[2] < 0 ? everywhere() : Pieces{};
    const Exact slope = 2 * abs(p[2]) * (roots[1] - roots[0]) / 2;
    const ExactEnd first{roots[0], cosine(roots[0], slope)}, last{roots[1], cosine(roots[1], slope)};
    if (p[2] > 0) return {{first, last}};
    return {{{-beyond_all()}, first}, {last, {beyond_all()}}};
}

// The line in a leaf's own axes, in units of the grid.
struct LeafLine {
    ExactVector o, d;
};

LeafLine in_leaf(const GridLeaf& leaf, const GridPlace& place, const Ray& ray) {
    const std::array<double, 3> anchor{ray.origin.anchor.x, ray.origin.anchor.y, ray.origin.anchor.z};
    const std::array<double, 3> rest{ray.origin.offset.x, ray.origin.offset.y, ray.origin.offset.z};
    const std::array<double, 3> along{ray.direction.x, ray.direction.y, ray.direction.z};
    std::array<Exact, 3> o, d;
    for (std::size_t i = 0; i < 3; ++i) {
        o[i] = (Exact(anchor[i]) + rest[i] - place.offset) / place.size - leaf.centre[i];
        d[i] = Exact(along[i]) / place.size;
    }
    if (leaf.kind == GridLeaf::Kind::box) return {{o[0], o[1], o[2]}, {d[0], d[1], d[2]}};
    const auto axis = static_cast<std::size_t>(leaf.axis), x = (axis + 1) % 3, z = (axis + 2) % 3;
    const int up = leaf.reversed ? -1 : 1;
    return {{o[x], up * o[axis], o[z]}, {d[x], up * d[axis], d[z]}};
}

Pieces slab(const Exact& o, const Exact& d, const Exact& half, const Exact& direction_length) {
    return common(negative_linear(o - half, d, direction_length), negative_linear(-o - half, -d, direction_length));
}

// The side of a frustum of radius a at the bottom, b at the top.
//
// Where the line meets it no further from the apex than coordinates are rounded, the normal there says nothing: a line moved by
// that much meets another generator. Among all of them the cosine between line and normal is as small as
//
//     |sin(alpha - beta)|,   alpha, beta: the angles of the cone and of the line to the axis,
//
// and the end is as well defined as at that one.
Pieces cone(const GridLeaf& leaf, const LeafLine& line, const Exact& speed, double rounding) {
    const double a = leaf.sizes[0], b = leaf.sizes[1], c = leaf.sizes[2];
    const Exact slope = (Exact(a) - b) / c, slant = sqrt(1 + slope * slope);
    const double apex = a * c / (a - b) - c / 2;
    const ExactVector& d = line.d;
    const Exact at_apex = abs(sqrt(d.x * d.x + d.z * d.z) - abs(slope * d.y)) / (slant * speed);
    const auto cosine = [&](const Exact& t, const Exact& slope_of_quadratic) -> Exact {
        const ExactVector p = at(line.o, d, t);
        const Exact rho = sqrt(p.x * p.x + p.z * p.z);
        return rho <= rounding ? at_apex : slope_of_quadratic / (2 * rho * slant * speed);
    };
    return negative_quadratic(cone_polynomial(line.o, d, static_cast<double>(slope), apex), cosine);
}

Pieces pieces(const GridLeaf& leaf, const LeafLine& line, double rounding) {
    using Kind = GridLeaf::Kind;
    const ExactVector &o = line.o, &d = line.d;
    const double a = leaf.sizes[0], b = leaf.sizes[1], c = leaf.sizes[2];
    const Exact speed = sqrt(dot(d, d));
    const auto round_cosine = [&](const Exact&, const Exact& slope) -> Exact { return slope / (2 * a * speed); };
    switch (leaf.kind) {
        case Kind::box:
            return common(slab(o.x, d.x, a, speed), common(slab(o.y, d.y, b, speed), slab(o.z, d.z, c, speed)));
        case Kind::half_space:
            return negative_linear(o.y, d.y, speed);
        case Kind::ball:
            return negative_quadratic(sphere_polynomial(o, d, a), round_cosine);
        case Kind::rod:
            return common(negative_quadratic(cylinder_polynomial(o, d, a), round_cosine), slab(o.y, d.y, Exact(c) / 2, speed));
        case Kind::frustum:
            return common(cone(leaf, line, speed, rounding), slab(o.y, d.y, Exact(c) / 2, speed));
        case Kind::ring: {
            const Exact middle = -dot(o, d) / (speed * speed), reach = 2 * (a + b) / speed;
            const std::vector<Exact> ends = sign_changes(torus_polynomial(o, d, a, b), middle - reach, middle + reach);
            Pieces found;
            const auto end = [&](const Exact& t) -> ExactEnd {
                const ExactVector p = at(o, d, t);
                const Exact ring = a / sqrt(p.x * p.x + p.z * p.z);
                const ExactVector n{p.x - ring * p.x, p.y, p.z - ring * p.z};
                return {t, abs(dot(n, d)) / (b * speed)};
            };
            for (std::size_t i = 0; i + 1 < ends.size(); i += 2) found.push_back({end(ends[i]), end(ends[i + 1])});
            return found;
        }
    }
    return {};
}

// All leaves' pieces, and the order of their ends: between two neighbouring ends nothing changes.
class Cells {
public:
    Cells(const GridSolid& solid, const GridPlace& place, const Ray& ray) {
        gather(solid, place, ray);
        for (const Pieces& of_leaf : leaves_)
            for (const ExactSpan& piece : of_leaf)
                for (const ExactEnd& end : {piece.in, piece.out})
                    if (end.t > 0) of_leaves_.push_back(end);
        std::sort(of_leaves_.begin(), of_leaves_.end(), [](const ExactEnd& a, const ExactEnd& b) { return a.t < b.t; });
        ends_ = of_leaves_;
        ends_.insert(ends_.begin(), {Exact(0)});
        ends_.erase(std::unique(ends_.begin(), ends_.end(), [](const ExactEnd& a, const ExactEnd& b) { return a.t == b.t; }),
                    ends_.end());
        if (ends_.back().is_finite()) ends_.push_back({beyond_all()});
        for (const Pieces& of_leaf : leaves_) ranked_.push_back(rank(of_leaf));
    }

    std::vector<ExactSpan> spans(const GridSolid& solid) const {
        std::vector<ExactSpan> found;
        bool inside = false;
        for (std::size_t cell = 0; cell + 1 < ends_.size(); ++cell) {
            std::size_t leaf = 0;
            const bool now = holds(solid, cell, leaf);
            if (now && !inside) found.push_back({ends_[cell], {beyond_all()}});
            if (!now && inside) found.back().out = ends_[cell];
            inside = now;
        }
        return found;
    }

    // Of all leaves, sorted, those at the same place, too.
    const std::vector<ExactEnd>& ends_of_leaves() const { return of_leaves_; }

private:
    using Ranks = std::vector<std::pair<std::size_t, std::size_t>>;

    void gather(const GridSolid& solid, const GridPlace& place, const Ray& ray) {
        if (solid.operation == Operation::leaf)
            leaves_.push_back(pieces(solid.leaf, in_leaf(solid.leaf, place, ray), place.rounding()));
        for (const GridSolid& operand : solid.operands) gather(operand, place, ray);
    }

    // The numbers of the cells that pieces begin at and end before.
    Ranks rank(const Pieces& pieces) const {
        const auto number = [&](const Exact& t) {
            const auto before = [](const ExactEnd& end, const Exact& value) { return end.t < value; };
            return static_cast<std::size_t>(std::lower_bound(ends_.begin(), ends_.end(), t, before) - ends_.begin());
        };
        Ranks ranks;
        for (const ExactSpan& piece : pieces) ranks.emplace_back(number(piece.in.t), number(piece.out.t));
        return ranks;
    }

    // Leaves are counted on the way, in the order in which they were gathered.
    bool holds(const GridSolid& solid, std::size_t cell, std::size_t& leaf) const {
        if (solid.operation == Operation::leaf) {
            const Ranks& ranks = ranked_[leaf++];
            return std::any_of(ranks.begin(), ranks.end(), [cell](const auto& r) { return r.first <= cell && cell < r.second; });
        }
        int count = 0;
        bool first = false;
        for (std::size_t i = 0; i < solid.operands.size(); ++i) {
            const bool inside = holds(solid.operands[i], cell, leaf);
            count += inside;
            if (i == 0) first = inside;
        }
        switch (solid.operation) {
            case Operation::intersection:
                return count == static_cast<int>(solid.operands.size());
            case Operation::subtraction:
                return first && count == 1;
            case Operation::symdiff:
                return count % 2 == 1;
            default:
                return count > 0;
        }
    }

    std::vector<Pieces> leaves_;
    std::vector<Ranks> ranked_;
    std::vector<ExactEnd> of_leaves_, ends_;
};

}  // namespace

GridSolid combine(Operation operation, std::vector<GridSolid> operands) { return {operation, {}, std::move(operands)}; }

GridSolid box(const std::array<double, 3>& low, const std::array<double, 3>& high) {
    GridSolid solid;
    for (std::size_t i = 0; i < 3; ++i) {
        solid.leaf.centre[i] = (low[i] + high[i]) / 2;
        solid.leaf.sizes[i] = (high[i] - low[i]) / 2;
    }
    return solid;
}

GridSolid ball(const std::array<double, 3>& centre, double radius) {
    return {Operation::leaf, {GridLeaf::Kind::ball, 1, false, centre, {radius, 0, 0}}, {}};
}

GridSolid rod(const std::array<double, 3>& centre, double radius, double height) {
    return {Operation::leaf, {GridLeaf::Kind::rod, 1, false, centre, {radius, 0, height}}, {}};
}

GridLeaf random_leaf(std::mt19937_64& random, bool all_kinds) {
    using Kind = GridLeaf::Kind;
    GridLeaf leaf;
    const int kind = pick(random, 0, all_kinds ? 11 : 6);
    leaf.axis = pick(random, 0, 2);
    leaf.reversed = pick(random, 0, 1) == 1;
    for (double& c : leaf.centre) c = pick(random, 1, grid_size - 1);
    if (kind < 4) {
        leaf.kind = Kind::box;
        for (std::size_t i = 0; i < 3; ++i) {
            const int low = pick(random, 0, grid_size - 1), high = pick(random, low + 1, grid_size);
            leaf.centre[i] = (low + high) / 2.0;
            leaf.sizes[i] = (high - low) / 2.0;
        }
    } else if (kind < 5) {
        leaf.kind = Kind::half_space;
    } else if (kind < 7) {
        leaf.kind = Kind::ball;
        leaf.sizes[0] = pick(random, 1, 4);
    } else if (kind < 9) {
        leaf.kind = Kind::rod;
        leaf.sizes = {static_cast<double>(pick(random, 1, 3)), 0, 2.0 * pick(random, 1, 3)};
    } else if (kind < 11) {
        leaf.kind = Kind::frustum;
        const int bottom = pick(random, 1, 2), top = pick(random, 0, 1) * bottom;
        leaf.sizes = {2.0 * bottom, static_cast<double>(top), 2.0 * pick(random, 1, 2)};
        if (pick(random, 0, 1) == 1) std::swap(leaf.sizes[0], leaf.sizes[1]);
    } else {
        leaf.kind = Kind::ring;
        leaf.sizes = {static_cast<double>(pick(random, 2, 3)), 1, 0};
    }
    return leaf;
}

GridSolid random_solid(std::mt19937_64& random, int leaves, bool all_kinds) {
    GridSolid solid;
    if (leaves == 1) {
        solid.leaf = random_leaf(random, all_kinds);
        return solid;
    }
    solid.operation = static_cast<Operation>(pick(random, 1, 5));
    const int parts = std::min(leaves, pick(random, 2, 4));
    for (int part = 0; part < parts; ++part) {
        const int rest = leaves - (parts - 1 - part);  // each of the others gets one at least
        const int share = part + 1 == parts ? leaves : pick(random, 1, rest);
        solid.operands.push_back(random_solid(random, share, all_kinds));
        leaves -= share;
    }
    return solid;
}

SceneNodePtr scene_node(const GridLeaf& leaf, const GridPlace& place, const Factors& chain, SolidMaker& maker) {
    using Kind = GridLeaf::Kind;
    Factors factors = chain;
    const auto& [a, b, c] = leaf.sizes;
    if (leaf.kind == Kind::box) factors.push_back(scale(a, b, c));
    if (leaf.kind != Kind::box && leaf.reversed) factors.push_back(rotate({1, 0, 0}, std::numbers::pi));
    if (leaf.kind != Kind::box && leaf.axis == 0) factors.push_back(rotate({0, 0, 1}, -std::numbers::pi / 2));
    if (leaf.kind != Kind::box && leaf.axis == 2) factors.push_back(rotate({1, 0, 0}, std::numbers::pi / 2));
    factors.push_back(scale(place.size, place.size, place.size));
    factors.push_back(translate(place.size * leaf.centre[0], place.size * leaf.centre[1], place.size * leaf.centre[2]));
    factors.push_back(translate(place.offset, place.offset, place.offset));
    switch (leaf.kind) {
        case Kind::box:
            return maker.leaf("cube", factors);
        case Kind::half_space:
            return maker.leaf("halfspace", factors);
        case Kind::ball:
            return maker.leaf("sphere", factors, {{"radius", {a}}});
        case Kind::rod:
            return maker.leaf("cylinder", factors, {{"radius", {a}}, {"height", {c}}});
        case Kind::frustum:
            return maker.leaf("cone", factors, {{"radii", {a, b}}, {"height", {c}}});
        case Kind::ring:
            return maker.leaf("torus", factors, {{"radii", {a, b}}});
    }
    return nullptr;
}

SceneNodePtr scene_node(const GridSolid& solid, const GridPlace& place, SolidMaker& maker, int chain_length) {
    if (solid.operation == Operation::leaf) return scene_node(solid.leaf, place, maker.there_and_back(chain_length), maker);
    std::vector<SceneNodePtr> operands;
    for (const GridSolid& operand : solid.operands) operands.push_back(scene_node(operand, place, maker, chain_length));
    return maker.combine(solid.operation, std::move(operands));
}

std::vector<ExactSpan> without_slivers(std::vector<ExactSpan> spans, const Exact& longest) {
    std::vector<ExactSpan> kept;
    for (const ExactSpan& span : spans) {
        if (span.out.t - span.in.t <= longest) continue;
        if (!kept.empty() && span.in.t - kept.back().out.t <= longest)
            kept.back().out = span.out;
        else
            kept.push_back(span);
    }
    return kept;
}

std::vector<Span> without_slivers(std::vector<Span> spans, double longest) {
    std::vector<Span> kept;
    for (const Span& span : spans) {
        if (span.out - span.in <= longest) continue;
        if (!kept.empty() && span.in - kept.back().out <= longest)
            kept.back().out = span.out;
        else
            kept.push_back(span);
    }
    return kept;
}

void GridComparison::compare(const GridSolid& solid, const Ray& ray, std::vector<Span> spans, Aim aim) {
    // Ends that are the same may differ in the last of the 200 bits.
    const Cells cells(solid, place_, ray);
    const bool is_aimed = aim != Aim::anywhere;
    const double longest = place_.size * (is_aimed ? 1e-12 + 100 * place_.rounding() : 1e-40);
    const std::vector<ExactSpan> exact = without_slivers(cells.spans(solid), longest);
    if (is_aimed) spans = without_slivers(spans, longest);
    cells_ += static_cast<int>(exact.size());
    bool same = spans.size() == exact.size();
    for (std::size_t i = 0; same && i < spans.size(); ++i)
        for (const auto& [t, end] : {std::pair(spans[i].in, exact[i].in), std::pair(spans[i].out, exact[i].out)})
            same = same && agree(t, end, cells.ends_of_leaves(), longest);
    measured_.expect(same);
    if (same || ++wrong_ > 3) return;
    std::string text;
    for (const Span& span : spans) text += fmt::format("\n{:.17g} to {:.17g}", span.in, span.out);
    for (const ExactSpan& span : exact)
        text += fmt::format("\nexactly {:.17g} to {:.17g}", static_cast<double>(span.in.t), static_cast<double>(span.out.t));
    const Point o = ray.origin.rounded();
    WARN(fmt::format("from ({:a}, {:a}, {:a}) along ({:a}, {:a}, {:a}):{}", o.x, o.y, o.z, ray.direction.x, ray.direction.y,
                     ray.direction.z, text));
}

// The end of a solid is the end of one of its leaves, to the bit, and as exact as that one. Where the faces of several leaves
// meet in a point, all of their ends lie within rounding of each other, each by as much as its own cosine says, and which of them
// is the solid's is decided by rounding: the one that was chosen is compared with itself.
bool GridComparison::agree(double t, const ExactEnd& exact, const std::vector<ExactEnd>& of_leaves, const Exact& reach) {
    if (t == infinity || !exact.is_finite()) return t == infinity && !exact.is_finite();
    const auto off = [t](const ExactEnd& end) { return static_cast<double>(abs(t - end.t) * end.cosine); };
    const double rounding = u * (std::fabs(t) + 16 * place_.size + std::fabs(place_.offset));
    double least = off(exact);
    if (least > 1e6 * rounding) return false;  // it is another face
    const auto before = [](const ExactEnd& end, const Exact& place) { return end.t < place; };
    auto end = std::lower_bound(of_leaves.begin(), of_leaves.end(), exact.t - reach, before);
    for (; end != of_leaves.end() && end->t <= exact.t + reach; ++end) least = std::min(least, off(*end));
    measured_.record(least / rounding);
    return true;
}

bool same_bits(const std::vector<Span>& a, const std::vector<Span>& b) {
    const auto equal = [](double x, double y) { return std::bit_cast<std::uint64_t>(x) == std::bit_cast<std::uint64_t>(y); };
    bool same = a.size() == b.size();
    for (std::size_t i = 0; same && i < a.size(); ++i) same = equal(a[i].in, b[i].in) && equal(a[i].out, b[i].out);
    return same;
}

Ray aim_at_grid(std::mt19937_64& random, const GridPlace& place, Aim aim) {
    std::uniform_real_distribution<double> uniform(0, 1);
    std::array<double, 3> through{}, origin{};
    Vector d;
    do {
        d = {2 * uniform(random) - 1, 2 * uniform(random) - 1, 2 * uniform(random) - 1};
        d = normalize(d);
    } while (std::min({std::fabs(d.x), std::fabs(d.y), std::fabs(d.z)}) < 0.05);
    for (double& p : through) p = aim == Aim::anywhere ? grid_size * uniform(random) : pick(random, 0, grid_size);
    if (aim == Aim::edge) through[static_cast<std::size_t>(pick(random, 0, 2))] = grid_size * uniform(random);
    const std::array<double, 3> along{d.x, d.y, d.z};
    for (std::size_t i = 0; i < 3; ++i) origin[i] = through[i] - 20 * along[i];
    return ray_from(place.world(origin), d);
}

}  // namespace lapidary::test
