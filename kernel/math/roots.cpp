// SPDX-License-Identifier: MIT
#include "kernel/math/roots.h"

#include <algorithm>
#include <array>
#include <limits>

namespace lapidary {

int double_cone_spans(const LocalLine& line, double slope, double apex, Span out[2]) {
    const DoubleConePieces pieces = double_cone_pieces(line, slope, slope * (apex - line.closest.y));
    int count = 0;
    for (const Span& piece : {pieces.first, pieces.second})
        if (!piece.is_empty()) out[count++] = piece;
    return count;
}

namespace {

// The line in a torus' space, scaled so that major + minor is near 1 and |d| is near 1.
//
// About m, the line's point closest to the centre, |p|^2 = a t^2 + m.m with a = d.d, and the quartic
// (|p|^2 + R^2 - r^2)^2 = 4 R^2 (x^2 + z^2) has no cubic term: divided by a^2,
//
//     f(t) = t^4 + P t^2 + Q t + S,
//     P = (2 beta - 4 R^2 (dx^2 + dz^2)/a) / a,   beta = m.m + (R - r)(R + r),
//     Q = 8 R^2 my dy / a^2         (as m.d = 0, mx dx + mz dz = -my dy)
//     S = g1 g2 / a^2,              g1, g2 = (rho -+ R)^2 + (my - r)(my + r),  rho = |(mx, mz)|.
//
// What decides is not f but the distance function, which sees a thin tube as sharply as a thick one:
//
//     g(t) = |(rho(t) - R, y(t))| - r,   rho(t) = |(x, z)|.
class TorusLine {
public:
    TorusLine(const LocalLine& line, double major, double minor) {
        const Vector& v = line.direction;
        const double shrink = normalizing_power_of_two(major + minor);
        const double slow = normalizing_power_of_two(larger_magnitude(v.x, larger_magnitude(v.y, v.z)));
        unit_ = slow * (1 / shrink);
        major_ = shrink * major;
        minor_ = shrink * minor;
        m_ = shrink * to_vector(line.closest);
        d_ = slow * v;
        set_quartic();
    }

    int spans(Span out[2]) const {
        const double offset = length(m_), outer = major_ + minor_;
        if (!(offset < outer)) return 0;
        // Just beyond the sphere around the torus, where g > 0 for certain.
        const double reach = 1.0001 * std::sqrt((outer - offset) * (outer + offset) / dot(d_, d_));

        // Between neighbouring separators f is monotone: g changes sign at most once.
        std::array<double, 5> separators{-reach};
        int count = 1;
        for (double t : turning_points())
            if (t > separators[count - 1] && t < reach) separators[count++] = t;
        separators[count++] = reach;

        int found = 0;
        bool inside = false;
        for (int i = 1; i < count; ++i) {
            const bool inside_next = i + 1 < count && distance(separators[i]) < 0;
            if (inside_next == inside) continue;
            const double t = crossing(separators[i - 1], separators[i], inside) * unit_;
            if (inside_next) {
                out[found].in = t;
            } else {
                out[found].out = t;
                if (!out[found].is_empty()) ++found;
            }
            inside = inside_next;
        }
        return found;
    }

private:
    struct Value {
        double value, slope;
    };

    void set_quartic() {
        const double a = dot(d_, d_);
        const double across = d_.x * d_.x + d_.z * d_.z, rho = std::sqrt(m_.x * m_.x + m_.z * m_.z);
        const double beta = dot(m_, m_) + (major_ - minor_) * (major_ + minor_);
        const double height = (m_.y - minor_) * (m_.y + minor_);
        const double near = rho - major_, far = rho + major_;
        p_ = (2 * beta - 4 * major_ * major_ * (across / a)) / a;
        q_ = 8 * major_ * major_ * m_.y * d_.y / (a * a);
        s_ = ((near * near + height) / a) * ((far * far + height) / a);
    }

