// SPDX-License-Identifier: MIT
//
// Affine maps: the senses of the scene language, order, inverses, and digits kept where others lose them.

#include "kernel/math/transform.h"

#include <cmath>
#include <numbers>
#include <random>

#include "support/catch.h"

namespace lapidary {
namespace {

using Kind = TransformFactor::Kind;
constexpr double pi = std::numbers::pi, u = 0x1p-53;

TransformFactor factor(Kind kind, std::array<double, 12> values) { return {kind, values, false}; }

Transform composed(const std::vector<TransformFactor>& factors) {
    const auto exact = ExactTransform::of(factors);
    REQUIRE(exact);
    return Transform(*exact);
}

double distance(const Point& a, const Point& b) { return length(a - b); }

std::vector<TransformFactor> random_factors(std::mt19937_64& engine, int count) {
    std::uniform_real_distribution<double> number(-2, 2), size(0.5, 2);
    std::vector<TransformFactor> factors;
    for (int i = 0; i < count; ++i) {
        const auto kind = static_cast<Kind>(engine() % 8);
        TransformFactor f = factor(kind, {});
        for (double& v : f.values) v = number(engine);
        if (kind == Kind::scale) f.values = {size(engine), -size(engine), size(engine)};
        if (kind == Kind::matrix)
            for (int k : {0, 4, 8}) f.values[k] += 6;  // far from singular
        if (kind == Kind::shear)
            for (double& v : f.values) v *= 0.2;
        f.inverted = engine() % 4 == 0;
        factors.push_back(f);
    }
    return factors;
}

}  // namespace

TEST_CASE("rotations turn as the language says, right angles exactly") {
    CHECK(composed({factor(Kind::rotx, {pi / 2})}).to_parent(Point{0, 1, 0}) == Point{0, 0, 1});
    CHECK(composed({factor(Kind::roty, {pi / 2})}).to_parent(Point{0, 0, 1}) == Point{1, 0, 0});
    CHECK(composed({factor(Kind::rotz, {pi / 2})}).to_parent(Point{1, 0, 0}) == Point{0, 1, 0});
    CHECK(composed({factor(Kind::rotz, {pi})}).to_parent(Point{1, 2, 3}) == Point{-1, -2, 3});
    CHECK(composed({factor(Kind::rotz, {-pi / 2})}).to_parent(Point{1, 0, 0}) == Point{0, -1, 0});
}

TEST_CASE("a rotation about an axis has the sense of the three about x, y and z") {
    const double angle = 0.7;
    for (int axis = 0; axis < 3; ++axis) {
        std::array<double, 12> values{0, 0, 0, angle};
        values[axis] = 3;
        const Transform general = composed({factor(Kind::rotate, values)});
        const Transform special = composed({factor(static_cast<Kind>(static_cast<int>(Kind::rotx) + axis), {angle})});
        CHECK(distance(general.to_parent(Point{1, 2, 3}), special.to_parent(Point{1, 2, 3})) <= 4 * u);
    }
}

TEST_CASE("factors apply in the order written") {
    const auto move = factor(Kind::translate, {1, 0, 0}), grow = factor(Kind::scale, {2, 2, 2});
    CHECK(composed({move, grow}).to_parent(Point{0, 0, 0}) == Point{2, 0, 0});
    CHECK(composed({grow, move}).to_parent(Point{0, 0, 0}) == Point{1, 0, 0});
}

TEST_CASE("shear and matrix map as the language says") {
    const Transform shear = composed({factor(Kind::shear, {0.1, 0.2, 0.3, 0.4, 0.5, 0.6})});
    CHECK(distance(shear.to_parent(Point{1, 10, 100}), {1 + 0.1 * 10 + 0.2 * 100, 10 + 0.3 + 0.4 * 100, 100 + 0.5 + 0.6 * 10}) <=
          1e-13);
    // p M, rows written one after the other, the last one the translation.
    const Transform matrix = composed({factor(Kind::matrix, {1, 2, 0, 0, 1, 0, 0, 0, 1, 7, 8, 9})});
    CHECK(matrix.to_parent(Point{1, 1, 1}) == Point{8, 11, 10});
}

TEST_CASE("what goes to the parent comes back") {
    std::mt19937_64 engine(1);
    for (int i = 0; i < 200; ++i) {
        const auto factors = random_factors(engine, 1 + static_cast<int>(engine() % 6));
        const Transform t = composed(factors);
        const Point p{0.3, -0.7, 1.1};
        CHECK(distance(t.to_local(t.to_parent_two_part(p)), p) <= 1e-9);
        const Vector v{1, 2, 3};
        CHECK(length(t.to_local(t.to_parent(v)) - v) <= 1e-9);
        // Normals stay across what they stood across.
        const Vector across = cross(v, Vector{0, 0, 1});
        const Normal n = normalize(t.to_parent(Normal(across)));
        CHECK(std::fabs(dot(n, normalize(t.to_parent(v)))) <= 1e-9);
    }
}

TEST_CASE("the inverse of a composition undoes it") {
    std::mt19937_64 engine(2);
    for (int i = 0; i < 100; ++i) {
        const auto exact = ExactTransform::of(random_factors(engine, 5));
        REQUIRE(exact);
        const Transform round_trip(exact->then(exact->inverse()));
        CHECK(distance(round_trip.to_parent(Point{1, 2, 3}), {1, 2, 3}) <= 1e-13);
    }
}

TEST_CASE("singular and non-finite factors are refused") {
    const double nan = std::nan("");
    for (const TransformFactor& f :
         {factor(Kind::scale, {1, 0, 1}), factor(Kind::scale, {nan, 1, 1}), factor(Kind::scale, {1, infinity, 1}),
          factor(Kind::matrix, {1, 2, 3, 2, 4, 6, 0, 0, 1, 0, 0, 0}),
          factor(Kind::matrix, {1, 0, 0, 0, 1, 0, 0, 0, nan, 0, 0, 0}), factor(Kind::rotate, {0, 0, 0, 1}),
          factor(Kind::rotx, {infinity}), factor(Kind::translate, {nan, 0, 0}), factor(Kind::shear, {1, 0, 1, 0, 0, 0})})
        CHECK_FALSE(ExactTransform::of(f));
}

TEST_CASE("a tiny scale, whose determinant underflows, is a scale") {
    const Transform t = composed({factor(Kind::scale, {1e-160, 1e-160, 1e-160})});
    CHECK(t.to_parent(Point{1, 2, 3}) == Point{1e-160, 2e-160, 3e-160});
    CHECK(distance(t.to_local(Point{1e-160, 2e-160, 3e-160}), {1, 2, 3}) <= 8 * u);
    CHECK(composed({factor(Kind::matrix, {1e-160, 0, 0, 0, 1e-160, 0, 0, 0, 1e-160, 0, 0, 0})}).to_local(Point{1e-160, 0, 0}).x ==
          Approx(1));
}

TEST_CASE("a point far from the world's origin keeps its place in the object") {
    const Transform t = composed({factor(Kind::rotx, {0.3}), factor(Kind::translate, {1e9, -1e9, 1e9})});
    const Point p{0.1, 0.2, 0.3};
    CHECK(distance(t.to_local(t.to_parent_two_part(p)), p) <= 8 * u);
}

TEST_CASE("bounds stay around what they bound, infinite or empty") {
    std::mt19937_64 engine(9);
    for (int i = 0; i < 100; ++i) {
        const Transform t = composed(random_factors(engine, 3));
        const Bounds bounds = t.to_parent(Bounds::box(1, 2, 3));
        for (int corner = 0; corner < 8; ++corner) {
            const Point p = t.to_parent(Point{corner & 1 ? 1.0 : -1.0, corner & 2 ? 2.0 : -2.0, corner & 4 ? 3.0 : -3.0});
            const double rounding = 1e-12 * (length(p) + 1);
            CHECK((p.x >= bounds.low.x - rounding && p.y >= bounds.low.y - rounding && p.z >= bounds.low.z - rounding));
            CHECK((p.x <= bounds.high.x + rounding && p.y <= bounds.high.y + rounding && p.z <= bounds.high.z + rounding));
        }
    }
    CHECK(Transform().to_parent(Bounds::empty()).is_empty());
    const Bounds slab{{-infinity, -1, -infinity}, {infinity, 1, infinity}};
    const Bounds turned = composed({factor(Kind::rotz, {pi / 2})}).to_parent(slab);
    CHECK(turned.low.x == -1);
    CHECK(turned.high.x == 1);
    CHECK(turned.low.y == -infinity);
    CHECK(turned.high.z == infinity);
}

}  // namespace lapidary
