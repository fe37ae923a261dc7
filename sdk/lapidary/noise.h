// SPDX-License-Identifier: MIT
//
// Perlin's improved noise (2002) with the published permutation, and its exact derivative.
//
// Space is cut into unit cells. Every lattice point c has a gradient g(c), one of the twelve directions to the middles of
// a cube's edges, picked by hashing c modulo 256. At a point at r inside its cell, noise is the average of the eight
// ramps g(c).(p - c), weighted along each axis by fade(r) = 6r^5 - 15r^4 + 10r^3, whose first and second derivatives vanish at
// 0 and 1: noise is twice continuously differentiable everywhere, and 0 on the lattice.
//
// The gradients stand in a table, which gives the same numbers as the published cascade of conditions, bit for bit, at a
// tenth of its time (a pair of unpredictable branches a corner costs more than the arithmetic).
//
// At many points at once the same numbers come from vector instructions, at half of the time again: what is looked up for a
// lattice point tells the gradient itself, in two bits a coordinate. Points of one cell, as neighbouring pixels often see, share
// its gradients, which takes a third of that.
//
// Any coordinate is right: p - floor(p) is exact, and so is floor(p) modulo 256. At a coordinate that is not finite, noise is 0.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "kernel/interfaces/object.h"
#include "kernel/math/vector.h"

