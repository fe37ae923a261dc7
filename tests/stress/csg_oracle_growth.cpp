// SPDX-License-Identifier: MIT
//
// Random solids for the oracle, grown as trees and written down in the scene language on the way.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "csg_oracle.h"

namespace lapidary::test {
namespace {

double between(double low, double high, std::mt19937_64& random) { return std::uniform_real_distribution<>(low, high)(random); }
int pick(int count, std::mt19937_64& random) { return std::uniform_int_distribution<>(0, count - 1)(random); }

// A rotation about any axis takes +x toward +y where the axis is +z (Rodrigues).
WideMap rotation(const WideTriple& axis, Wide angle) {
    const WideTriple k = unit(axis);
    const Wide c = std::cos(angle), s = std::sin(angle);
    WideMap map;
    for (std::size_t i = 0; i < 3; ++i) {
        WideTriple e{0, 0, 0};
        e[i] = 1;
        const WideTriple cross{k[1] * e[2] - k[2] * e[1], k[2] * e[0] - k[0] * e[2], k[0] * e[1] - k[1] * e[0]};
        for (std::size_t j = 0; j < 3; ++j) map.linear[i][j] = c * e[j] + s * cross[j] + (1 - c) * k[i] * k[j];
    }
    return map;
}

// A chain of random operations, as text and as a map.
struct Chain {
    std::string text;
    WideMap map;

    void rotate(std::mt19937_64& random) {
        const double angle = between(-3, 3, random);
        const int which = pick(4, random);
        if (which < 3) {
            WideTriple axis{0, 0, 0};
            axis[static_cast<std::size_t>(which)] = 1;
            text += fmt::format("rot{}({}); ", "xyz"[which], angle);
            map = map.then(rotation(axis, angle));
        } else {
            const double x = between(-1, 1, random), y = between(-1, 1, random), z = between(0.1, 1, random);
            text += fmt::format("rotate({}, {}, {}, {}); ", x, y, z, angle);
            map = map.then(rotation({x, y, z}, angle));
        }
    }
    void scale(std::mt19937_64& random) {
        WideMap stretch;
        std::array<double, 3> factors{};
        for (std::size_t i = 0; i < 3; ++i) {
            factors[i] = between(0.5, 1.6, random) * (pick(8, random) == 0 ? -1 : 1);
            stretch.linear[i][i] = factors[i];
        }
        text += fmt::format("scale({}, {}, {}); ", factors[0], factors[1], factors[2]);
        map = map.then(stretch);
    }
    void translate(double range, std::mt19937_64& random) {
        const double x = between(-range, range, random), y = between(-range, range, random), z = between(-range, range, random);
        text += fmt::format("translate({}, {}, {}); ", x, y, z);
        map.translation = along(map.translation, {x, y, z}, 1);
    }
};

}  // namespace

CsgOracle::CsgOracle(int leaves, std::mt19937_64& random) : has_bare_operands_(pick(2, random) == 0) {
    root_ = grow(leaves, false, {}, random);
}

OracleNode CsgOracle::grow(int leaves, bool bare, const WideMap& to_world, std::mt19937_64& random) {
    using Operation = OracleNode::Operation;
    if (leaves == 1) return grow_leaf(bare, to_world, random);

    constexpr std::array<const char*, 6> keywords{"", "union", "merge", "subtraction", "intersection", "symdiff"};
    OracleNode node;
    node.operation = static_cast<Operation>(1 + pick(5, random));
    const bool cuts = node.operation == Operation::subtraction || node.operation == Operation::intersection;
    if (has_bare_operands_ && (node.operation == Operation::merge || node.operation == Operation::symdiff))
        node.operation = Operation::union_;
    text_ += keywords[static_cast<std::size_t>(node.operation)];

    // Operands stand in one block, or in branches. A block can be transformed as a whole.
    const bool branches = pick(2, random) == 0;
    Chain chain;
    text_ += " {\n";
    if (!branches && pick(3, random) == 0) {
        chain.rotate(random);
        chain.translate(0.5, random);
        text_ += "transform { " + chain.text + "}\n";
    }
    const WideMap inner = chain.map.then(to_world);

    int operands = 2 + pick(std::min(leaves - 1, 4), random);
    for (int left = leaves; operands > 0; --operands) {
        const int share = operands == 1 ? left : 1 + pick(left - operands + 1, random);
        left -= share;
        if (branches && !node.operands.empty()) text_ += "} with {\n";
        const bool operand_bare = bare || (cuts && has_bare_operands_ && !node.operands.empty() && pick(3, random) == 0);
        node.operands.push_back(grow(share, operand_bare, inner, random));
    }
    text_ += "}\n";
    return node;
}

OracleNode CsgOracle::grow_leaf(bool bare, const WideMap& to_world, std::mt19937_64& random) {
    using Kind = OracleLeaf::Kind;
    OracleLeaf leaf;
    // What is infinite comes less often, or it would swallow the rest.
    leaf.kind = static_cast<Kind>(pick(4, random) == 0 ? pick(8, random) : pick(5, random));
    auto& [a, b, c] = leaf.sizes;
    a = between(0.5, 1.3, random);
    b = between(0.5, 1.3, random);
    c = between(0.5, 1.3, random);
    switch (leaf.kind) {
        case Kind::sphere:
            text_ += fmt::format("sphere {{ radius({}); ", a);
            break;
        case Kind::cube:
            text_ += fmt::format("cube {{ size({}, {}, {}); ", a, b, c);
            break;
        case Kind::torus:
            b *= 0.35;
            text_ += fmt::format("torus {{ radii({}, {}); ", a, b);
            break;
        case Kind::capped_cylinder:
            c *= 2;
            text_ += fmt::format("cylinder {{ radius({}); height({}); ", a, c);
            break;
        case Kind::cone:
            if (pick(2, random) == 0) b = 0;
            c *= 2;
            text_ += fmt::format("cone {{ radii({}, {}); height({}); ", a, b, c);
            break;
        case Kind::slab:
            text_ += fmt::format("plane {{ thickness({}); ", c);
            break;
        case Kind::cylinder:
            text_ += fmt::format("cylinder {{ radius({}); ", a);
            break;
        case Kind::halfspace:
            text_ += "halfspace { ";
            break;
    }
    if (!bare) {
        const Colour colour{between(0.1, 0.9, random), between(0.1, 0.9, random), between(0.1, 0.9, random)};
        text_ += fmt::format("colour({}, {}, {}); ", colour.r, colour.g, colour.b);
        leaf.material = static_cast<int>(colours_.size());
        colours_.push_back(colour);
    }
    Chain chain;
    chain.rotate(random);
    chain.scale(random);
    chain.rotate(random);
    chain.translate(1.2, random);
    text_ += "transform { " + chain.text + "} }\n";
    leaf.to_world = chain.map.then(to_world);
    leaf.to_local = leaf.to_world.inverse();
    leaves_.push_back(leaf);

    OracleNode node;
    node.leaf = static_cast<int>(leaves_.size()) - 1;
    return node;
}

}  // namespace lapidary::test
