// SPDX-License-Identifier: MIT
//
// The bounds of noise, of its slope and of its curvature, that root isolation rests on.
//
// In a cell, noise is a sum over the corners of w_c(p) (g_c . r_c), with g_c one of twelve gradients; its first and second
// derivatives along a unit vector u are sums of
//
//     w' (g.r) + w (g.u)    and    w'' (g.r) + 2 w' (g.u).
//
// Each term is linear in its own g_c alone, so the largest sum at (p, u) takes the largest term of every corner. What is left is
// to search p over the cell and u over the sphere, here by climbing from many random starts.

#include <algorithm>
#include <array>
#include <random>

#include "lapidary/noise.h"
#include "support/catch.h"

namespace lapidary {

namespace {

struct Where {
    std::array<double, 3> place, along;
};

// The largest absolute value that a derivative of the given order can have, whatever the gradients.
double largest_derivative(int order, const Where& where) {
    const auto& [p, u] = where;
    double sum = 0;
    for (int corner = 0; corner < 8; ++corner) {
        std::array<double, 3> r{}, w0{}, w1{}, w2{};
        for (int i = 0; i < 3; ++i) {
            const double t = p[i], fade = t * t * t * (t * (t * 6 - 15) + 10);
            const bool far = (corner >> i & 1) != 0;
            const double sign = far ? 1 : -1;
            r[i] = t - far;
            w0[i] = far ? fade : 1 - fade;
            w1[i] = sign * 30 * t * t * (t - 1) * (t - 1) * u[i];
            w2[i] = sign * 60 * t * (2 * t - 1) * (t - 1) * u[i] * u[i];
        }
        const double w = w0[0] * w0[1] * w0[2];
        const double slope = w1[0] * w0[1] * w0[2] + w0[0] * w1[1] * w0[2] + w0[0] * w0[1] * w1[2];
        const double curvature = w2[0] * w0[1] * w0[2] + w0[0] * w2[1] * w0[2] + w0[0] * w0[1] * w2[2] +
                                 2 * (w1[0] * w1[1] * w0[2] + w1[0] * w0[1] * w1[2] + w0[0] * w1[1] * w1[2]);
        double largest = 0;
        for (const auto& g : noise_detail::lattice_gradients) {
            const double ramp = g.x * r[0] + g.y * r[1] + g.z * r[2], along = g.x * u[0] + g.y * u[1] + g.z * u[2];
            const double term = order == 0   ? w * ramp
                                : order == 1 ? slope * ramp + w * along
                                             : curvature * ramp + 2 * slope * along;
            largest = std::max(largest, std::fabs(term));
        }
        sum += largest;
    }
    return sum;
}

double climb(int order, std::mt19937_64& generator) {
    std::uniform_real_distribution<double> unit(0, 1);
    std::normal_distribution<double> normal;
    const auto with_unit_vector = [](Where where) {
        auto& u = where.along;
        const double size = std::sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]);
        for (double& component : u) component /= size;
        return where;
    };
    Where best = with_unit_vector(
        {{unit(generator), unit(generator), unit(generator)}, {normal(generator), normal(generator), normal(generator)}});
    double highest = largest_derivative(order, best), step = 0.3;
    for (int i = 0; i < 1500; ++i) {
        Where next = best;
        for (double& c : next.place) c = std::clamp(c + step * normal(generator), 0.0, 1.0);
        for (double& c : next.along) c += step * normal(generator);
        next = with_unit_vector(next);
        const double height = largest_derivative(order, next);
        if (height > highest) {
            highest = height, best = next;
        } else {
            step = std::max(step * 0.99, 1e-5);
        }
    }
    return highest;
}

}  // namespace

TEST_CASE("nothing exceeds the bounds of noise, and they are tight") {
    std::mt19937_64 generator(12);
    const double bounds[] = {noise_bound, noise_slope_bound, noise_curvature_bound};
    for (int order = 0; order < 3; ++order) {
        double highest = 0;
        for (int start = 0; start < 40; ++start) highest = std::max(highest, climb(order, generator));
        CAPTURE(order, highest);
        CHECK(highest <= bounds[order]);
        CHECK(highest >= 0.998 * bounds[order]);
    }
}

TEST_CASE("noise itself stays within its bounds") {
    std::mt19937_64 generator(13);
    std::uniform_real_distribution<double> coordinate(-128, 128);
    const double h = 1e-4;
    for (int i = 0; i < 100000; ++i) {
        const Point p{coordinate(generator), coordinate(generator), coordinate(generator)};
        const Vector u = normalize(Vector{coordinate(generator), coordinate(generator), coordinate(generator)});
        const NoiseSample here = noise_with_gradient(p), next = noise_with_gradient(p + h * u);
        REQUIRE(std::fabs(here.value) <= noise_bound);
        REQUIRE(length(here.gradient) <= noise_slope_bound);
        REQUIRE(std::fabs(dot(next.gradient - here.gradient, u)) <= noise_curvature_bound * h * (1 + 1e-9));
    }
}

}  // namespace lapidary
