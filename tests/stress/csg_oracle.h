// SPDX-License-Identifier: MIT
//
// The brute-force oracle of constructive solid geometry: slow, obvious, and independent of the kernel.
//
// A line is cut wherever it meets a surface of any leaf, in 80-bit arithmetic. Between two neighbouring cuts nothing changes, so
// the point in the middle tells whether the piece is inside: it is put into each leaf's defining inequality, and the Boolean
// expression does the rest. No spans, no leaping, no hierarchy, no normal form.
#pragma once

#include <array>
#include <random>
#include <string>
#include <vector>

#include "kernel/math/colour.h"

namespace lapidary::test {

using Wide = long double;
using WideTriple = std::array<Wide, 3>;

inline WideTriple along(const WideTriple& p, const WideTriple& d, Wide t) {
    return {p[0] + t * d[0], p[1] + t * d[1], p[2] + t * d[2]};
}
inline Wide dot(const WideTriple& a, const WideTriple& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
WideTriple unit(const WideTriple& v);

// p' = p linear + translation, with row vectors.
struct WideMap {
    std::array<WideTriple, 3> linear{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    WideTriple translation{0, 0, 0};

    WideMap then(const WideMap& next) const;
    WideMap inverse() const;
    WideTriple point(const WideTriple& p) const;
    WideTriple vector(const WideTriple& v) const;
};

struct OracleLeaf {
    enum class Kind { sphere, cube, torus, capped_cylinder, cone, slab, cylinder, halfspace };
    Kind kind = Kind::sphere;
    std::array<double, 3> sizes{1, 1, 1};  // as the properties of the language take them, the height last
    WideMap to_world, to_local;
    int material = -1;  // -1: none of its own
};

struct OracleNode {
    enum class Operation { leaf, union_, merge, subtraction, intersection, symdiff };
    Operation operation = Operation::leaf;
    std::vector<OracleNode> operands;
    int leaf = -1;
};

struct OracleHit {
    bool hit = false;
    bool doubtful = false;  // decided within 1e-9
    Wide t = 0;
    WideTriple point{}, normal{};  // unit, against the line
    int leaf = -1;
    int material = -1;  // what the face shows
};

// A random solid.
class CsgOracle {
public:
    CsgOracle(int leaves, std::mt19937_64& random);

    // The same solid in the scene language.
    const std::string& text() const { return text_; }
    const Colour& colour(int material) const { return colours_[static_cast<std::size_t>(material)]; }

    bool contains(const WideTriple& p) const { return contains(root_, p); }
    // The first face on a line behind its origin, which lies outside.
    OracleHit first_hit(const WideTriple& origin, const WideTriple& direction) const;
    // Whether anything lies on the way from a point of a face to a place that far along the line.
    bool is_blocked(const WideTriple& origin, const WideTriple& direction, Wide distance, bool& doubtful) const;

private:
    struct Cut {
        Wide t;
        int leaf, face;
    };
    struct Cuts {
        std::vector<Cut> sorted;
        Wide nearest_miss;  // where a surface is all but touched; infinity: nowhere
    };

    OracleNode grow(int leaves, bool bare, const WideMap& to_world, std::mt19937_64& random);
    OracleNode grow_leaf(bool bare, const WideMap& to_world, std::mt19937_64& random);

    Cuts cuts(const WideTriple& origin, const WideTriple& direction, Wide from, Wide to) const;
    bool contains(const OracleNode& node, const WideTriple& p) const;
    int medium(const OracleNode& node, const WideTriple& p) const;
    WideTriple normal(const Cut& cut, const WideTriple& p) const;

    // Bare operands show the innards of what they cut. Such solids have neither merges, which are of one piece inside, nor
    // symdiffs, where three operands that overlap leave open which of them is meant.
    bool has_bare_operands_;
    std::vector<OracleLeaf> leaves_;
    std::vector<Colour> colours_;
    OracleNode root_;
    std::string text_;
};

}  // namespace lapidary::test
