// SPDX-License-Identifier: MIT
//
// Noise against values worked out in exact rational arithmetic, at any coordinate.

#include "lapidary/noise.h"

#include <random>
#include <vector>

#include "lapidary/turbulence.h"
#include "support/catch.h"

namespace lapidary {

namespace {

const double nan = std::numeric_limits<double>::quiet_NaN();

Point random_point(std::mt19937_64& generator, double reach) {
    std::uniform_real_distribution<double> coordinate(-reach, reach);
    const double x = coordinate(generator), y = coordinate(generator), z = coordinate(generator);
    return {x, y, z};
}

}  // namespace

TEST_CASE("noise of many points is that of each") {
    std::mt19937_64 generator(11);
    const double reaches[] = {1, 300, 0x1p30, 0x1p32, 0x1p60, infinity};
    for (int round = 0; round < 4000; ++round) {
        PointBatch points;
        for (int i = 0; i < batch_size; ++i) {
            const double reach = reaches[i == 3 ? round % 6 : round % 3];
            const Point p = reach < infinity ? random_point(generator, reach) : Point{nan, reach, -reach};
            points.x[i] = i % 5 == 0 ? std::round(p.x) : p.x, points.y[i] = p.y, points.z[i] = p.z;
        }
        for (const int count : {4, 12, batch_size}) {
            double values[batch_size];
            noise_batch(points, count, values);
            for (int i = 0; i < count; ++i) REQUIRE(values[i] == noise(points.point(i)));
        }
    }
}

TEST_CASE("turbulence at three places is that at each") {
    std::mt19937_64 generator(12);
    for (int round = 0; round < 4000; ++round) {
        const std::array places{random_point(generator, 10), random_point(generator, 1e6), random_point(generator, 0x1p30)};
        const int n = 1 + round % 14, count = round % (n + 1);
        const Vector sums = turbulence(places, n, count);
        REQUIRE(sums.x == turbulence(places[0], n, count));
        REQUIRE(sums.y == turbulence(places[1], n, count));
        REQUIRE(sums.z == turbulence(places[2], n, count));
    }
}

TEST_CASE("noise has its golden values") {
    struct Golden {
        Point point;
        double value;
    };
    const std::vector<Golden> table{
        {{0, 0, 0}, 0},
        {{0.5, 0.5, 0.5}, -0.25},
        {{0.25, 0.5, 0.75}, -282817.0 / 1048576},
        {{1.5, 2.25, 3.125}, 2585331.0 / 33554432},
        {{-0.5, -0.5, -0.5}, -0.875},
        {{-1.25, 2.5, -3.75}, 158713.0 / 524288},
        {{3.14, 42, 7}, 0.13691995878400012},
        {{0.1, 0.2, 0.3}, 0.351229248781107},
        {{12.75, -7.5, 255.5}, -35.0 / 8192},
        {{255.5, 255.5, 255.5}, -0.875},
        {{256.5, 0.5, 0.5}, -0.25},
        {{-256.5, -255.25, 511.75}, -98795.0 / 1048576},
        {{1000.125, 2000.25, 3000.5}, -17652495.0 / 134217728},
        {{123.456, -654.321, 0.987}, -0.252253681692484},
        {{2147483647.5, 0.5, 0.25}, -0.25},
        {{2147483648.5, 0.5, 0.25}, -0.25},
        {{-2147483648.5, 0.5, 0.25}, -0.25},
        {{4294967296.5, 0.5, 0.25}, -0.25},
        {{1099511627776.75, -1099511627776.75, 0.5}, 497317.0 / 2097152},
        {{4503599627370495.5, 0.5, 0.5}, -0.25},
        {{9007199254740992, 0.5, 0.5}, 0},
        {{1e300, -1e300, 0.25}, 309.0 / 1024},
    };
    for (const Golden& golden : table) {
        CAPTURE(golden.point.x, golden.point.y, golden.point.z);
        CHECK(std::fabs(noise(golden.point) - golden.value) <= 1e-15);
        CHECK(std::fabs(noise_with_gradient(golden.point).value - golden.value) <= 1e-15);
    }
}

TEST_CASE("noise is 0 on the lattice") {
    std::mt19937_64 generator(1);
    std::uniform_real_distribution<double> exponent(0, 300);
    for (int i = 0; i < 100000; ++i) {
        const double reach = std::pow(10, exponent(generator));
        const Point p = random_point(generator, reach);
        REQUIRE(noise({std::round(p.x), std::round(p.y), std::round(p.z)}) == 0);
    }
    for (double x : {0x1p31, -0x1p31, 0x1p53, -0x1p53, 1e300, -0x1p63}) CHECK(noise({x, x + 1, -x}) == 0);
}

TEST_CASE("noise does not jump at 0, at negative integers or next to them") {
    const double step = 0x1p-20;
    double steepest = 0;
    for (double x = -2; x < 2; x += step)
        steepest = std::fmax(steepest, std::fabs(noise({x + step, 0.3, 0.7}) - noise({x, 0.3, 0.7})) / step);
    CHECK(steepest <= noise_slope_bound);
    for (double x : {-0.0, -1e-320, 1e-320, -1e-17, -1e-9})
        CHECK(noise({x, 0.3, 0.7}) == Approx(noise({0, 0.3, 0.7})).margin(4e-9));
}

TEST_CASE("noise repeats every 256, however far out") {
    std::mt19937_64 generator(2);
    for (int i = 0; i < 10000; ++i) {
        Point p = random_point(generator, 256);
        for (double* c : {&p.x, &p.y, &p.z}) *c = std::round(*c * 64) / 64;
        for (double period : {0x1p8, 0x1p20, 0x1p31, 0x1p32, 0x1p43}) {
            REQUIRE(noise({p.x + period, p.y, p.z - period}) == noise(p));
            REQUIRE(noise_with_gradient({p.x - period, p.y + period, p.z}).gradient == noise_with_gradient(p).gradient);
        }
    }
}

TEST_CASE("noise at a place that is not finite is 0") {
    for (double bad : {nan, infinity, -infinity})
        for (const Point& p : {Point{bad, 0.5, 0.5}, Point{0.5, bad, 0.5}, Point{0.5, 0.5, bad}, Point{bad, -bad, bad}}) {
            CHECK(noise(p) == 0);
            CHECK(noise_with_gradient(p).value == 0);
            CHECK(noise_with_gradient(p).gradient == Vector{});
        }
}

TEST_CASE("noise has the statistics that it is known for") {
    std::mt19937_64 generator(3);
    double sum = 0, squares = 0, magnitudes = 0;
    const int count = 200000;
    for (int i = 0; i < count; ++i) {
        const double value = noise(random_point(generator, 128));
        sum += value, squares += value * value, magnitudes += std::fabs(value);
    }
    CHECK(std::fabs(sum / count) < 2e-3);
    CHECK(std::sqrt(squares / count) == Approx(0.2701).margin(2e-3));
    CHECK(magnitudes / count == Approx(mean_absolute_noise).margin(2e-3));
}

TEST_CASE("the gradient of noise is continuous and smooth across the faces of cells") {
    std::mt19937_64 generator(4);
    const double step = 1e-7;
    for (int i = 0; i < 10000; ++i) {
        Point p = random_point(generator, 20);
        p.x = std::round(p.x);
        const NoiseSample before = noise_with_gradient({p.x - step, p.y, p.z});
        const NoiseSample behind = noise_with_gradient({p.x + step, p.y, p.z});
        REQUIRE(length(behind.gradient - before.gradient) <= 3 * noise_curvature_bound * 2 * step);
    }
}

TEST_CASE("turbulence is the sum of its octaves") {
    std::mt19937_64 generator(5);
    for (int i = 0; i < 1000; ++i) {
        const Point p = random_point(generator, 50);
        double sum = 0;
        for (int octave = 5; octave >= 0; --octave) {
            const double f = std::exp2(octave);
            sum += std::fabs(noise({f * p.x, f * p.y, f * p.z})) / f;
        }
        REQUIRE(turbulence(p, 6) == Approx(sum).epsilon(1e-14));
        REQUIRE(turbulence_with_gradient(p, 6).value == Approx(sum).epsilon(1e-14));
        // Three octaves, and the mean of what 1/8 + 1/16 + 1/32 of them add.
        const std::uint64_t faded = octaves_faded_by_thread();
        REQUIRE(turbulence(p, 6, 3) == Approx(turbulence(p, 3) + mean_absolute_noise * 0.21875).epsilon(1e-14));
        REQUIRE(octaves_faded_by_thread() == faded + 3);
    }
}

TEST_CASE("turbulence strays no farther from its tangent than it says") {
    std::mt19937_64 generator(6);
    std::uniform_real_distribution<double> exponent(-6, 0);
    double closest = infinity;
    for (int i = 0; i < 20000; ++i) {
        const Point p = random_point(generator, 50);
        const Vector direction = normalize(to_vector(random_point(generator, 1)));
        const double s = std::pow(10, exponent(generator));
        const TurbulenceExpansion expansion(p, direction, 6);
        const double stray = std::fabs(turbulence(p + s * direction, 6) - (expansion.value() + expansion.slope() * s));
        REQUIRE(stray <= expansion.stray(s) + 1e-14);
        if (stray > 1e-9) closest = std::fmin(closest, expansion.stray(s) / stray);
    }
    CHECK(closest < 2);  // the bound is not idle
}

}  // namespace lapidary
