// SPDX-License-Identifier: MIT
//
// Matter along a ray: what it is beside a surface, where it changes, what it lets through.
#include "kernel/render/medium.h"

#include <cmath>

#include "support/catch.h"
#include "support/textures.h"

using namespace lapidary;
using namespace lapidary::test;

namespace {

MaterialPtr glass(double index, const Colour& colour = Colour::white(), double depth = 1) {
    return texture("solid",
                   {number("refraction", {index}), number("colour", {colour.r, colour.g, colour.b}), number("depth", {depth})});
}

// A material in the world's own space.
class Placed : public MaterialInstance {
public:
    explicit Placed(const MaterialPtr& material) : texture_{material.get(), {}} {
        may_be_transparent = material->may_be_transparent();
        if (material->is_uniform())
            finish_ = material->evaluate({}), colour = finish_.colour, finish = &finish_;
        else
            texture = &texture_;
    }
    Placed(const Placed&) = delete;
    Placed& operator=(const Placed&) = delete;

private:
    PlacedTexture texture_;
    Matter finish_;
};

}  // namespace

TEST_CASE("On a boundary of a texture, matter is that of the side which is asked for") {
    const MaterialPtr even = glass(1.5), odd = glass(1.25);
    const MaterialPtr checkers = texture("checkers", {}, {even, odd}), rings = texture("rings", {}, {even, odd});
    for (const double far : {0.0, 16.0, 1e6}) {
        CAPTURE(far);
        const Point on_plane{far + 2, 0.5, 0.5}, on_shell{0, far + 2, 0};
        CHECK(matter_beside(Placed(checkers), {on_plane, 0}, {1, 0, 0}).refraction == 1.5);
        CHECK(matter_beside(Placed(checkers), {on_plane, 0}, {-1, 0, 0}).refraction == 1.25);
        CHECK(matter_beside(Placed(rings), {on_shell, 0}, {0, 1, 0}).refraction == 1.5);
        CHECK(matter_beside(Placed(rings), {on_shell, 0}, {0, -1, 0}).refraction == 1.25);
    }
}

TEST_CASE("A boundary at an end of a stretch is none, one within is") {
    const MaterialPtr checkers = texture("checkers", {}, {glass(1.5), glass(1.25)});
    const MaterialLine along_x{{0, 0.5, 0.5}, {1, 0, 0}};
    CHECK(next_crossing(*checkers, along_x, 0, 3).t == 1);
    CHECK(next_crossing(*checkers, along_x, 1, 3).t == 2);
    CHECK(next_crossing(*checkers, along_x, std::nextafter(1, 0), 3).t == 2);
    CHECK(next_crossing(*checkers, along_x, 0.5, 1).t == infinity);
    CHECK(next_crossing(*checkers, along_x, 0.5, std::nextafter(1, 2)).t == infinity);
    CHECK(next_crossing(*checkers, along_x, 0.5, 1.001).t == 1);
}

TEST_CASE("On a line that grazes a boundary, rounding across it moves the end far along it") {
    // Starts on the shell of radius 1 but for rounding, going outward all but along it: 1e-16 within is 1e-11 before it.
    const MaterialPtr rings = texture("rings", {}, {glass(1.5), glass(1.25)});
    for (const double slope : {1e-1, 1e-3, 1e-5}) {
        CAPTURE(slope);
        const Vector direction = normalize(Vector{1, slope, 0});
        const double shell_of_two = next_crossing(*rings, {{0, 1, 0}, direction}, 0, 10).t;
        CHECK(shell_of_two == Approx(-direction.y + std::sqrt(3 + direction.y * direction.y)).epsilon(1e-14));
        CHECK(next_crossing(*rings, {{0, 1 - 0x1p-53, 0}, direction}, 0, 10).t == Approx(shell_of_two));
        CHECK(next_crossing(*rings, {{0, 1 + 0x1p-52, 0}, direction}, 0, 10).t == Approx(shell_of_two));
        // Going inward, the chord of the shell itself is met again.
        const Vector inward = normalize(Vector{1, -slope, 0});
        CHECK(next_crossing(*rings, {{0, 1 + 0x1p-52, 0}, inward}, 0, 10).t == Approx(2 * slope).epsilon(1e-2));
    }
}

TEST_CASE("A crossing found from afar lies on the boundary as one found nearby") {
    const MaterialPtr rings = texture("rings", {}, {glass(1.5), glass(1.25)});
    const Placed instance(rings);
    for (const double distance : {1.0, 1e3, 1e6, 1e9}) {
        CAPTURE(distance);
        const Vector direction = normalize(Vector{-1, 0.3, 0.2});
        const Point origin = Point{0.3, 0.2, 0.1} - distance * direction;
        const MaterialLine line = material_line(instance, origin, direction);
        const Crossing crossing = rings->next_boundary(line, distance, infinity);
        REQUIRE(crossing.t < infinity);
        const Point p = crossing_point(instance, origin, direction, crossing.t).rounded();
        CHECK(std::fabs(length(p) - 1) <= 8e-16);
    }
}

TEST_CASE("T69 Transmittance is that of Beer and Lambert, and exactly 1 for what does not absorb") {
    const MaterialPtr matter = glass(1.5, {std::exp(-0.5), 1, 0}, 2);
    const Placed rose(matter);
    const MaterialLine line{{}, {1, 0, 0}};
    CHECK(std::fabs(transmittance(rose, line, 0, 3.2).r - 0.4493289641172216) <= 1e-16);
    CHECK(transmittance(rose, line, 0, 1e300).g == 1);
    CHECK(transmittance(rose, line, 0, infinity).g == 1);
    CHECK(transmittance(rose, line, 0, infinity).r == 0);
    CHECK(transmittance(rose, line, 0, 1).b == 0);
    CHECK(transmittance(rose, line, 1, 1).r == 1);
    // The length counts in the world, not in the material's space.
    CHECK(transmittance(rose, {{}, {5, 0, 0}}, 0, 3.2).r == transmittance(rose, line, 0, 3.2).r);
}

TEST_CASE("Where colour varies, transmittance is the integral along the way") {
    const MaterialPtr waves = texture("sine", {number("refraction", {1.5}), number("colour", {0.9, 1, 0.5}),
                                               number("colour2", {0.3, 1, 0.5}), number("bump", {0})});
    const Placed sine(waves);
    // Simpson's rule with very many steps, for the logarithm of the colour.
    const auto integral = [](double from, double to) {
        constexpr int steps = 20000;
        const double h = (to - from) / steps;
        double sum = 0;
        for (int i = 0; i <= steps; ++i) {
            const double t = (1 + std::sin(from + i * h)) / 2;
            sum += (i == 0 || i == steps ? 1 : i % 2 == 1 ? 4 : 2) * std::log(0.9 * (1 - t) + 0.3 * t);
        }
        return sum * h / 3;
    };
    const MaterialLine line{{}, {1, 0, 0}};
    for (const double length : {1e-3, 0.5, 2.0, 6.283185307179586, 10.0, 40.0}) {
        CAPTURE(length);
        const Colour passed = transmittance(sine, line, 0.25, 0.25 + length);
        CHECK(passed.r == Approx(std::exp(integral(0.25, 0.25 + length))).epsilon(1e-10));
        CHECK(passed.g == 1);
        CHECK(passed.b == Approx(std::pow(0.5, length)).epsilon(1e-12));
    }
}
