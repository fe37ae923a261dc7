// SPDX-License-Identifier: MIT
//
// The numbers that a sample is made of: Owen-scrambled Sobol points, computed from nothing but the pixel's coordinates,
// the sample's number and the purpose, so that a picture does not depend on who computes which sample when.
//
// The first two Sobol dimensions of an index i, read as a vector of bits over GF(2), are
//
//     x0 = reverse(i)          x1 = reverse(P i),   P the upper triangular Pascal matrix modulo 2.
//
// P is the fivefold Kronecker power of (1 1; 0 1), so P i takes five shifts. An Owen scrambling flips every bit of x by a
// random function of the bits above it. On the reversed number that is a function of the bits below, which is what a
// chain of multiplications by even numbers plus one does (Laine and Karras 2011, with Vegdahl's constants). Thus
//
//     scrambled x0 = reverse(hash(i))     scrambled x1 = reverse(hash'(P i)).
//
// Each purpose (place in the pixel, place on the lens, place on a light …) takes a pair of dimensions of its own. All
// pairs use the same two Sobol dimensions, but each walks them in an order of its own: the index is shuffled by an Owen
// scrambling *of the index*, from its top bit down. That maps every aligned block of 2^k indices onto an aligned block of
// 2^k, so each pair keeps the stratification of every prefix, while the pairs are independent of one another (Burley
// 2020). Shuffling from the bottom bit up would tear the blocks apart, and not shuffling at all would tie the place in
// the pixel to the place on the lens: an error that more samples never remove.
#pragma once

#include <cstdint>
#include <vector>

#include "kernel/export.h"
#include "kernel/render/ray.h"

namespace lapidary {

// Two numbers in (0, 1), uniformly distributed together.
struct SamplePair {
    double u = 0.5, v = 0.5;
};

// What a pair of dimensions is for. Lights take first_light + n, n = 0, 1, 2 …
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
inline SampleKey sample_key(int x, int y, std::uint32_t sample, std::uint32_t sequence = 0) {
    const std::uint32_t pixel = sampling::hash(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y));
    return {sequence == 0 ? pixel : sampling::hash(pixel, sequence), sample};
}

inline SamplePair sample_pair(SampleKey key, std::uint32_t pair) {
    using namespace sampling;
    const std::uint32_t seed = hash(key.pixel, pair);
    const std::uint32_t index = reverse_bits(scramble_upward(reverse_bits(key.sample), seed));
    return {to_unit_interval(reverse_bits(scramble_upward(index, hash(seed, 1)))),
            to_unit_interval(reverse_bits(scramble_upward(pascal_product(index), hash(seed, 2))))};
}

// A place on the unit disc.
struct DiscPoint {
    double x = 0, y = 0;
};

// The square onto the disc, areas and neighbourhoods kept (Shirley and Chiu 1997): concentric squares become circles.
LAPIDARY_API DiscPoint disc_from_square(SamplePair square);

// `count` points spread evenly over the unit disc, the first one its centre: a sunflower's seeds.
LAPIDARY_API std::vector<DiscPoint> even_disc_points(int count);

}  // namespace lapidary