namespace lapidary {

// Bounds over all of space, whatever gradients meet in a cell. Noise and its derivatives along a unit vector are sums over
// the eight corners of terms that are linear in the corner's gradient, so the largest possible value at a point is the
// sum of the largest over the twelve gradients, corner by corner; its maxima over the cell are 1.03636, 3.75 (at the
// middle, along an axis) and 14.4652. tests/stress/noise_bounds.cpp searches for larger ones.
inline constexpr double noise_bound = 1.037;            // |noise|
inline constexpr double noise_slope_bound = 3.751;      // |gradient of noise|
inline constexpr double noise_curvature_bound = 14.48;  // |second derivative of noise along any unit vector|

// The mean of |noise| over space: what an octave too fine to be seen contributes to a sum of them.
inline constexpr double mean_absolute_noise = 0.2204;

struct NoiseSample {
    double value = 0;
    Vector gradient;
};

namespace noise_detail {

// clang-format off
inline constexpr std::uint8_t published_permutation[256] = {
    151, 160, 137,  91,  90,  15, 131,  13, 201,  95,  96,  53, 194, 233,   7, 225,
    140,  36, 103,  30,  69, 142,   8,  99,  37, 240,  21,  10,  23, 190,   6, 148,
    247, 120, 234,  75,   0,  26, 197,  62,  94, 252, 219, 203, 117,  35,  11,  32,
     57, 177,  33,  88, 237, 149,  56,  87, 174,  20, 125, 136, 171, 168,  68, 175,
     74, 165,  71, 134, 139,  48,  27, 166,  77, 146, 158, 231,  83, 111, 229, 122,
     60, 211, 133, 230, 220, 105,  92,  41,  55,  46, 245,  40, 244, 102, 143,  54,
     65,  25,  63, 161,   1, 216,  80,  73, 209,  76, 132, 187, 208,  89,  18, 169,
    200, 196, 135, 130, 116, 188, 159,  86, 164, 100, 109, 198, 173, 186,   3,  64,
     52, 217, 226, 250, 124, 123,   5, 202,  38, 147, 118, 126, 255,  82,  85, 212,
    207, 206,  59, 227,  47,  16,  58,  17, 182, 189,  28,  42, 223, 183, 170, 213,
    119, 248, 152,   2,  44, 154, 163,  70, 221, 153, 101, 155, 167,  43, 172,   9,
    129,  22,  39, 253,  19,  98, 108, 110,  79, 113, 224, 232, 178, 185, 112, 104,
    218, 246,  97, 228, 251,  34, 242, 193, 238, 210, 144,  12, 191, 179, 162, 241,
     81,  51, 145, 235, 249,  14, 239, 107,  49, 192, 214,  31, 181, 199, 106, 157,
    184,  84, 204, 176, 115, 121,  50,  45, 127,   4, 150, 254, 138, 236, 205,  93,
    222, 114,  67,  29,  24,  72, 243, 141, 128, 195,  78,  66, 215,  61, 156, 180,
};

// The twelve edge directions; four of them stand twice, so that four bits of the hash choose.
struct alignas(32) LatticeGradient { double x, y, z; };
inline constexpr LatticeGradient lattice_gradients[16] = {
    {1,  1, 0}, {-1,  1, 0}, {1, -1,  0}, {-1, -1,  0},
    {1,  0, 1}, {-1,  0, 1}, {1,  0, -1}, {-1,  0, -1},
    {0,  1, 1}, { 0, -1, 1}, {0,  1, -1}, { 0, -1, -1},
    {1,  1, 0}, { 0, -1, 1}, {-1, 1,  0}, { 0, -1, -1},
};
// clang-format on

// Twice in a row, so that the sum of an entry and a coordinate needs no reduction.
inline constexpr auto permutation = [] {
    std::array<std::uint8_t, 512> twice{};
    for (int i = 0; i < 512; ++i) twice[i] = published_permutation[i % 256];
    return twice;
}();

// A coordinate as the index of its cell modulo 256 and the place within, 0 to 1 (1 itself just below an integer next to 0,
// where the difference rounds up: the same value, by continuity).
struct LatticeCoordinate {
    explicit LatticeCoordinate(double x) {
        if (std::fabs(x) < 0x1p31) [[likely]] {
            int cell = static_cast<int>(x);
            cell -= x < cell;
            index = cell & 255;
            fraction = x - cell;
        } else {
            // From 2^62 on every double is a multiple of 256.
            const double cell = std::floor(x);
            index = std::fabs(cell) < 0x1p62 ? static_cast<int>(static_cast<std::int64_t>(cell) & 255) : 0;
            fraction = x - cell;
        }
    }
    int index;
    double fraction;
};

// A difference of a finite number with itself is 0, any other is not a number.
inline bool is_finite(const Point& p) { return (p.x - p.x) + (p.y - p.y) + (p.z - p.z) == 0; }

inline double fade(double r) { return r * r * r * (r * (r * 6 - 15) + 10); }
inline double fade_slope(double r) { return 30 * r * r * (r * (r - 2) + 1); }
inline double lerp(double t, double a, double b) { return a + t * (b - a); }

// The gradients at the eight corners of a cell: corner i lies at (i & 1, i >> 1 & 1, i >> 2).
struct CellGradients {
    CellGradients(int x, int y, int z) {
        const auto& p = permutation;
        const int a = p[x] + y, b = p[x + 1] + y;
        const int aa = p[a] + z, ba = p[b] + z, ab = p[a + 1] + z, bb = p[b + 1] + z;
        const int hashes[8] = {p[aa], p[ba], p[ab], p[bb], p[aa + 1], p[ba + 1], p[ab + 1], p[bb + 1]};
        for (int i = 0; i < 8; ++i) at[i] = &lattice_gradients[hashes[i] & 15];
    }
    double ramp(int i, double x, double y, double z) const {
        return at[i]->x * (x - (i & 1)) + at[i]->y * (y - (i >> 1 & 1)) + at[i]->z * (z - (i >> 2));
    }
    const LatticeGradient* at[8];
};

}  // namespace noise_detail

inline double noise(const Point& p) {
    using namespace noise_detail;
    if (!is_finite(p)) return 0;
    const LatticeCoordinate x(p.x), y(p.y), z(p.z);
    const CellGradients gradients(x.index, y.index, z.index);
    double ramp[8];
    for (int i = 0; i < 8; ++i) ramp[i] = gradients.ramp(i, x.fraction, y.fraction, z.fraction);

    const double u = fade(x.fraction), v = fade(y.fraction), w = fade(z.fraction);
    const double near = lerp(v, lerp(u, ramp[0], ramp[1]), lerp(u, ramp[2], ramp[3]));
    const double far = lerp(v, lerp(u, ramp[4], ramp[5]), lerp(u, ramp[6], ramp[7]));
    return lerp(w, near, far);
}

namespace noise_detail {

// What stands at i and i + 1 of the permutation: in the lower and the upper half.
inline constexpr int half = 16;
inline constexpr auto neighbours = [] {
    std::array<std::int32_t, 511> pairs{};
    for (std::size_t i = 0; i < pairs.size(); ++i) pairs[i] = permutation[i] | permutation[i + 1] << half;
    return pairs;
}();

// The gradients that these two choose, each of their coordinates, -1, 0 or 1, in two bits.
inline constexpr auto neighbouring_gradients = [] {
    const auto bits = [](double coordinate) { return static_cast<std::int32_t>(coordinate) & 3; };
    const auto gradient = [bits](int hash) {
        const LatticeGradient& g = lattice_gradients[hash & 15];
        return bits(g.x) | bits(g.y) << 2 | bits(g.z) << 4;
    };
    std::array<std::int32_t, 511> pairs{};
    for (std::size_t i = 0; i < pairs.size(); ++i) pairs[i] = gradient(permutation[i]) | gradient(permutation[i + 1]) << half;
    return pairs;
}();

// The coordinate of a gradient that begins at this bit.
inline double coordinate_at(std::int32_t gradient, int bit) {
    return static_cast<std::int32_t>(static_cast<std::uint32_t>(gradient) << (30 - bit)) >> 30;
}
inline double ramp_of(std::int32_t gradient, double x, double y, double z) {
    return coordinate_at(gradient, 0) * x + coordinate_at(gradient, 2) * y + coordinate_at(gradient, 4) * z;
}

struct alignas(64) CellBatch {
    std::int32_t x[batch_size], y[batch_size], z[batch_size];
};

// The gradients at the corners (0, 0), (1, 0), (0, 1) and (1, 1) in x and y: those near in z in the lower halves, the far ones in
// the upper ones.
struct alignas(64) CornerBatch {
    std::int32_t at[4][batch_size];
};

// Coordinates for which LatticeCoordinate takes its short way, even `scale` times as large.
[[gnu::noinline]] inline bool are_moderate(const PointBatch& __restrict points, int count, double scale = 1) {
    const auto is_moderate = [scale](double x) { return std::int64_t{scale * std::fabs(x) < 0x1p31 ? 1 : 0}; };
    std::int64_t moderate = 1;
    for (int i = 0; i < count; ++i) moderate &= is_moderate(points.x[i]) & is_moderate(points.y[i]) & is_moderate(points.z[i]);
    return moderate != 0;
}

inline double cell_of(double x) {
    const double whole = static_cast<std::int32_t>(x), beyond = whole > x ? 1 : 0;
    return whole - beyond;
}

// Returns whether all points are in one cell.
[[gnu::noinline]] inline bool find_cells(const PointBatch& __restrict points, int count, CellBatch& __restrict cells,
                                         PointBatch& __restrict fractions) {
    const double first_x = cell_of(points.x[0]), first_y = cell_of(points.y[0]), first_z = cell_of(points.z[0]);
    const auto differs = [](double a, double b) { return std::int64_t{a != b ? 1 : 0}; };
    std::int64_t elsewhere = 0;
    for (int i = 0; i < count; ++i) {
        const double x = cell_of(points.x[i]), y = cell_of(points.y[i]), z = cell_of(points.z[i]);
        cells.x[i] = static_cast<std::int32_t>(x) & 255, fractions.x[i] = points.x[i] - x;
        cells.y[i] = static_cast<std::int32_t>(y) & 255, fractions.y[i] = points.y[i] - y;
        cells.z[i] = static_cast<std::int32_t>(z) & 255, fractions.z[i] = points.z[i] - z;
        elsewhere |= differs(x, first_x) | differs(y, first_y) | differs(z, first_z);
    }
    return elsewhere == 0;
}

[[gnu::noinline]] inline void find_corners(const CellBatch& __restrict cells, int count, CornerBatch& __restrict corners) {
    constexpr std::int32_t lower = (1 << half) - 1;
    for (int i = 0; i < count; ++i) {
        const std::int32_t y = cells.y[i], z = cells.z[i], along_x = neighbours[cells.x[i]];
        const std::int32_t left = neighbours[(along_x & lower) + y], right = neighbours[(along_x >> half) + y];
        corners.at[0][i] = neighbouring_gradients[(left & lower) + z];
        corners.at[1][i] = neighbouring_gradients[(right & lower) + z];
        corners.at[2][i] = neighbouring_gradients[(left >> half) + z];
        corners.at[3][i] = neighbouring_gradients[(right >> half) + z];
    }
}

[[gnu::noinline]] inline void blend_ramps(const CornerBatch& __restrict corners, const PointBatch& __restrict fractions,
                                          int count, double* __restrict values) {
    for (int i = 0; i < count; ++i) {
        const double x = fractions.x[i], y = fractions.y[i], z = fractions.z[i];
        const double u = fade(x), v = fade(y), w = fade(z);
        const std::int32_t a = corners.at[0][i], b = corners.at[1][i], c = corners.at[2][i], d = corners.at[3][i];
        const double near = lerp(v, lerp(u, ramp_of(a, x, y, z), ramp_of(b, x - 1, y, z)),
                                 lerp(u, ramp_of(c, x, y - 1, z), ramp_of(d, x - 1, y - 1, z)));
        const double far = lerp(v, lerp(u, ramp_of(a >> half, x, y, z - 1), ramp_of(b >> half, x - 1, y, z - 1)),
                                lerp(u, ramp_of(c >> half, x, y - 1, z - 1), ramp_of(d >> half, x - 1, y - 1, z - 1)));
        values[i] = lerp(w, near, far);
    }
}

[[gnu::noinline]] inline void blend_ramps_of_cell(const CellGradients& __restrict cell, const PointBatch& __restrict fractions,
                                                  double* __restrict values) {
    const auto ramp = [&cell](int i, double x, double y, double z) {
        return cell.at[i]->x * x + cell.at[i]->y * y + cell.at[i]->z * z;
    };
    for (int i = 0; i < batch_size; ++i) {
        const double x = fractions.x[i], y = fractions.y[i], z = fractions.z[i];
        const double u = fade(x), v = fade(y), w = fade(z);
        const double near =
            lerp(v, lerp(u, ramp(0, x, y, z), ramp(1, x - 1, y, z)), lerp(u, ramp(2, x, y - 1, z), ramp(3, x - 1, y - 1, z)));
        const double far = lerp(v, lerp(u, ramp(4, x, y, z - 1), ramp(5, x - 1, y, z - 1)),
                                lerp(u, ramp(6, x, y - 1, z - 1), ramp(7, x - 1, y - 1, z - 1)));
        values[i] = lerp(w, near, far);
    }
}

}  // namespace noise_detail

// From so many points on, noise of a whole batch costs less than that of one after the other.
inline constexpr int points_worth_batch = 8;

namespace noise_detail {

inline void noise_of_moderate(const PointBatch& points, int count, double* values) {
    CellBatch cells;
    PointBatch fractions;
    const bool in_one_cell = find_cells(points, count, cells, fractions);
    if (in_one_cell && count == batch_size) {
        blend_ramps_of_cell(CellGradients(cells.x[0], cells.y[0], cells.z[0]), fractions, values);
        return;
    }
    CornerBatch corners;
    find_corners(cells, count, corners);
    blend_ramps(corners, fractions, count, values);
}

}  // namespace noise_detail

// noise() of many points, whose number is a multiple of four.
inline void noise_batch(const PointBatch& points, int count, double* values) {
    if (noise_detail::are_moderate(points, count))
        noise_detail::noise_of_moderate(points, count, values);
    else
        for (int i = 0; i < count; ++i) values[i] = noise(points.point(i));
}

// Noise and its derivative (Dnoise). With F = sum of w_c ramp_c, the derivative has two parts: the weighted average of
// the gradients, from the ramps, and along each axis the slope of the fade times the difference of the two faces across it, from
// the weights.
inline NoiseSample noise_with_gradient(const Point& p) {
    using namespace noise_detail;
    if (!is_finite(p)) return {};
    const LatticeCoordinate x(p.x), y(p.y), z(p.z);
    const CellGradients gradients(x.index, y.index, z.index);
    double ramp[8];
    for (int i = 0; i < 8; ++i) ramp[i] = gradients.ramp(i, x.fraction, y.fraction, z.fraction);

    const double u = fade(x.fraction), v = fade(y.fraction), w = fade(z.fraction);
    const auto average = [&](auto&& value) {
        return lerp(w, lerp(v, lerp(u, value(0), value(1)), lerp(u, value(2), value(3))),
                    lerp(v, lerp(u, value(4), value(5)), lerp(u, value(6), value(7))));
    };
    const auto across = [&](int step, int a, int b, int c, int d, double s, double t) {
        const auto difference = [&](int i) { return ramp[i + step] - ramp[i]; };
        return lerp(t, lerp(s, difference(a), difference(b)), lerp(s, difference(c), difference(d)));
    };
    return {average([&](int i) { return ramp[i]; }),
            {average([&](int i) { return gradients.at[i]->x; }) + fade_slope(x.fraction) * across(1, 0, 2, 4, 6, v, w),
             average([&](int i) { return gradients.at[i]->y; }) + fade_slope(y.fraction) * across(2, 0, 1, 4, 5, u, w),
             average([&](int i) { return gradients.at[i]->z; }) + fade_slope(z.fraction) * across(4, 0, 1, 2, 3, u, v)}};
}

}  // namespace lapidary
