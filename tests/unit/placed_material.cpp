// SPDX-License-Identifier: MIT
//
// A material seen through a transform answers as the material itself does at the transformed place.
#include <cmath>
#include <memory>
#include <random>

#include "kernel/render/placed_material.h"
#include "support/catch.h"

namespace lapidary {

namespace {

// Layers of height 1 across y, with the relief h(p) = x y + z^3: everything about it is known in closed form.
class Layers final : public Material {
public:
    static double height(const Point& p) { return p.x * p.y + p.z * p.z * p.z; }

    Matter evaluate(const Site& site) const override {
        Matter matter;
        matter.colour = Colour::grey(std::floor(site.point.y));
        matter.depth = site.footprint;
        matter.relief = {site.point.y, site.point.x, 3 * site.point.z * site.point.z};
        return matter;
    }
    Crossing next_boundary(const MaterialLine& line, double from, double to) const override {
        const double next = std::floor(line.at(from).y) + (line.direction.y > 0 ? 1 : 0);
        const double t = (next - line.origin.y) / line.direction.y;
        return t < to ? Crossing{t, {0, 1, 0}} : Crossing{};
    }
    std::uint64_t region(const Point& p) const override { return static_cast<std::uint64_t>(std::floor(p.y) + 1e6); }
    double clearance(const Point& p) const override { return std::fabs(p.y - std::nearbyint(p.y)); }
    bool has_boundaries() const override { return true; }
    bool may_be_transparent() const override { return false; }
    bool may_reflect() const override { return false; }
    bool may_have_relief() const override { return true; }
};

struct Random {
    std::mt19937_64 engine{7};
    double operator()(double low, double high) { return std::uniform_real_distribution<double>(low, high)(engine); }
    Point point() { return {(*this)(-3, 3), (*this)(-3, 3), (*this)(-3, 3)}; }
    Vector vector() { return point() - Point{}; }
    ExactTransform transform() {
        const std::vector<TransformFactor> factors{
            {TransformFactor::Kind::scale, {(*this)(0.2, 5), -(*this)(0.2, 5), (*this)(0.2, 5)}},
            {TransformFactor::Kind::rotx, {(*this)(-3, 3)}},
            {TransformFactor::Kind::shear, {(*this)(-1, 1), (*this)(-1, 1), 0, (*this)(-1, 1)}},
            {TransformFactor::Kind::translate, {(*this)(-9, 9), (*this)(-9, 9), (*this)(-9, 9)}, true}};
        return ExactTransform::of(factors).value();
    }
};

}  // namespace

TEST_CASE("Placed matter is that of the material's own point", "[placed]") {
    Random random;
    for (int i = 0; i < 100; ++i) {
        const ExactTransform exact = random.transform();
        const Transform transform(exact);
        const PlacedMaterial placed(std::make_shared<Layers>(), exact);
        const Point local = random.point();
        const Point p = transform.to_parent(local);
        CHECK(placed.evaluate({p, 0}).colour.r == std::floor(transform.to_local(p).y));
        CHECK(placed.region(p) == Layers().region(transform.to_local(p)));
    }
}

TEST_CASE("The relief's slope is the gradient in the surroundings", "[placed]") {
    Random random;
    for (int i = 0; i < 100; ++i) {
        const ExactTransform exact = random.transform();
        const Transform transform(exact);
        const PlacedMaterial placed(std::make_shared<Layers>(), exact);
        const Point p = transform.to_parent(random.point());
        const Vector step = 1e-5 * normalize(random.vector());
        const double difference = Layers::height(transform.to_local(p + step)) - Layers::height(transform.to_local(p - step));
        CHECK(dot(placed.evaluate({p, 0}).relief, step) == Approx(difference / 2).epsilon(1e-5).margin(1e-11));
    }
}

TEST_CASE("Boundaries keep their place on the line and stand across it", "[placed]") {
    Random random;
    for (int i = 0; i < 100; ++i) {
        const ExactTransform exact = random.transform();
        const Transform transform(exact);
        const PlacedMaterial placed(std::make_shared<Layers>(), exact);
        const MaterialLine line{random.point(), random.vector()};
        const Crossing crossing = placed.next_boundary(line, 0, infinity);
        REQUIRE(crossing.t > 0);
        const Point met = line.at(crossing.t);
        const double y = transform.to_local(met).y;
        CHECK(y == Approx(std::nearbyint(y)).margin(1e-12));
        // Two ways within the boundary are at right angles to the normal.
        for (const Vector& within : {Vector{1, 0, 0}, Vector{0, 0, 1}})
            CHECK(dot(crossing.normal, transform.to_parent(within)) == Approx(0).margin(1e-12));
    }
}

TEST_CASE("Within its clearance a placed material has no boundary", "[placed]") {
    Random random;
    double tightest = 0;
    for (int i = 0; i < 2000; ++i) {
        const ExactTransform exact = random.transform();
        const PlacedMaterial placed(std::make_shared<Layers>(), exact);
        const Point p = random.point();
        const double clearance = placed.clearance(p);
        const Vector direction = normalize(random.vector());
        const double boundary = placed.next_boundary({p, direction}, 0, infinity).t;
        CHECK(boundary >= clearance * (1 - 1e-12));
        tightest = std::max(tightest, clearance / boundary);
    }
    CHECK(tightest > 0.5);  // a bound, not nothing
    // A pure rotation stretches nothing: the bound is within one per cent.
    const auto turned = ExactTransform::of({TransformFactor::Kind::rotx, {0.7}}).value();
    const Point off = Transform(turned).to_parent(Point{0, 0.25, 0});
    CHECK(PlacedMaterial(std::make_shared<Layers>(), turned).clearance(off) == Approx(0.25).epsilon(0.01));
}

TEST_CASE("The footprint shrinks as the material grows", "[placed]") {
    const auto doubled = ExactTransform::of({TransformFactor::Kind::scale, {2, 2, 2}}).value();
    CHECK(PlacedMaterial(std::make_shared<Layers>(), doubled).evaluate({{}, 1}).depth == Approx(0.5));
}

}  // namespace lapidary
