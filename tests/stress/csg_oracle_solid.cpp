// SPDX-License-Identifier: MIT
//
// The oracle's geometry: maps, surfaces, and the classification of pieces of a line.
#include <algorithm>
#include <cmath>
#include <limits>

#include "csg_oracle.h"

namespace lapidary::test {
namespace {

constexpr Wide wide_infinity = std::numeric_limits<Wide>::infinity();
constexpr Wide decision = 1e-9L;  // what lies nearer than this may be decided either way

// Coefficients of a polynomial, the constant one first.
using Coefficients = std::vector<Wide>;

Wide value(const Coefficients& p, Wide t) {
    Wide sum = 0;
    for (std::size_t i = p.size(); i-- > 0;) sum = sum * t + p[i];
    return sum;
}

Coefficients product(const Coefficients& a, const Coefficients& b) {
    Coefficients result(a.size() + b.size() - 1, 0);
    for (std::size_t i = 0; i < a.size(); ++i)
        for (std::size_t j = 0; j < b.size(); ++j) result[i + j] += a[i] * b[j];
    return result;
}

Coefficients sum(const Coefficients& a, const Coefficients& b, Wide factor_of_b) {
    Coefficients result(std::max(a.size(), b.size()), 0);
    for (std::size_t i = 0; i < a.size(); ++i) result[i] += a[i];
    for (std::size_t i = 0; i < b.size(); ++i) result[i] += factor_of_b * b[i];
    return result;
}

Wide bisect(const Coefficients& p, Wide low, Wide high) {
    const bool rising = value(p, high) > 0;
    while (true) {
        const Wide middle = (low + high) / 2;
        if (middle <= low || middle >= high) return middle;
        (value(p, middle) > 0) == rising ? high = middle : low = middle;
    }
}

// Where a polynomial changes sign: between two neighbouring extremes it does so at most once. Extremes that all but touch zero
// are put into `near`.
std::vector<Wide> sign_changes(Coefficients p, std::vector<Wide>* near) {
    while (p.size() > 1 && p.back() == 0) p.pop_back();
    if (p.size() < 2) return {};
    if (p.size() == 2) return {-p[0] / p[1]};

    Coefficients derivative;
    for (std::size_t i = 1; i < p.size(); ++i) derivative.push_back(static_cast<Wide>(i) * p[i]);
    std::vector<Wide> ends = sign_changes(derivative, nullptr);
    if (near)
        for (const Wide t : ends)
            if (std::fabs(value(p, t)) < decision) near->push_back(t);

    // Cauchy's bound on the size of a root.
    Wide bound = 0;
    for (const Wide c : p) bound = std::max(bound, std::fabs(c / p.back()));
    ends.insert(ends.begin(), -1 - bound);
    ends.push_back(1 + bound);

    std::vector<Wide> roots;
    for (std::size_t i = 0; i + 1 < ends.size(); ++i)
        if ((value(p, ends[i]) > 0) != (value(p, ends[i + 1]) > 0)) roots.push_back(bisect(p, ends[i], ends[i + 1]));
    return roots;
}

// The radius of a cone at a height: linear between both ends.
Wide cone_radius(const OracleLeaf& leaf, Wide y) {
    return leaf.sizes[0] + (leaf.sizes[1] - leaf.sizes[0]) * (y / leaf.sizes[2] + 0.5L);
}

// The leaf's defining inequality.
bool contains_local(const OracleLeaf& leaf, const WideTriple& p) {
    using Kind = OracleLeaf::Kind;
    const auto& [a, b, c] = leaf.sizes;
    const Wide rho_squared = p[0] * p[0] + p[2] * p[2];
    const Wide y = std::fabs(p[1]);
    switch (leaf.kind) {
        case Kind::sphere:
            return dot(p, p) <= Wide(a) * a;
        case Kind::cube:
            return std::fabs(p[0]) <= a && y <= b && std::fabs(p[2]) <= c;
        case Kind::slab:
            return y <= Wide(c) / 2;
        case Kind::cylinder:
            return rho_squared <= Wide(a) * a;
        case Kind::capped_cylinder:
            return rho_squared <= Wide(a) * a && y <= Wide(c) / 2;
        case Kind::halfspace:
            return p[1] <= 0;
        case Kind::cone:
            return y <= Wide(c) / 2 && rho_squared <= cone_radius(leaf, p[1]) * cone_radius(leaf, p[1]);
        case Kind::torus:
            return std::pow(std::sqrt(rho_squared) - a, 2.0L) + p[1] * p[1] <= Wide(b) * b;
    }
    return false;
}

// The polynomials along a line whose roots are the surfaces of a leaf, one for each face.
std::vector<Coefficients> surfaces(const OracleLeaf& leaf, const WideTriple& o, const WideTriple& d) {
    using Kind = OracleLeaf::Kind;
    const auto& [a, b, c] = leaf.sizes;
    const auto plane = [&](int axis, Wide at) { return Coefficients{o[axis] - at, d[axis]}; };
    const auto square = [&](int axis) { return product({o[axis], d[axis]}, {o[axis], d[axis]}); };
    const Coefficients rho_squared = sum(square(0), square(2), 1);
    const Wide half = Wide(c) / 2;
    switch (leaf.kind) {
        case Kind::sphere:
            return {sum(sum(rho_squared, square(1), 1), {Wide(a) * a}, -1)};
        case Kind::cube:
            return {plane(0, a), plane(0, -a), plane(1, b), plane(1, -b), plane(2, c), plane(2, -c)};
        case Kind::slab:
            return {plane(1, half), plane(1, -half)};
        case Kind::cylinder:
            return {sum(rho_squared, {Wide(a) * a}, -1)};
        case Kind::capped_cylinder:
            return {sum(rho_squared, {Wide(a) * a}, -1), plane(1, half), plane(1, -half)};
        case Kind::halfspace:
            return {plane(1, 0)};
        case Kind::cone: {
            const Wide slope = (Wide(b) - a) / c;
            const Coefficients radius{(Wide(a) + b) / 2 + slope * o[1], slope * d[1]};
            return {sum(rho_squared, product(radius, radius), -1), plane(1, half), plane(1, -half)};
        }
        case Kind::torus: {
            // (rho^2 + y^2 + R^2 - r^2)^2 - 4 R^2 rho^2
            const Coefficients inner = sum(sum(rho_squared, square(1), 1), {Wide(a) * a - Wide(b) * b}, 1);
            return {sum(product(inner, inner), rho_squared, -4 * Wide(a) * a)};
        }
    }
    return {};
}

// The gradient of a face's function, of any length.
WideTriple local_normal(const OracleLeaf& leaf, int face, const WideTriple& p) {
    using Kind = OracleLeaf::Kind;
    const auto axis = [](int i) {
        WideTriple n{0, 0, 0};
        n[static_cast<std::size_t>(i)] = 1;
        return n;
    };
    switch (leaf.kind) {
        case Kind::sphere:
            return p;
        case Kind::cube:
            return axis(face / 2);
        case Kind::slab:
        case Kind::halfspace:
            return axis(1);
        case Kind::cylinder:
        case Kind::capped_cylinder:
            return face == 0 ? WideTriple{p[0], 0, p[2]} : axis(1);
        case Kind::cone: {
            const Wide slope = (Wide(leaf.sizes[1]) - leaf.sizes[0]) / leaf.sizes[2];
            return face == 0 ? WideTriple{p[0], -slope * cone_radius(leaf, p[1]), p[2]} : axis(1);
        }
        case Kind::torus: {
            const Wide shrink = 1 - leaf.sizes[0] / std::sqrt(p[0] * p[0] + p[2] * p[2]);
            return {p[0] * shrink, p[1], p[2] * shrink};
        }
    }
    return {};
}

}  // namespace

WideTriple unit(const WideTriple& v) {
    const Wide length = std::sqrt(dot(v, v));
    return {v[0] / length, v[1] / length, v[2] / length};
}

WideTriple WideMap::vector(const WideTriple& v) const {
    WideTriple result{0, 0, 0};
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) result[j] += v[i] * linear[i][j];
    return result;
}

