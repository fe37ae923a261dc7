// SPDX-License-Identifier: MIT
//
// Placed solids, T21 and T52 to T58: needles, a condition of 1e12, long chains, mirrors, sizes of 1e-160, against the same
// placement in 200-bit arithmetic.

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "stress/exact.h"
#include "support/measurement.h"
#include "support/scenes.h"
#include "support/solids.h"
#include "support/traced_scene.h"

namespace lapidary::test {
namespace {

using ExactMatrix = std::array<ExactVector, 3>;  // rows

ExactVector operator*(const Exact& s, const ExactVector& v) { return {s * v.x, s * v.y, s * v.z}; }
ExactVector operator+(const ExactVector& a, const ExactVector& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
ExactVector operator-(const ExactVector& a, const ExactVector& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
ExactVector times(const ExactVector& v, const ExactMatrix& m) { return v.x * m[0] + v.y * m[1] + v.z * m[2]; }
ExactMatrix times(const ExactMatrix& a, const ExactMatrix& b) { return {times(a[0], b), times(a[1], b), times(a[2], b)}; }
double norm(const ExactVector& v) { return static_cast<double>(Exact(sqrt(dot(v, v)))); }
ExactVector unit(const ExactVector& v) { return (1 / sqrt(dot(v, v))) * v; }

// About an axis through the origin, z from x toward y.
ExactMatrix turned(const ExactVector& axis, const Exact& angle) {
    const ExactVector k = unit(axis);
    const Exact c = cos(angle), s = sin(angle);
    const auto row = [&](const ExactVector& e, const ExactVector& k_cross_e, const Exact& along) {
        return c * e + s * k_cross_e + (along * (1 - c)) * k;
    };
    return {row({1, 0, 0}, {0, k.z, -k.y}, k.x), row({0, 1, 0}, {-k.z, 0, k.x}, k.y), row({0, 0, 1}, {k.y, -k.x, 0}, k.z)};
}

// The placement that a chain of translations, scales and rotations is.
class ExactPlacement {
public:
    explicit ExactPlacement(const Factors& factors) {
        for (const TransformFactor& factor : factors) {
            const auto& v = factor.values;
            if (factor.kind == TransformFactor::Kind::translate) {
                centre_ = centre_ + ExactVector(v[0], v[1], v[2]);
                continue;
            }
            REQUIRE((factor.kind == TransformFactor::Kind::scale || factor.kind == TransformFactor::Kind::rotate));
            const bool scales = factor.kind == TransformFactor::Kind::scale;
            const ExactVector axis(v[0], v[1], v[2]);
            apply(scales ? diagonal(v[0], v[1], v[2]) : turned(axis, v[3]),
                  scales ? diagonal(1 / Exact(v[0]), 1 / Exact(v[1]), 1 / Exact(v[2])) : turned(axis, -Exact(v[3])));
        }
    }

    ExactVector point_to_local(const ExactVector& p) const { return times(p - centre_, inverse_); }
    ExactVector vector_to_local(const ExactVector& v) const { return times(v, inverse_); }
    // By the inverse transpose, of unit length.
    ExactVector normal_to_world(const ExactVector& n) const {
        return unit({dot(n, inverse_[0]), dot(n, inverse_[1]), dot(n, inverse_[2])});
    }

private:
    static ExactMatrix diagonal(const Exact& x, const Exact& y, const Exact& z) {
        return {ExactVector{x, 0, 0}, ExactVector{0, y, 0}, ExactVector{0, 0, z}};
    }
    void apply(const ExactMatrix& map, const ExactMatrix& back) {
        linear_ = times(linear_, map);
        inverse_ = times(back, inverse_);
        centre_ = times(centre_, map);
    }

    ExactMatrix linear_ = diagonal(1, 1, 1), inverse_ = diagonal(1, 1, 1);
    ExactVector centre_{0, 0, 0};
};

// One ray through a World of one solid.
class Probe {
public:
    explicit Probe(const SceneNodePtr& solid) : spans_(solid), line_(spans_.world(), statistics_) {
        REQUIRE(spans_.world().solids.size() == 1);
    }

    void start(const Ray& ray) {
        line_.start(ray);
        line_.select(spans_.world().solids[0]);
    }
    double enter(double t) { return line_.enter(t); }
    double leave(double t) { return line_.leave(t); }
    FaceHit face_at(double t) { return line_.face_at(line_.leaf_at(t), t); }

private:
    SpansThrough spans_;
    TraceStatistics statistics_;
    LineThroughSolid line_;
};

Ray ray_at(const Point& target, double distance, Random& random) {
    const Vector d = random.direction();
    return ray_from(target - distance * d, d);
}

// The names and bounds of what is measured of a placed solid.
struct Bounds4 {
    const char *test, *what;
    double local, normal, world;
};

// Balls and boxes under a placement: the hit in the solid's own space against where the ray truly meets it, whether it lies on
// the surface, there and in the world, and the normal against the exact one at that place.
void check_placed(const std::string& keyword, const Factors& factors, const Vector& spread, double distance,
                  const Bounds4& bounds, int rays) {
    SolidMaker maker;
    const SceneNodePtr leaf = maker.leaf(keyword, factors);
    const Transform placement(leaf->transform);
    const ExactPlacement exact(factors);
    Probe probe(leaf);
    const std::string name = std::string(bounds.what) + ", ";
    Measurement local({bounds.test, name + "where it is met", "own units", bounds.local}),
        surface({bounds.test, name + "on its surface", "u", 4}),
        world({bounds.test, name + "in the world", "own units", bounds.world}),
        normal({bounds.test, name + "normals", "absolute", bounds.normal});
    const bool ball = keyword == "sphere";
    const auto size = [&](const ExactVector& p) {
        return ball ? Exact(sqrt(dot(p, p))) : std::max({Exact(abs(p.x)), Exact(abs(p.y)), Exact(abs(p.z))});
    };
    Random random(52);
    for (int i = 0; i < rays; ++i) {
        const Vector aim = random.uniform(0, 0.5) * random.direction();
        const Point inside{spread.x * aim.x, spread.y * aim.y, spread.z * aim.z};
        const Ray ray = ray_at(placement.to_parent(inside), distance, random);
        const ExactVector o = exact.point_to_local(ray.origin.anchor), d = exact.vector_to_local(ray.direction);
        probe.start(ray);
        const double t = local.timed([&] { return probe.enter(0); });
        local.expect(t < infinity);
        if (!(t < infinity)) continue;
        const FaceHit hit = normal.timed([&] { return probe.face_at(t); });
        // The true place: by the quadratic, or by the plane of the face that was found.
        const std::array<Exact, 3> from{o.x, o.y, o.z}, along{d.x, d.y, d.z}, found{hit.local.x, hit.local.y, hit.local.z};
        std::size_t axis = 0;
        for (std::size_t k = 1; k < 3; ++k)
            if (abs(found[k]) > abs(found[axis])) axis = k;
        const Exact side = found[axis] < 0 ? -1 : 1;
        const auto roots = quadratic_roots(sphere_polynomial(o, d, 1));
        if (ball) REQUIRE(roots.size() == 2);
        const Exact truly = ball ? roots[0] : (side - from[axis]) / along[axis];
        const ExactVector at_truth = at(o, d, truly);
        local.record(norm(ExactVector(hit.local) - at_truth));
        surface.record(static_cast<double>(Exact(size(ExactVector(hit.local)) - 1)) / u);
        const ExactVector far = ExactVector(hit.point.anchor) + ExactVector(hit.point.offset);
        world.record(static_cast<double>(Exact(size(exact.point_to_local(far)) - 1)));
        ExactVector outward(hit.local);
        if (!ball) outward = {axis == 0 ? side : Exact(0), axis == 1 ? side : Exact(0), axis == 2 ? side : Exact(0)};
        normal.record(norm(ExactVector(to_vector(hit.normal)) - exact.normal_to_world(outward)));
    }
}

const std::vector<std::string> primitives{"sphere", "cube", "cylinder", "cone", "torus", "halfspace"};

// Rays past the origin, at most 1.5 away from it, of a world of a size.
Ray ray_past(Random& random, double size = 1) {
    const Vector d = random.direction();
    const Vector aside = random.uniform(0, 1.5) * normalize(cross(d, random.direction()));
    return ray_from(to_point(size * (aside - 5 * d)), d);
}

// That a primitive under two placements is one and the same solid: nothing is left of either without the other.
void check_same(Measurement& same, const Factors& a, const Factors& b) {
    Random random(58);
    for (const std::string& keyword : primitives) {
        SolidMaker maker;
        SpansThrough left(maker.combine(Operation::symdiff, {maker.leaf(keyword, a), maker.leaf(keyword, b)}));
        SpansThrough alone(maker.leaf(keyword, a)),
            both(maker.combine(Operation::intersection, {maker.leaf(keyword, a), maker.leaf(keyword, b)}));
        same.expect(left.world().solids.empty() || left.world().features.shared_surfaces);
        for (int i = 0; i < 200; ++i) {
            const Ray ray = ray_past(random);
            same.expect(left(ray).empty());
            same.expect(alone(ray).size() == both(ray).size());
        }
    }
}

}  // namespace

TEST_CASE("T21: needles and pancakes") {
    // Seen from near their middle, where their thickness is what counts.
    check_placed("sphere", {scale(1, 1e6, 1e-6)}, {1, 1e-6, 1}, 10, {"T21", "ellipsoid 1 : 1e6 : 1e-6", 1e-9, 1e-12, 1e-9}, 1000);
    check_placed("sphere", {scale(1e-6, 1e6, 1e-6)}, {1, 1e-6, 1}, 10, {"T21", "needle", 1e-9, 1e-12, 1e-9}, 1000);
    check_placed("sphere", {scale(1e6, 1e-6, 1e6)}, {1e-6, 1, 1e-6}, 10, {"T21", "pancake", 1e-9, 1e-12, 1e-9}, 1000);
}

TEST_CASE("T52: placements of condition 1e12") {
    const Factors factors{rotate({1, 2, 3}, 0.7), scale(1e6, 1, 1e-6), rotate({-2, 1, 0.5}, 1.1)};
    constexpr double condition = 1e12;
    for (const auto& [keyword, what] : {std::pair{"sphere", "ball"}, std::pair{"cube", "box"}})
        check_placed(keyword, factors, {1, 1, 1}, 3e6, {"T52", what, u * condition, 1e-11, u * condition}, 1000);
}

TEST_CASE("T53: a thousand rotations that return are the identity") {
    Factors chain, back;
    Random random(53);
    for (int i = 0; i < 500; ++i) {
        const Vector axis = random.direction();
        const double angle = random.uniform(-3, 3);
        chain.push_back(rotate(axis, angle));
        back.insert(back.begin(), rotate(axis, -angle));
    }
    chain.insert(chain.end(), back.begin(), back.end());
    Measurement identity({"T53", "1000 rotations", "u", 8}), same({"T53", "turned solid and the same at rest", "", 0});
    const Transform t(*ExactTransform::of(chain));
    for (const Point& p : {Point{1, 0, 0}, Point{0, 1, 0}, Point{0, 0, 1}, Point{1, 2, 3}})
        identity.record(length(t.to_parent(p) - p) / u);
    check_same(same, {}, chain);
}

TEST_CASE("T54: a reflection keeps normals outward") {
    Measurement outward({"T54", "normals under a reflection", "", 0});
    Random random(54);
    for (const std::string& keyword : primitives) {
        SolidMaker maker;
        Probe probe(maker.leaf(keyword, {rotate({0, 0, 1}, 0.4), scale(-1, 1, 1), rotate({1, 0, 0}, 0.3)}));
        int hits = 0;
        for (int i = 0; i < 300; ++i) {
            const Ray ray = ray_past(random);
            probe.start(ray);
            for (double t = probe.enter(0); t < infinity;) {
                if (t > 0) outward.expect(dot(to_vector(probe.face_at(t).normal), ray.direction) < 0);
                const double out = probe.leave(t);
                if (!(out < infinity)) break;
                outward.expect(dot(to_vector(probe.face_at(out).normal), ray.direction) > 0);
                ++hits;
                t = probe.enter(out);
            }
        }
        CHECK(hits > 20);
    }
    CHECK(Transform(*ExactTransform::of({scale(-1, 1, 1)})).mirrors());
    CHECK_FALSE(Transform(*ExactTransform::of({scale(-1, -1, 1)})).mirrors());
}

TEST_CASE("T55: singular placements are refused where they are written") {
    Measurement refused({"T55", "singular and non-finite placements", "", 0});
    for (const char* factor : {"scale(1, 0, 1);", "scale(0);", "scale(0/0, 1, 1);", "scale(1, 1/0, 1);",
                               "matrix(1, 2, 3, 2, 4, 6, 0, 0, 1, 0, 0, 0);", "matrix(1, 0, 0, 0, 1, 0, 0, 0, 0/0, 0, 0, 0);",
                               "rotate(0, 0, 0, 1);", "rotx(1/0);", "translate(0/0, 0, 0);", "shear(1, 0, 1, 0, 0, 0);"}) {
        const auto built = build("objects { sphere { transform {\n" + std::string(factor) + " } } }");
        INFO(factor);
        bool told = false;
        for (const std::string& line : built->headlines()) told = told || line.find("s:2:") == 0;
        CHECK(told);
        refused.expect(told && built->messages.errors() > 0 && !built->scene);
    }
}

TEST_CASE("T56: a scale of 1e-160 shows what a scale of 1 shows") {
    Measurement same({"T56", "solids of 1e-160", "u", 64});
    const auto solid = [](SolidMaker& maker, double s) {
        return maker.combine(
            Operation::subtraction,
            {maker.leaf("cube"), maker.combine(Operation::union_, {maker.leaf("sphere", {scale(1.2, 1.2, 1.2)}),
                                                                   maker.leaf("cylinder", {scale(0.3, 1, 0.3)})})},
            {rotate({1, 1, 0}, 0.5), scale(s, s, s)});
    };
    constexpr double tiny = 1e-160;
    SolidMaker maker;
    SpansThrough usual(solid(maker, 1)), small(solid(maker, tiny));
    Random random(56);
    for (int i = 0; i < 500; ++i) {
        const Ray ray = ray_past(random);
        const Point o = ray.origin.anchor;
        const auto expected = usual(ray);
        const auto found = small({Point{tiny * o.x, tiny * o.y, tiny * o.z}, ray.direction, {}, {}});
        same.expect(found.size() == expected.size());
        for (std::size_t k = 0; k < std::min(found.size(), expected.size()); ++k) {
            same.record((found[k].in / tiny - expected[k].in) / (5 * u));
            same.record((found[k].out / tiny - expected[k].out) / (5 * u));
        }
    }
}

TEST_CASE("T56: matter looks the same at any size") {
    // A power of two changes no digit, of textures as little as of places. (Without relief: its height is one of the world.)
    const auto scene_of = [](double size) {
        return fmt::format(
            "lights {{ ambient {{ }} direct {{ direction(1, -2, 1.5); }} }} objects {{ union {{ "
            "torus {{ radii(1.2, 0.5); material {{ noise {{ solid {{ colour(1, 0, 0); }} solid {{ reflection(0.5); }} "
            "value(0.5); "
            "transform {{ scale(0.2); }} }} }} }} sphere {{ radius(0.7); material {{ sine {{ colour(0, 0.3, 1); bump(0); "
            "transform {{ scale(0.1); }} }} }} }} transform {{ rotx(0.6); scale({}); }} }} }}",
            size);
    };
    constexpr double footprint = 0.002;
    Measurement same({"T56", "matter of 2^-490 to 2^490", "", 0});
    for (const double size : {0x1p-490, 0x1p-345, 0x1p-60, 0x1p345, 0x1p490}) {
        CAPTURE(size);
        TracedScene usual(scene_of(1), footprint), other(scene_of(size), footprint);
        CHECK(usual.world().leaves.size() == other.world().leaves.size());
        Random random(156);
        for (int i = 0; i < 300; ++i) {
            const Ray ray = ray_past(random);
            const Colour expected = usual.colour(ray.origin.anchor, ray.direction);
            const Colour found = other.colour(to_point(size * to_vector(ray.origin.anchor)), ray.direction);
            same.expect(found.r == expected.r && found.g == expected.g && found.b == expected.b);
        }
    }
}

TEST_CASE("T56: what is scaled beyond the squares of lengths is told") {
    Measurement told({"T56", "scales and sizes of 1e-300 to 1e300", "", 0});
    const auto warnings = [](const std::string& object) {
        const auto built = build("lights { ambient { } } objects {\n" + object + " }");
        REQUIRE(built->scene);
        prepare_world(*built->scene, built->messages);
        return built->headlines();
    };
    for (const char* scale : {"1e-300", "1e-200", "1e-153", "1e153", "1e200", "1e300"}) {
        const auto lines = warnings("sphere { transform { scale(" + std::string(scale) + "); } }");
        CAPTURE(lines);
        told.expect(lines.size() == 1 && lines[0].find("s:2:1: warning: this object is scaled by 1e") == 0);
    }
    for (const char* scale : {"1e-150", "1e-100", "1e100", "1e150"})
        told.expect(warnings("sphere { transform { scale(" + std::string(scale) + "); } }").empty());
    // Sizes of its own an object measures itself by.
    for (const char* radius : {"1e-300", "1e-160", "1e150", "1e300"})
        told.expect(warnings("sphere { radius(" + std::string(radius) + "); }").empty());
}

TEST_CASE("T57: what stands too far away for its size is told") {
    Measurement told({"T57", "a ball of 1 at 1e3 to 1e300", "", 0});
    const auto warnings = [](const std::string& away) {
        const auto built = build("lights { ambient { } } objects {\nsphere { transform { translate(" + away + ", 0, 0); } } }");
        REQUIRE(built->scene);
        const auto world = prepare_world(*built->scene, built->messages);
        TraceStatistics statistics;
        LineThroughSolid line(*world, statistics);
        for (const Solid& solid : world->solids) {
            // Nothing ends the program; what is met is somewhere.
            line.start(ray_from({std::stod(away) - 4, 0.1, 0.2}, {1, 0, 0}));
            line.select(solid);
            CHECK_FALSE(std::isnan(line.enter(0)));
        }
        return built->headlines();
    };
    for (const char* near : {"1e3", "1e6", "1e9", "1e12"}) told.expect(warnings(near).empty());
    for (const char* far : {"1e15", "1e18", "1e100", "1e300"}) {
        const auto lines = warnings(far);
        told.expect(lines.size() == 1 && lines[0].find("s:2:1: warning: this object of size 3.5 stands where numbers are ") == 0);
    }
    CHECK(warnings("1e15")[0].find("are 0.12 apart") != std::string::npos);
}

TEST_CASE("T58: two ways of writing one placement are one") {
    Measurement same({"T58", "translation and rotation in either order", "", 0});
    constexpr double pi = std::numbers::pi;
    check_same(same, {translate(0.5, 0.25, 0.125), rotate({0, 0, 1}, pi / 2)},
               {rotate({0, 0, 1}, pi / 2), translate(-0.25, 0.5, 0.125)});
    check_same(same, {scale(2, 2, 2), rotate({1, 2, 3}, 0.7)}, {rotate({1, 2, 3}, 0.7), scale(2, 2, 2)});
    check_same(same, {rotate({0, 1, 0}, 0.3), rotate({0, 1, 0}, 0.4)}, {rotate({0, 2, 0}, 0.7)});
}

}  // namespace lapidary::test
