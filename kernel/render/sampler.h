// SPDX-License-Identifier: MIT
//
// The numbers that a sample is made of: Owen-scrambled Sobol points, computed from nothing but the pixel's coordinates,
// the sample's number and the purpose, so that a picture does not depend on who computes which sample when.
//
// Dimension d of the Sobol point of index i, read as a vector of bits over GF(2), is
//
//     x_d = reverse(C_d i),   C_d an upper triangular matrix with a diagonal of ones.
//
// C_0 is the unit matrix; C_1 is Pascal's matrix modulo 2, the fivefold Kronecker power of (1 1; 0 1), so that C_1 i takes
// five shifts. The others come from primitive polynomials (below), and their products from tables of bytes.
//
// An Owen scrambling flips every bit of x by a random function of the bits above it. On the reversed number that is a
// function of the bits below, which is what a chain of multiplications by even numbers plus one does (Laine and Karras
// 2011, with Vegdahl's constants). Thus
//
//     scrambled x_d = reverse(hash_d(C_d i)).
//
// The place in the pixel takes the dimensions 0 and 1, those of the best pair there is; places on lights take 2 and 3, the
// place on the lens takes 4 and 5. They belong to one point in six dimensions. Of an edge across d dimensions, n points that
// are stratified together leave an error of
//
//     n^-(1/2 + 1/(2d)):
//
// n^-0.75 in the pixel alone, n^-0.625 together with a light or with the lens, n^-0.58 with both. Measured over 4 to 1024
// samples: 0.75 (dice), 0.62 to 0.67 (soft light), 0.65 (a lens), 0.60 (both, with glass and mirrors). Pairs that are each
// good, but shuffled against one another, leave n^-0.5. Not to scramble the pairs apart would tie the place in the pixel to
// the place on the lens: an error that more samples never remove.
//
// All lights share two dimensions, each scrambled in its own way. What lights send is added, so that no error is made of
// places on two of them together.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <vector>

#include "kernel/export.h"
#include "kernel/render/ray.h"

