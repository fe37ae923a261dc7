// SPDX-License-Identifier: MIT
//
// Turbulence: octaves of the absolute value of noise, each twice as fine and half as high as the one before,
//
//     T(p) = sum over i < n of |noise(2^i p)| / 2^i.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "kernel/interfaces/material.h"
#include "lapidary/noise.h"

namespace lapidary {

// A cap on how much of what finer octaves add is worth having; 2^64 is far beyond what coordinates can express.
inline constexpr int most_octaves = 64;

inline Point scaled(const Point& p, double s) { return {s * p.x, s * p.y, s * p.z}; }

// What the octaves from `count` on add on the mean. The heights of octaves count … n - 1 add up to 2 (2^-count - 2^-n).
inline double mean_of_faded_octaves(int n, int count) {
    count_faded_octaves(n - count);
    return mean_absolute_noise * 2 * (std::ldexp(1, -count) - std::ldexp(1, -n));
}

// The sum of the first `count` of n octaves, the rest replaced by their mean.
inline double turbulence(const Point& p, int n, int count) {
    double sum = 0, scale = 1;
    for (int i = 0; i < count; ++i, scale *= 2) sum += std::fabs(noise(scaled(p, scale))) / scale;
    return count < n ? sum + mean_of_faded_octaves(n, count) : sum;
}

inline double turbulence(const Point& p, int n) { return turbulence(p, n, n); }

namespace turbulence_detail {

using Triple = std::array<double, 3>;

// Octaves of three places in vector instructions, some at once.
inline constexpr int octaves_at_once = 4, lanes = 3 * octaves_at_once;
static_assert(lanes <= batch_size && lanes % 4 == 0);
inline constexpr double frequencies[octaves_at_once] = {1, 2, 4, 8};

// Adds the first `count` of these octaves, the first of which has the frequency `scale`.
inline void add_octaves(const std::array<Point, 3>& places, double scale, int count, Triple& sums) {
    PointBatch points;
    for (int lane = 0; lane < lanes; ++lane) {
        points.set(lane, scaled(places[lane / octaves_at_once], scale * frequencies[lane % octaves_at_once]));
    }
    double heights[lanes];
    noise_batch(points, lanes, heights);
    for (int lane = 0; lane < lanes; ++lane)
        heights[lane] = std::fabs(heights[lane]) / (scale * frequencies[lane % octaves_at_once]);
    for (int i = 0; i < count; ++i)
        for (std::size_t place = 0; place < places.size(); ++place) sums[place] += heights[place * octaves_at_once + i];
}

}  // namespace turbulence_detail

// The same at three places.
inline Vector turbulence(const std::array<Point, 3>& places, int n, int count) {
    using namespace turbulence_detail;
    constexpr int worth_lanes = 3;  // so many octaves
    Triple sums{};
    double scale = 1;
    int done = 0;
    for (; count - done >= worth_lanes; done += octaves_at_once, scale *= 1 << octaves_at_once)
        add_octaves(places, scale, std::min(octaves_at_once, count - done), sums);
    for (; done < count; ++done, scale *= 2)
        for (std::size_t i = 0; i < places.size(); ++i) sums[i] += std::fabs(noise(scaled(places[i], scale))) / scale;
    for (std::size_t i = 0; count < n && i < places.size(); ++i) sums[i] += mean_of_faded_octaves(n, count);
    return {sums[0], sums[1], sums[2]};
}

// So many of n octaves that the rest moves what T says, times `amount`, by less than a sixteenth of a pixel. The octaves from i
// on, each between 0 and noise_bound of its height, stray from their mean by less than 2 noise_bound / 2^i together.
inline int visible_octaves(int n, double amount, double footprint) {
    const double unseen = footprint / 16;
    double stray = std::fabs(amount) * 2 * noise_bound;
    int count = 0;
    for (; count < n && stray >= unseen; ++count) stray /= 2;
    return count;
}

// The same for a batch of places.
struct alignas(64) VisibleOctaves {
    // Of n octaves; what is told of all together is told of the lanes that are asked for.
    VisibleOctaves(int n, double amount, const double* __restrict footprints, unsigned lanes) : of(n) {
        for (double& seen : count) seen = 0;
        double stray = std::fabs(amount) * 2 * noise_bound;
        for (int i = 0; i < n; ++i, stray /= 2)
            for (int lane = 0; lane < batch_size; ++lane) count[lane] += stray >= footprints[lane] / 16 ? 1 : 0;
        for_each_lane(lanes, [&](int lane) {
            const int seen = static_cast<int>(count[lane]);
            most = std::max(most, seen), faded += n - seen;
        });
    }
    double count[batch_size];
    int of, most = 0, faded = 0;
};

namespace turbulence_detail {

[[gnu::noinline]] inline void scale_points(const PointBatch& __restrict points, double scale, PointBatch& __restrict scaled) {
    for (int lane = 0; lane < batch_size; ++lane) {
        scaled.x[lane] = scale * points.x[lane];
        scaled.y[lane] = scale * points.y[lane];
        scaled.z[lane] = scale * points.z[lane];
    }
}

// Adds an octave's noise where the octave is seen; of lanes that see no more, `rest` stays the height of the first unseen one.
[[gnu::noinline]] inline void add_octave(const double* __restrict noise, const double* __restrict seen, double octave,
                                         double height, double* __restrict sums, double* __restrict rest) {
    for (int lane = 0; lane < batch_size; ++lane) {
        const double is_seen = octave < seen[lane] ? 1 : 0;
        sums[lane] += is_seen * height * std::fabs(noise[lane]);
        rest[lane] -= is_seen * height / 2;
    }
}

}  // namespace turbulence_detail

// T at a batch of points: the octaves that are visible at each, the rest replaced by their mean.
inline void turbulence_batch(const PointBatch& points, const VisibleOctaves& visible, double* __restrict sums) {
    using namespace turbulence_detail;
    double rest[batch_size];  // the height of the first octave that is not seen
    for (int lane = 0; lane < batch_size; ++lane) sums[lane] = 0, rest[lane] = 1;
    const bool moderate = noise_detail::are_moderate(points, batch_size, std::ldexp(1, visible.most));
    double scale = 1, height = 1;
    for (int i = 0; i < visible.most; ++i, scale *= 2, height /= 2) {
        PointBatch finer;
        scale_points(points, scale, finer);
        double values[batch_size];
        if (moderate)
            noise_detail::noise_of_moderate(finer, batch_size, values);
        else
            noise_batch(finer, batch_size, values);
        add_octave(values, visible.count, i, height, sums, rest);
    }
    count_faded_octaves(visible.faded);
    const double end = std::ldexp(1, -visible.of);
    for (int lane = 0; lane < batch_size; ++lane) sums[lane] += mean_absolute_noise * 2 * (rest[lane] - end);
}

// T with its gradient (of one side, where an octave passes 0).
inline NoiseSample turbulence_with_gradient(const Point& p, int n) {
    NoiseSample sum;
    double scale = 1;
    for (int i = 0; i < n; ++i, scale *= 2) {
        const NoiseSample octave = noise_with_gradient(scaled(p, scale));
        sum.value += std::fabs(octave.value) / scale;
        sum.gradient = sum.gradient + std::copysign(1, octave.value) * octave.gradient;
    }
    return sum;
}

// T along the line p + s u, expanded at s = 0: T = value + slope s, to within stray(s).
//
// An octave of frequency f is |x|/f with x = noise(f p); along the line x has the slope f g, g the slope of noise there, and a
// second derivative of at most f^2 K. Without the absolute value, x/f would stray from its tangent by f K s^2 / 2. Where x passes
// 0 within s, |x| turns round, and strays by as much again as x goes beyond, twice over. All in all, no octave gets ahead of its
// tangent faster than its own steepest slope and the tangent's.
class TurbulenceExpansion {
public:
    TurbulenceExpansion(const Point& p, const Vector& unit_direction, int octaves) : octaves_(octaves) {
        double frequency = 1;
        for (int i = 0; i < octaves; ++i, frequency *= 2) {
            const NoiseSample sample = noise_with_gradient(scaled(p, frequency));
            height_[i] = std::fabs(sample.value) / frequency;
            steepness_[i] = dot(sample.gradient, unit_direction);
            value_ += height_[i];
            slope_ += std::copysign(1, sample.value) * steepness_[i];
            steepness_[i] = std::fabs(steepness_[i]);
        }
    }

    double value() const { return value_; }
    double slope() const { return slope_; }

    double stray(double s) const {
        double sum = 0, bend = noise_curvature_bound * s * s / 2;
        for (int i = 0; i < octaves_; ++i, bend *= 2) {
            const double beyond = std::fmax(0, steepness_[i] * s + bend - height_[i]);
            sum += std::fmin(bend + 2 * beyond, (steepness_[i] + noise_slope_bound) * s);
        }
        return sum;
    }

private:
    int octaves_;
    double value_ = 0, slope_ = 0;
    double height_[most_octaves], steepness_[most_octaves];
};

}  // namespace lapidary
