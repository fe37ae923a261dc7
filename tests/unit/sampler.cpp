// SPDX-License-Identifier: MIT
//
// Sample points: what makes them Sobol points, what makes them independent of one another.

#include "kernel/render/sampler.h"

#include <cmath>
#include <set>
#include <utility>
#include <vector>

#include "support/catch.h"

using namespace lapidary;

namespace {

// The second Sobol dimension by its recurrence v[k+1] = v[k] ^ (v[k] >> 1), bit by bit.
std::uint32_t second_sobol_dimension(std::uint32_t index) {
    std::uint32_t result = 0;
    for (std::uint32_t direction = 1u << 31; index != 0; index >>= 1, direction ^= direction >> 1)
        if (index & 1) result ^= direction;
    return result;
}

// Whether every cell of a grid of columns × rows holds exactly one of the points.
bool fills_grid(const std::vector<SamplePair>& points, int columns, int rows) {
    std::set<int> cells;
    for (const SamplePair& p : points) cells.insert(static_cast<int>(p.u * columns) + columns * static_cast<int>(p.v * rows));
    return cells.size() == points.size();
}

}  // namespace

TEST_CASE("the Pascal product is the second Sobol dimension") {
    for (std::uint32_t i = 0; i < 100000; ++i) {
        const std::uint32_t index = i * 2654435761u;
        REQUIRE(sampling::reverse_bits(sampling::pascal_product(index)) == second_sobol_dimension(index));
    }
}

TEST_CASE("the further dimensions are those of the recurrence of direction numbers") {
    // v_k = a_1 v_(k-1) ^ … ^ a_(s-1) v_(k-s+1) ^ v_(k-s) ^ (v_(k-s) >> s), as Joe and Kuo write it.
    struct Direction {
        int degree;
        unsigned inner;  // a_1 … a_(s-1) as a number
        std::vector<std::uint32_t> first;
    };
    const std::vector<Direction> directions{{2, 1, {1, 3}}, {3, 1, {1, 3, 1}}, {3, 2, {1, 1, 1}}, {4, 1, {1, 1, 3, 3}}};
    for (std::uint32_t dimension = 2; dimension < 6; ++dimension) {
        const Direction& direction = directions[dimension - 2];
        std::vector<std::uint32_t> v;
        for (int k = 0; k < 32; ++k) {
            if (k < direction.degree) {
                v.push_back(direction.first[static_cast<std::size_t>(k)] << (31 - k));
                continue;
            }
            const std::uint32_t oldest = v[v.size() - static_cast<std::size_t>(direction.degree)];
            std::uint32_t next = oldest ^ oldest >> direction.degree;
            for (int j = 1; j < direction.degree; ++j)
                if (direction.inner >> (direction.degree - 1 - j) & 1) next ^= v[v.size() - static_cast<std::size_t>(j)];
            v.push_back(next);
        }
        for (std::uint32_t i = 0; i < 20000; ++i) {
            const std::uint32_t index = i * 2654435761u;
            std::uint32_t expected = 0;
            for (std::size_t k = 0; k < 32; ++k)
                if (index >> k & 1) expected ^= v[k];
            REQUIRE(sampling::reverse_bits(sampling::sobol_product(dimension, index)) == expected);
        }
    }
}

TEST_CASE("every power of two of samples fills every elementary grid of a pixel, and every axis of each pair") {
    for (const std::uint32_t pair : {dimension_pair::pixel, dimension_pair::lens, dimension_pair::first_light, 17u})
        for (int pixel = 0; pixel < 20; ++pixel)
            for (int bits = 0; bits <= 6; ++bits) {
                std::vector<SamplePair> points;
                for (std::uint32_t i = 0; i < 1u << bits; ++i) points.push_back(sample_pair(sample_key(pixel, 7, i), pair));
                for (int across = 0; across <= bits; ++across)
                    if (pair == dimension_pair::pixel || across == 0 || across == bits)
                        REQUIRE(fills_grid(points, 1 << across, 1 << (bits - across)));
            }
}