namespace lapidary {

// Two numbers in (0, 1), uniformly distributed together.
struct SamplePair {
    double u = 0.5, v = 0.5;
};

// What a pair of numbers is for. Lights take first_light + n, n = 0, 1, 2 …
namespace dimension_pair {
inline constexpr std::uint32_t pixel = 0;
inline constexpr std::uint32_t lens = 1;
inline constexpr std::uint32_t first_light = 16;
}  // namespace dimension_pair

namespace sampling {

constexpr std::uint32_t reverse_bits(std::uint32_t x) {
    x = ((x >> 1) & 0x55555555u) | ((x & 0x55555555u) << 1);
    x = ((x >> 2) & 0x33333333u) | ((x & 0x33333333u) << 2);
    x = ((x >> 4) & 0x0f0f0f0fu) | ((x & 0x0f0f0f0fu) << 4);
    x = ((x >> 8) & 0x00ff00ffu) | ((x & 0x00ff00ffu) << 8);
    return (x >> 16) | (x << 16);
}

// Pascal's triangle modulo 2, times the vector of bits.
constexpr std::uint32_t pascal_product(std::uint32_t x) {
    x ^= (x >> 1) & 0x55555555u;
    x ^= (x >> 2) & 0x33333333u;
    x ^= (x >> 4) & 0x0f0f0f0fu;
    x ^= (x >> 8) & 0x00ff00ffu;
    return x ^ (x >> 16);
}

// A primitive polynomial x^s + a_1 x^(s-1) + … + a_(s-1) x + 1 over GF(2), and the first s of the odd numbers m that its
// recurrence
//
//     m_k = 2 a_1 m_(k-1) ^ 4 a_2 m_(k-2) ^ … ^ 2^s m_(k-s) ^ m_(k-s)
//
// goes on from. Column k of the dimension's matrix holds the k + 1 bits of m_k, the lowest of them on the diagonal.
struct SobolDimension {
    int degree;
    std::array<std::uint32_t, 4> coefficients;  // from a_1 on; that of the last term is 1
    std::array<std::uint32_t, 4> first;
};

// The third to the sixth (Joe and Kuo 2008).
inline constexpr std::array<SobolDimension, 4> sobol_dimensions{
    {{2, {1, 1}, {1, 3}}, {3, {0, 1, 1}, {1, 3, 1}}, {3, {1, 0, 1}, {1, 1, 1}}, {4, {0, 0, 1, 1}, {1, 1, 3, 3}}}};

constexpr std::array<std::uint32_t, 32> sobol_columns(const SobolDimension& dimension) {
    std::array<std::uint32_t, 32> m{}, columns{};
    for (int k = 0; k < 32; ++k) {
        if (k < dimension.degree) {
            m[k] = dimension.first[k];
        } else {
            m[k] = m[k - dimension.degree];
            for (int j = 1; j <= dimension.degree; ++j) m[k] ^= dimension.coefficients[j - 1] * (m[k - j] << j);
        }
        columns[k] = reverse_bits(m[k] << (31 - k));
    }
    return columns;
}

// A matrix as the products of its columns with every value of each of a number's four bytes.
using SobolTable = std::array<std::array<std::uint32_t, 256>, 4>;

constexpr SobolTable sobol_table(const SobolDimension& dimension) {
    const std::array<std::uint32_t, 32> columns = sobol_columns(dimension);
    SobolTable table{};
    for (int byte = 0; byte < 4; ++byte)
        for (int value = 1; value < 256; ++value) {
            const int top = std::bit_width(static_cast<unsigned>(value)) - 1;
            table[byte][value] = table[byte][value ^ (1 << top)] ^ columns[8 * byte + top];
        }
    return table;
}

inline constexpr std::array<SobolTable, 4> sobol_tables{sobol_table(sobol_dimensions[0]), sobol_table(sobol_dimensions[1]),
                                                        sobol_table(sobol_dimensions[2]), sobol_table(sobol_dimensions[3])};

// C_d i.
constexpr std::uint32_t sobol_product(std::uint32_t dimension, std::uint32_t index) {
    if (dimension == 0) return index;
    if (dimension == 1) return pascal_product(index);
    const SobolTable& table = sobol_tables[dimension - 2];
    return table[0][index & 255] ^ table[1][index >> 8 & 255] ^ table[2][index >> 16 & 255] ^ table[3][index >> 24];
}

// A permutation in which every bit depends on itself and the bits below it only.
constexpr std::uint32_t scramble_upward(std::uint32_t x, std::uint32_t seed) {
    x ^= x * 0x3d20adeau;
    x += seed;
    x *= (seed >> 16) | 1u;
    x ^= x * 0x05526c56u;
    x ^= x * 0x53a22864u;
    return x;
}

// A well mixed function of two numbers (Wellons' low-bias finaliser).
constexpr std::uint32_t hash(std::uint32_t a, std::uint32_t b) {
    std::uint32_t x = a * 0x9e3779b9u ^ (b + 0x7f4a7c15u + (a << 6) + (a >> 2));
    x ^= x >> 16;
    x *= 0x21f0aaadu;
    x ^= x >> 15;
    x *= 0x735a2d97u;
    return x ^ (x >> 15);
}

// The middle of the cell that a 32-bit number stands for: never 0, never 1.
constexpr double to_unit_interval(std::uint32_t x) { return (x + 0.5) * 0x1p-32; }

}  // namespace sampling

// Pictures of different `sequence` have independent samples.
constexpr std::uint32_t pixel_key(std::uint32_t x, std::uint32_t y, std::uint32_t sequence) {
    const std::uint32_t pixel = sampling::hash(x, y), of_sequence = sampling::hash(pixel, sequence);
    return sequence == 0 ? pixel : of_sequence;
}

inline SampleKey sample_key(int x, int y, std::uint32_t sample, std::uint32_t sequence = 0) {
    return {pixel_key(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y), sequence), sample};
}

// The pairs of one purpose for all samples of a pixel: how they are scrambled is worked out once.
class SamplePairs {
public:
    SamplePairs(std::uint32_t pixel, std::uint32_t pair)
        : first_(pair == dimension_pair::pixel  ? 0
                 : pair == dimension_pair::lens ? 4
                                                : 2) {
        const std::uint32_t seed = sampling::hash(pixel, pair);
        seeds_ = {sampling::hash(seed, 1), sampling::hash(seed, 2)};
    }

    SamplePair operator[](std::uint32_t sample) const {
        using namespace sampling;
        const auto scrambled = [&](std::uint32_t dimension, std::uint32_t seed) {
            return to_unit_interval(reverse_bits(scramble_upward(sobol_product(dimension, sample), seed)));
        };
        return {scrambled(first_, seeds_[0]), scrambled(first_ + 1, seeds_[1])};
    }

private:
    std::uint32_t first_;  // dimension
    std::array<std::uint32_t, 2> seeds_;
};

inline SamplePair sample_pair(SampleKey key, std::uint32_t pair) { return SamplePairs(key.pixel, pair)[key.sample]; }

// A place on the unit disc.
struct DiscPoint {
    double x = 0, y = 0;
};

// The square onto the disc, areas and neighbourhoods kept (Shirley and Chiu 1997): concentric squares become circles.
LAPIDARY_API DiscPoint disc_from_square(SamplePair square);

// `count` points spread evenly over the unit disc, the first one its centre: a sunflower's seeds.
LAPIDARY_API std::vector<DiscPoint> even_disc_points(int count);

}  // namespace lapidary