WideTriple WideMap::point(const WideTriple& p) const { return along(vector(p), translation, 1); }

WideMap WideMap::then(const WideMap& next) const {
    WideMap result;
    for (std::size_t i = 0; i < 3; ++i) result.linear[i] = next.vector(linear[i]);
    result.translation = next.point(translation);
    return result;
}

WideMap WideMap::inverse() const {
    // Cramer's rule.
    const auto cofactor = [&](std::size_t i, std::size_t j) {
        const std::size_t i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
        return linear[i1][j1] * linear[i2][j2] - linear[i1][j2] * linear[i2][j1];
    };
    const Wide determinant = linear[0][0] * cofactor(0, 0) + linear[0][1] * cofactor(0, 1) + linear[0][2] * cofactor(0, 2);
    WideMap result;
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) result.linear[j][i] = cofactor(i, j) / determinant;
    const WideTriple back = result.vector(translation);
    result.translation = {-back[0], -back[1], -back[2]};
    return result;
}

CsgOracle::Cuts CsgOracle::cuts(const WideTriple& origin, const WideTriple& direction, Wide from, Wide to) const {
    Cuts result{{}, wide_infinity};
    for (std::size_t i = 0; i < leaves_.size(); ++i) {
        const OracleLeaf& leaf = leaves_[i];
        const auto faces = surfaces(leaf, leaf.to_local.point(origin), leaf.to_local.vector(direction));
        for (std::size_t face = 0; face < faces.size(); ++face) {
            std::vector<Wide> near;
            for (const Wide t : sign_changes(faces[face], &near))
                if (from < t && t < to) result.sorted.push_back({t, static_cast<int>(i), static_cast<int>(face)});
            for (const Wide t : near)
                if (t > from) result.nearest_miss = std::min(result.nearest_miss, t);
        }
    }
    std::sort(result.sorted.begin(), result.sorted.end(), [](const Cut& a, const Cut& b) { return a.t < b.t; });
    return result;
}