TEST_CASE("places in the pixel and on a light are stratified together, in four dimensions") {
    // Of 2^m points every elementary box of the volume 2^(3-m) holds eight.
    constexpr int bits = 8, spare = 3, boxes = 1 << (bits - spare);
    for (int pixel = 0; pixel < 20; ++pixel)
        for (int a = 0; a <= bits - spare; ++a)
            for (int b = 0; a + b <= bits - spare; ++b)
                for (int c = 0; a + b + c <= bits - spare; ++c) {
                    const int d = bits - spare - a - b - c;
                    std::vector<int> held(boxes, 0);
                    for (std::uint32_t i = 0; i < 1u << bits; ++i) {
                        const SampleKey key = sample_key(pixel, 3, i);
                        const SamplePair p = sample_pair(key, dimension_pair::pixel),
                                         q = sample_pair(key, dimension_pair::first_light);
                        int box = 0;
                        for (const auto& [x, digits] : {std::pair{p.u, a}, {p.v, b}, {q.u, c}, {q.v, d}})
                            box = (box << digits) + static_cast<int>(x * (1 << digits));
                        ++held[static_cast<std::size_t>(box)];
                    }
                    REQUIRE(held == std::vector<int>(boxes, 1 << spare));
                }
}

TEST_CASE("samples lie strictly inside the unit square") {
    CHECK(sampling::to_unit_interval(0) > 0);
    CHECK(sampling::to_unit_interval(0xffffffffu) < 1);
}

TEST_CASE("pairs of dimensions are independent of one another") {
    // f(u, u') = (u - 1/2)(u' - 1/2) has the mean 0 over independent pairs, ±1/12 over tied ones. Averaged over many
    // pixels it must vanish, and within a pixel it must fall with the number of samples.
    constexpr int pixels = 4096;
    for (const auto& [first, second] : {std::pair{0u, 1u}, {0u, 16u}, {1u, 16u}}) {
        double previous = 1;
        for (const std::uint32_t samples : {16u, 64u, 256u}) {
            double mean = 0, square = 0;
            for (int pixel = 0; pixel < pixels; ++pixel) {
                double sum = 0;
                for (std::uint32_t i = 0; i < samples; ++i) {
                    const SampleKey key = sample_key(pixel % 64, pixel / 64, i);
                    sum += (sample_pair(key, first).u - 0.5) * (sample_pair(key, second).u - 0.5);
                }
                mean += sum / samples;
                square += sum / samples * sum / samples;
            }
            mean /= pixels;
            const double deviation = std::sqrt(square / pixels);
            INFO("pairs " << first << " and " << second << ", " << samples << " samples: mean " << mean << ", deviation "
                          << deviation);
            CHECK(std::fabs(mean) < 4 * deviation / std::sqrt(pixels));
            CHECK(deviation < 1.5 / 12 / std::sqrt(samples));
            CHECK(deviation < 0.75 * previous);
            previous = deviation;
        }
    }
}

TEST_CASE("neighbouring pixels take different samples") {
    double covariance = 0;
    constexpr int size = 128;
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x)
            covariance += (sample_pair(sample_key(x, y, 0), 0).u - 0.5) * (sample_pair(sample_key(x + 1, y, 0), 0).u - 0.5);
    CHECK(std::fabs(covariance / (size * size)) < 4 / 12.0 / size);
}

TEST_CASE("the square goes onto the disc evenly") {
    constexpr int size = 256;
    double mean_square_radius = 0;
    int inner = 0;
    for (int j = 0; j < size; ++j)
        for (int i = 0; i < size; ++i) {
            const DiscPoint p = disc_from_square({(i + 0.5) / size, (j + 0.5) / size});
            const double r2 = p.x * p.x + p.y * p.y;
            REQUIRE(r2 <= 1);
            mean_square_radius += r2;
            inner += r2 < 0.25;
        }
    CHECK(mean_square_radius / (size * size) == Approx(0.5).margin(1e-4));
    CHECK(inner / double(size * size) == Approx(0.25).margin(1e-2));
    CHECK(disc_from_square({0.5, 0.5}).x == 0);
}

TEST_CASE("lens points begin at the centre and cover the disc") {
    for (const int count : {1, 2, 7, 64, 1000}) {
        const std::vector<DiscPoint> points = even_disc_points(count);
        REQUIRE(points.size() == static_cast<std::size_t>(count));
        CHECK(points[0].x == 0);
        CHECK(points[0].y == 0);
        double x = 0, y = 0, r2 = 0;
        for (const DiscPoint& p : points) {
            REQUIRE(std::hypot(p.x, p.y) < 1);
            x += p.x / count, y += p.y / count, r2 += (p.x * p.x + p.y * p.y) / count;
        }
        if (count >= 64) {
            CHECK(std::hypot(x, y) < 1.0 / std::sqrt(count) / 4);
            CHECK(r2 == Approx(0.5).margin(0.01));
        }
    }
}
