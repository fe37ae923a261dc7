// SPDX-License-Identifier: MIT
//
// A colour is three linear intensities of the Rec. 709 primaries, nominally 0 to 1; light may exceed 1.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

namespace lapidary {

struct Colour {
    double r = 0, g = 0, b = 0;

    static constexpr Colour grey(double v) { return {v, v, v}; }
    static constexpr Colour white() { return {1, 1, 1}; }
    static constexpr Colour black() { return {0, 0, 0}; }

    Colour& operator+=(const Colour& o) {
        r += o.r, g += o.g, b += o.b;
        return *this;
    }
};

inline Colour operator+(const Colour& a, const Colour& b) { return {a.r + b.r, a.g + b.g, a.b + b.b}; }
inline Colour operator-(const Colour& a, const Colour& b) { return {a.r - b.r, a.g - b.g, a.b - b.b}; }
inline Colour operator*(const Colour& a, const Colour& b) { return {a.r * b.r, a.g * b.g, a.b * b.b}; }
inline Colour operator*(double s, const Colour& c) { return {s * c.r, s * c.g, s * c.b}; }
inline Colour operator*(const Colour& c, double s) { return s * c; }
inline bool operator==(const Colour& a, const Colour& b) { return a.r == b.r && a.g == b.g && a.b == b.b; }

inline Colour mix(const Colour& a, const Colour& b, double t) { return (1 - t) * a + t * b; }
inline double largest(const Colour& c) { return std::max(c.r, std::max(c.g, c.b)); }
inline bool is_black(const Colour& c) { return c.r == 0 && c.g == 0 && c.b == 0; }
inline bool is_finite(const Colour& c) { return std::isfinite(c.r) && std::isfinite(c.g) && std::isfinite(c.b); }

// What lies beyond the range of floats becomes the last of them.
inline float to_float(double value) {
    constexpr double largest_float = std::numeric_limits<float>::max();
    const double from_below = value < largest_float ? value : largest_float;
    return static_cast<float>(from_below > -largest_float ? from_below : -largest_float);
}

// The sRGB transfer curve (IEC 61966-2-1), between a linear value and its encoding, both 0 to 1.
inline double srgb_encode(double linear) {
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}
inline double srgb_decode(double encoded) {
    return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

}  // namespace lapidary
