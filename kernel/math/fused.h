// SPDX-License-Identifier: MIT
//
// Products that lose nothing. An instruction set without a fused multiply-add would have std::fma call the C library, which takes
// a hundred times as long as a product; here it takes the classical way instead. The bits are the same.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

namespace lapidary {

// For every instruction set.
//
// Veltkamp cuts a factor into halves of at most 26 bits, a = a1 + a2, whose products are exact; Dekker adds them up: a b = p + e.
// Neither works near the ends of the range of exponents, which are left to the C library.
namespace portable {

inline bool products_are_exact(double a, double b, double product) {
    const double size = std::fabs(product);
    return size > 0x1p-960 && size < 0x1p1000 && std::fabs(a) < 0x1p990 && std::fabs(b) < 0x1p990;
}

inline double upper_half(double a) {
    const double scaled = 0x1.000002p27 * a;
    return scaled - (scaled - a);
}

// e of the above.
inline double dekker_error(double a, double b, double product) {
    const double a1 = upper_half(a), a2 = a - a1;
    const double b1 = upper_half(b), b2 = b - b1;
    return a2 * b2 - (((product - a1 * b1) - a2 * b1) - a1 * b2);
}

inline double product_error(double a, double b, double product) {
    if (products_are_exact(a, b, product)) return dekker_error(a, b, product) + 0.0;  // never -0
    return a == 0 || b == 0 ? product - product : std::fma(a, b, -product);
}

// a + b, of the two numbers next to it the one whose last bit is set: what is added to it afterwards is rounded as if nothing had
// been rounded before.
inline double sum_rounded_to_odd(double a, double b) {
    const double sum = a + b, part = sum - a;
    const double error = (a - (sum - part)) + (b - part);
    const auto bits = std::bit_cast<std::int64_t>(sum);
    if (error == 0 || (bits & 1) != 0) return sum;
    return std::bit_cast<double>(bits + ((error > 0) == (sum > 0) ? 1 : -1));
}

// Boldo and Melquiond, Emulation of a FMA and correctly rounded sums: proved algorithms using rounding to odd (2008).
inline double fused_multiply_add(double a, double b, double c) {
    const double product = a * b;
    if (!products_are_exact(a, b, product) || !(std::fabs(c) < 0x1p1000))
        return a == 0 || b == 0 ? product + c : std::fma(a, b, c);
    const double error = dekker_error(a, b, product);
    const double low = c + error, low_part = low - c;
    const double low_error = (c - (low - low_part)) + (error - low_part);
    const double high = product + low, high_part = high - product;
    const double high_error = (product - (high - high_part)) + (low - high_part);
    return high + sum_rounded_to_odd(low_error, high_error);
}

}  // namespace portable

// a b - product exactly, where product is a b as rounded.
inline double product_error(double a, double b, double product) {
#if defined(__FMA__) || defined(FP_FAST_FMA)
    return std::fma(a, b, -product);
#else
    return portable::product_error(a, b, product);
#endif
}

// a b + c, rounded once.
inline double fused_multiply_add(double a, double b, double c) {
#if defined(__FMA__) || defined(FP_FAST_FMA)
    return std::fma(a, b, c);
#else
    return portable::fused_multiply_add(a, b, c);
#endif
}

}  // namespace lapidary