bool CsgOracle::contains(const OracleNode& node, const WideTriple& p) const {
    using Operation = OracleNode::Operation;
    const auto inside = [&](const OracleNode& operand) { return contains(operand, p); };
    const auto first = node.operands.begin(), last = node.operands.end();
    switch (node.operation) {
        case Operation::leaf: {
            const OracleLeaf& leaf = leaves_[static_cast<std::size_t>(node.leaf)];
            return contains_local(leaf, leaf.to_local.point(p));
        }
        case Operation::union_:
        case Operation::merge:
            return std::any_of(first, last, inside);
        case Operation::intersection:
            return std::all_of(first, last, inside);
        case Operation::subtraction:
            return inside(*first) && std::none_of(first + 1, last, inside);
        case Operation::symdiff:
            return std::count_if(first, last, inside) % 2 == 1;
    }
    return false;
}

// The material of a point inside: of the leftmost operand that contains it.
int CsgOracle::medium(const OracleNode& node, const WideTriple& p) const {
    if (node.operation == OracleNode::Operation::leaf) return leaves_[static_cast<std::size_t>(node.leaf)].material;
    for (const OracleNode& operand : node.operands)
        if (contains(operand, p)) return medium(operand, p);
    return -1;
}

WideTriple CsgOracle::normal(const Cut& cut, const WideTriple& p) const {
    // Normals go with the inverse transpose: n' = n (M^-1)^T.
    const OracleLeaf& leaf = leaves_[static_cast<std::size_t>(cut.leaf)];
    const WideTriple local = local_normal(leaf, cut.face, leaf.to_local.point(p));
    return unit({dot(local, {leaf.to_local.linear[0][0], leaf.to_local.linear[0][1], leaf.to_local.linear[0][2]}),
                 dot(local, {leaf.to_local.linear[1][0], leaf.to_local.linear[1][1], leaf.to_local.linear[1][2]}),
                 dot(local, {leaf.to_local.linear[2][0], leaf.to_local.linear[2][1], leaf.to_local.linear[2][2]})});
}

OracleHit CsgOracle::first_hit(const WideTriple& origin, const WideTriple& direction) const {
    const Cuts all = cuts(origin, direction, 0, wide_infinity);
    const auto& sorted = all.sorted;
    OracleHit result;
    for (std::size_t i = 0; i < sorted.size(); ++i) {
        const bool last = i + 1 == sorted.size();
        result.doubtful = result.doubtful || (!last && sorted[i + 1].t - sorted[i].t < decision);
        const WideTriple middle = along(origin, direction, last ? sorted[i].t + 1 : (sorted[i].t + sorted[i + 1].t) / 2);
        if (!contains(middle)) continue;

        result.hit = true;
        result.t = sorted[i].t;
        result.leaf = sorted[i].leaf;
        result.point = along(origin, direction, result.t);
        result.normal = normal(sorted[i], result.point);
        if (dot(result.normal, direction) > 0) result.normal = {-result.normal[0], -result.normal[1], -result.normal[2]};
        result.material = leaves_[static_cast<std::size_t>(result.leaf)].material;
        if (result.material < 0) result.material = medium(root_, middle);
        break;
    }
    result.doubtful = result.doubtful || all.nearest_miss < (result.hit ? result.t : wide_infinity);
    return result;
}

bool CsgOracle::is_blocked(const WideTriple& origin, const WideTriple& direction, Wide distance, bool& doubtful) const {
    // The face itself is met at 0, to rounding.
    const Cuts all = cuts(origin, direction, 1e-12L, distance);
    Wide from = 0;
    for (std::size_t i = 0; i <= all.sorted.size(); ++i) {
        const Wide to = i < all.sorted.size() ? all.sorted[i].t : distance == wide_infinity ? from + 1 : distance;
        doubtful = doubtful || to - from < decision;
        if (contains(along(origin, direction, (from + to) / 2))) return true;
        from = to;
    }
    doubtful = doubtful || all.nearest_miss < distance;
    return false;
}

}  // namespace lapidary::test