    // The real roots of f'(t)/4 = t^3 + (P/2) t + Q/4, sorted. They need not be exact: only the sign of g at them matters.
    std::array<double, 3> turning_points() const {
        const double nowhere = std::numeric_limits<double>::quiet_NaN();
        const double third = p_ / 6, half = q_ / 8;  // t^3 + 3 third t + 2 half
        const double discriminant = half * half + third * third * third;
        if (!(discriminant < 0)) {
            const double w = std::cbrt(-half - std::copysign(std::sqrt(std::max(discriminant, 0.0)), half));
            const double t = w == 0 ? 0 : w - third / w;
            // On the verge of three roots the double one, -t/2, separates as well.
            if (discriminant > 1e-9 * half * half) return {t, nowhere, nowhere};
            return t < 0 ? std::array{t, -t / 2, nowhere} : std::array{-t / 2, t, nowhere};
        }
        const double radius = std::sqrt(-third);
        const double angle = std::acos(std::clamp(-half / (radius * radius * radius), -1.0, 1.0)) / 3;
        constexpr double two_thirds_pi = 2.0943951023931953;
        std::array<double, 3> t{2 * radius * std::cos(angle + two_thirds_pi), 2 * radius * std::cos(angle - two_thirds_pi),
                                2 * radius * std::cos(angle)};
        std::sort(t.begin(), t.end());
        return t;
    }

    Value quartic(double t) const {
        const double square = t * t;
        return {(square + p_) * square + (q_ * t + s_), (4 * square + 2 * p_) * t + q_};
    }

    Value distance_and_slope(double t) const {
        const double x = fused_multiply_add(t, d_.x, m_.x), y = fused_multiply_add(t, d_.y, m_.y),
                     z = fused_multiply_add(t, d_.z, m_.z);
        const double rho = std::sqrt(x * x + z * z), beyond = rho - major_;
        const double from_ring = std::sqrt(beyond * beyond + y * y);
        const double rho_slope = rho > 0 ? (x * d_.x + z * d_.z) / rho : 0;
        return {from_ring - minor_, from_ring > 0 ? (beyond * rho_slope + y * d_.y) / from_ring : 0};
    }
    double distance(double t) const { return distance_and_slope(t).value; }

    // Where g changes sign between low and high, inside at low or at high. Newton's method, kept in a bracket that every
    // step narrows: first on f, which is cheap and monotone here, then on g, which is exact.
    double crossing(double low, double high, bool inside_low) const {
        double t = refine(0.5 * (low + high), low, high, inside_low, 1e-5, 12, [this](double u) { return quartic(u); });
        // f may have drawn the bracket a hair beside the root of g.
        return polish(t, low, high, inside_low);
    }

    template <class F>
    static double refine(double t, double low, double high, bool inside_low, double tolerance, int steps, F f) {
        for (int i = 0; i < steps; ++i) {
            const Value v = f(t);
            ((v.value < 0) == inside_low ? low : high) = t;
            double next = t - v.value / v.slope;
            if (!(next > low && next < high)) next = 0.5 * (low + high);
            const double step = std::fabs(next - t);
            t = next;
            if (step <= tolerance * (high - low)) break;
        }
        return t;
    }

    double polish(double t, double low, double high, bool inside_low) const {
        constexpr double ulp = std::numeric_limits<double>::epsilon();
        for (int i = 0; i < 100; ++i) {
            const Value v = distance_and_slope(t);
            if (v.value == 0) return t;
            ((v.value < 0) == inside_low ? low : high) = t;
            double next = t - v.value / v.slope;
            if (!(next >= low && next <= high)) next = 0.5 * (low + high);
            const double step = std::fabs(next - t);
            t = next;
            if (step <= ulp || next == low || next == high) break;  // sizes and direction are near 1
        }
        return t;
    }

    double unit_, major_, minor_;
    Vector m_, d_;
    double p_ = 0, q_ = 0, s_ = 0;
};

}  // namespace

int torus_spans(const LocalLine& line, double major, double minor, Span out[2]) {
    return TorusLine(line, major, minor).spans(out);
}

}  // namespace lapidary
