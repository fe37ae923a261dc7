// SPDX-License-Identifier: MIT
#include "kernel/math/transform.h"

#include <cmath>
#include <utility>

namespace lapidary {

namespace {

TwoPartMatrix3 two_part_identity() {
    TwoPartMatrix3 m;
    for (int i = 0; i < 3; ++i) m[i][i] = 1.0;
    return m;
}

const TwoPartMatrix3 exact_identity = two_part_identity();

TwoPartMatrix3 multiply(const TwoPartMatrix3& a, const TwoPartMatrix3& b) {
    TwoPartMatrix3 m;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) m[i][j] = a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j];
    return m;
}

std::array<TwoPart, 3> multiply(const std::array<TwoPart, 3>& v, const TwoPartMatrix3& m) {
    return {v[0] * m[0][0] + v[1] * m[1][0] + v[2] * m[2][0], v[0] * m[0][1] + v[1] * m[1][1] + v[2] * m[2][1],
            v[0] * m[0][2] + v[1] * m[1][2] + v[2] * m[2][2]};
}

TwoPartMatrix3 transpose(const TwoPartMatrix3& m) {
    TwoPartMatrix3 t;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) t[i][j] = m[j][i];
    return t;
}

struct SineCosine {
    TwoPart sine, cosine;
};

// 1/(n (n-1)), the factor from one term of the Taylor series of sine or cosine to the next; a product with it is
// several times faster than the quotient.
constexpr int taylor_terms = 14;
std::array<TwoPart, 2 * taylor_terms + 2> taylor_factors() {
    std::array<TwoPart, 2 * taylor_terms + 2> factors;
    for (std::size_t n = 2; n < factors.size(); ++n) factors[n] = TwoPart(1.0) / TwoPart(static_cast<double>(n * (n - 1)));
    return factors;
}

// sin and cos of a double to about 100 bits. The quarter turns are subtracted with pi/2 in three parts, the rest
// goes through the Taylor series. An angle that is a multiple of pi/2 to its last bit is meant as that multiple,
// so that right angles map axes onto axes exactly.
SineCosine sine_cosine(double angle) {
    constexpr double half_pi_1 = 0x1.921fb54442d18p+0;
    constexpr double half_pi_2 = 0x1.1a62633145c07p-54;
    constexpr double half_pi_3 = -0x1.f1976b7ed8fbcp-110;
    const double turns = std::nearbyint(angle / half_pi_1);
    TwoPart x = TwoPart(angle) - two_product(turns, half_pi_1);
    x = x - two_product(turns, half_pi_2) - two_product(turns, half_pi_3);
    if (std::fabs(x.hi) <= 0x1p-53 * std::fabs(angle)) x = 0.0;

    const TwoPart square = x * x;
    TwoPart sine = x, cosine = 1.0, sine_term = x, cosine_term = 1.0;
    static const auto factors = taylor_factors();
    for (std::size_t k = 1; k <= taylor_terms; ++k) {
        cosine_term = -(cosine_term * square) * factors[2 * k];
        sine_term = -(sine_term * square) * factors[2 * k + 1];
        cosine = cosine + cosine_term;
        sine = sine + sine_term;
    }
    const int quadrant = static_cast<int>(std::fmod(std::fmod(turns, 4.0) + 4.0, 4.0));
    switch (quadrant) {
        case 1:
            return {cosine, -sine};
        case 2:
            return {-sine, -cosine};
        case 3:
            return {-cosine, sine};
        default:
            return {sine, cosine};
    }
}

TwoPart square_root(const TwoPart& a) {
    if (!(a.hi > 0)) return 0.0;
    const double root = std::sqrt(a.hi);
    return TwoPart(root) + (a - two_product(root, root)) / TwoPart(2 * root);
}

// Rotation by an angle that carries axis `from` toward axis `to`.
TwoPartMatrix3 axis_rotation(int from, int to, double angle) {
    const SineCosine sc = sine_cosine(angle);
    TwoPartMatrix3 m = exact_identity;
    m[from][from] = sc.cosine;
    m[from][to] = sc.sine;
    m[to][from] = -sc.sine;
    m[to][to] = sc.cosine;
    return m;
}

// Rodrigues' formula about a unit axis, in the sense of rotx, roty and rotz: for the axis (1,0,0), +y turns toward +z.
std::optional<TwoPartMatrix3> rotation(const Vector& axis, double angle) {
    const double largest = std::fmax(std::fabs(axis.x), std::fmax(std::fabs(axis.y), std::fabs(axis.z)));
    if (!(largest > 0) || !(largest < infinity)) return std::nullopt;
    int exponent = 0;
    (void)std::frexp(largest, &exponent);
    std::array<TwoPart, 3> a{std::ldexp(axis.x, -exponent), std::ldexp(axis.y, -exponent), std::ldexp(axis.z, -exponent)};
    const TwoPart norm = square_root(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
    for (TwoPart& component : a) component = component / norm;

    const SineCosine sc = sine_cosine(angle);
    const TwoPart versine = TwoPart(1.0) - sc.cosine;
    TwoPartMatrix3 m;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) m[i][j] = versine * a[i] * a[j];
    for (int i = 0; i < 3; ++i) m[i][i] = m[i][i] + sc.cosine;
    m[0][1] = m[0][1] + sc.sine * a[2];
    m[1][2] = m[1][2] + sc.sine * a[0];
    m[2][0] = m[2][0] + sc.sine * a[1];
    m[1][0] = m[1][0] - sc.sine * a[2];
    m[2][1] = m[2][1] - sc.sine * a[0];
    m[0][2] = m[0][2] - sc.sine * a[1];
    return m;
}

// The inverse by cofactors in two-part arithmetic, for matrices given number by number. Rows and columns are
// scaled by powers of two first, so that the determinant of a tiny matrix does not underflow.
std::optional<TwoPartMatrix3> inverse_of(const TwoPartMatrix3& original) {
    TwoPartMatrix3 m = original;
    std::array<int, 3> row_exponent{}, column_exponent{};
    const auto exponent_of = [](double a, double b, double c, int& exponent) {
        const double largest = std::fmax(std::fabs(a), std::fmax(std::fabs(b), std::fabs(c)));
        if (!(largest > 0) || !(largest < infinity)) return false;
        (void)std::frexp(largest, &exponent);
        return true;
    };
    const auto shift = [](TwoPart& value, int exponent) {
        value = {std::ldexp(value.hi, exponent), std::ldexp(value.lo, exponent)};
    };
    for (int i = 0; i < 3; ++i) {
        if (!exponent_of(m[i][0].hi, m[i][1].hi, m[i][2].hi, row_exponent[i])) return std::nullopt;
        for (int j = 0; j < 3; ++j) shift(m[i][j], -row_exponent[i]);
    }
    for (int j = 0; j < 3; ++j) {
        if (!exponent_of(m[0][j].hi, m[1][j].hi, m[2][j].hi, column_exponent[j])) return std::nullopt;
        for (int i = 0; i < 3; ++i) shift(m[i][j], -column_exponent[j]);
    }
    TwoPartMatrix3 cofactor;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            const int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
            cofactor[i][j] = m[i1][j1] * m[i2][j2] - m[i1][j2] * m[i2][j1];
        }
    const TwoPart determinant = m[0][0] * cofactor[0][0] + m[0][1] * cofactor[0][1] + m[0][2] * cofactor[0][2];
    // Entries are near 1 now: a determinant that is all rounding means rank 2 or less.
    if (!(std::fabs(determinant.hi) > 0x1p-100)) return std::nullopt;
    TwoPartMatrix3 inverse;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            inverse[j][i] = cofactor[i][j] / determinant;
            shift(inverse[j][i], -row_exponent[i] - column_exponent[j]);
        }
    return inverse;
}

bool is_finite(const TwoPartMatrix3& m) {
    for (const auto& row : m)
        for (const TwoPart& value : row)
            if (!std::isfinite(value.hi) || !std::isfinite(value.lo)) return false;
    return true;
}

bool is_finite(const LinearMap& map) { return is_finite(map.exact_linear) && is_finite(map.exact_inverse); }

Matrix3 round(const TwoPartMatrix3& m) {
    Matrix3 rounded;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) rounded[i][j] = static_cast<double>(m[i][j]);
    return rounded;
}

// The squared length of the images of the axes, if they are across one another and of one length; else 0.
double squared_scale_of(const Matrix3& rows) {
    const auto product = [&](int i, int j) {
        return rows[i][0] * rows[j][0] + rows[i][1] * rows[j][1] + rows[i][2] * rows[j][2];
    };
    const double squared = product(0, 0);
    double most = 0;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j <= i; ++j) most = std::fmax(most, std::fabs(product(i, j) - (i == j ? squared : 0)));
    return most <= 0x1p-40 * squared ? squared : 0;
}

LinearMapPtr make_map(const TwoPartMatrix3& linear, const TwoPartMatrix3& inverse) {
    LinearMap map{round(linear), round(inverse), linear, inverse};
    // At most 1 for rotations and equal scales of any size; about the root of the condition otherwise, or its square.
    const double there = largest_entry(map.linear), back = largest_entry(map.inverse);
    map.lopsided = there * back > 16;
    // A digit or two below the root of the largest double.
    constexpr double most = 0x1p500;
    map.extreme = there > most || back > most;
    map.squared_scale = map.extreme ? 0 : squared_scale_of(map.linear);
    return LinearMapPtr(map);
}

LinearMapPtr rotation_map(const TwoPartMatrix3& turned) { return make_map(turned, transpose(turned)); }

// Null where a scale is 0 or not finite; the identity is none of these.
LinearMapPtr scale_map(const std::array<double, 12>& v) {
    TwoPartMatrix3 linear = exact_identity, inverse = exact_identity;
    for (int i = 0; i < 3; ++i) {
        if (!(std::fabs(v[i]) > 0) || !std::isfinite(v[i])) return {};
        linear[i][i] = v[i];
        inverse[i][i] = TwoPart(1.0) / TwoPart(v[i]);
    }
    return make_map(linear, inverse);
}

// x gains xy y + xz z, y gains yx x + yz z, z gains zx x + zy y
TwoPartMatrix3 shear_matrix(const std::array<double, 12>& v) {
    TwoPartMatrix3 m = exact_identity;
    m[1][0] = v[0], m[2][0] = v[1];
    m[0][1] = v[2], m[2][1] = v[3];
    m[0][2] = v[4], m[1][2] = v[5];
    return m;
}

TwoPartMatrix3 written_matrix(const std::array<double, 12>& v) {
    TwoPartMatrix3 m;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) m[i][j] = v[3 * i + j];
    return m;
}

LinearMapPtr invertible_map(const TwoPartMatrix3& linear) {
    const auto inverse = inverse_of(linear);
    return inverse ? make_map(linear, *inverse) : LinearMapPtr();
}

// What a factor does apart from its translation, where that is not the identity; null where it is singular.
LinearMapPtr linear_part(const TransformFactor& factor) {
    const auto& v = factor.values;
    switch (factor.kind) {
        case TransformFactor::Kind::translate:
            return {};
        case TransformFactor::Kind::scale:
            return scale_map(v);
        case TransformFactor::Kind::rotx:
        case TransformFactor::Kind::roty:
        case TransformFactor::Kind::rotz: {
            if (!std::isfinite(v[0])) return {};
            const int axis = static_cast<int>(factor.kind) - static_cast<int>(TransformFactor::Kind::rotx);
            return rotation_map(axis_rotation((axis + 1) % 3, (axis + 2) % 3, v[0]));
        }
        case TransformFactor::Kind::rotate: {
            if (!std::isfinite(v[3])) return {};
            const auto turned = rotation({v[0], v[1], v[2]}, v[3]);
            return turned ? rotation_map(*turned) : LinearMapPtr();
        }
        case TransformFactor::Kind::shear:
            return invertible_map(shear_matrix(v));
        case TransformFactor::Kind::matrix:
            return invertible_map(written_matrix(v));
    }
    return {};
}

bool only_translates(const TransformFactor& factor) {
    const auto& v = factor.values;
    switch (factor.kind) {
        case TransformFactor::Kind::translate:
            return true;
        case TransformFactor::Kind::scale:
            return v[0] == 1 && v[1] == 1 && v[2] == 1;
        case TransformFactor::Kind::rotx:
        case TransformFactor::Kind::roty:
        case TransformFactor::Kind::rotz:
            return v[0] == 0;
        default:
            return false;
    }
}

std::array<TwoPart, 3> translation_of(const TransformFactor& factor) {
    const auto& v = factor.values;
    if (factor.kind == TransformFactor::Kind::translate) return {v[0], v[1], v[2]};
    if (factor.kind == TransformFactor::Kind::matrix) return {v[9], v[10], v[11]};
    return {};
}

}  // namespace

std::optional<ExactTransform> ExactTransform::of(const TransformFactor& factor) {
    ExactTransform t;
    t.translation_ = translation_of(factor);
    for (const TwoPart& value : t.translation_)
        if (!std::isfinite(value.hi)) return std::nullopt;
    if (!only_translates(factor)) {
        t.linear_ = linear_part(factor);
        if (!t.linear_ || !is_finite(*t.linear_)) return std::nullopt;
    }
    return factor.inverted ? t.inverse() : t;
}

std::optional<ExactTransform> ExactTransform::of(const std::vector<TransformFactor>& factors) {
    ExactTransform composed;
    for (const TransformFactor& factor : factors) {
        const auto next = of(factor);
        if (!next) return std::nullopt;
        composed = composed.then(*next);
    }
    if (composed.linear_ && !is_finite(*composed.linear_)) return std::nullopt;
    return composed;
}

ExactTransform ExactTransform::then(const ExactTransform& next) const {
    ExactTransform t;
    if (!next.linear_) {
        t.linear_ = linear_;
        t.translation_ = translation_;
    } else {
        t.linear_ = linear_ ? make_map(multiply(linear_->exact_linear, next.linear_->exact_linear),
                                       multiply(next.linear_->exact_inverse, linear_->exact_inverse))
                            : next.linear_;
        t.translation_ = multiply(translation_, next.linear_->exact_linear);
    }
    for (int i = 0; i < 3; ++i) t.translation_[i] = t.translation_[i] + next.translation_[i];
    return t;
}

ExactTransform ExactTransform::inverse() const {
    ExactTransform t;
    if (linear_) t.linear_ = make_map(linear_->exact_inverse, linear_->exact_linear);
    const auto back = multiply(translation_, inverse_linear());
    t.translation_ = {-back[0], -back[1], -back[2]};
    return t;
}

const TwoPartMatrix3& ExactTransform::linear() const { return linear_ ? linear_->exact_linear : exact_identity; }
const TwoPartMatrix3& ExactTransform::inverse_linear() const { return linear_ ? linear_->exact_inverse : exact_identity; }

Transform::Transform(const ExactTransform& exact) : linear_(exact.linear_map()) {
    const auto& c = exact.translation();
    centre_ = {{c[0].hi, c[1].hi, c[2].hi}, {c[0].lo, c[1].lo, c[2].lo}};
}

Point Transform::to_parent(const Point& p) const { return centre_.anchor + (to_parent(to_vector(p)) + centre_.offset); }
Point Transform::to_local(const Point& p) const { return to_local(TwoPartPoint(p)); }

Point Transform::to_local(const TwoPartPoint& p) const {
    const TwoPartVector from_centre = p - centre_;
    return to_point(to_local(from_centre.hi) + to_local(from_centre.lo));
}

std::array<TwoPart, 3> Transform::to_local_two_part(const TwoPartPoint& p) const {
    const auto from_centre = [](double anchor, double offset, double centre, double centre_offset) {
        return two_difference(anchor, centre) + two_difference(offset, centre_offset);
    };
    return to_local_two_part({from_centre(p.anchor.x, p.offset.x, centre_.anchor.x, centre_.offset.x),
                              from_centre(p.anchor.y, p.offset.y, centre_.anchor.y, centre_.offset.y),
                              from_centre(p.anchor.z, p.offset.z, centre_.anchor.z, centre_.offset.z)});
}

std::array<TwoPart, 3> Transform::to_local_two_part(const Vector& v) const {
    return to_local_two_part(std::array<TwoPart, 3>{v.x, v.y, v.z});
}

std::array<TwoPart, 3> Transform::to_local_two_part(const std::array<TwoPart, 3>& v) const {
    return linear_ ? multiply(v, linear_->exact_inverse) : v;
}

TwoPartPoint Transform::to_parent_two_part(const Point& p) const {
    return {centre_.anchor, to_parent(to_vector(p)) + centre_.offset};
}

Bounds Transform::to_parent(const Bounds& b) const {
    if (b.is_empty()) return b;
    // Each coordinate of the image is a sum of one term per axis: its range is the sum of the terms' ranges.
    const Matrix3& m = linear();
    const std::array<double, 3> low{b.low.x, b.low.y, b.low.z}, high{b.high.x, b.high.y, b.high.z};
    std::array<double, 3> out_low{}, out_high{};
    const std::array<double, 3> centre{centre_.anchor.x, centre_.anchor.y, centre_.anchor.z};
    for (int j = 0; j < 3; ++j) {
        out_low[j] = out_high[j] = centre[j];
        for (int i = 0; i < 3; ++i) {
            if (m[i][j] == 0) continue;  // keeps 0 * infinity out
            out_low[j] += m[i][j] * (m[i][j] > 0 ? low[i] : high[i]);
            out_high[j] += m[i][j] * (m[i][j] > 0 ? high[i] : low[i]);
        }
    }
    return {{out_low[0], out_low[1], out_low[2]}, {out_high[0], out_high[1], out_high[2]}};
}

namespace {

// Of a matrix times 2^-exponent, which is near 1: that of the matrix itself would overflow for lengths of 1e103 already.
double determinant_near_one(const Matrix3& m, int exponent) {
    const auto row = [&](int i) -> Vector {
        return {std::ldexp(m[i][0], -exponent), std::ldexp(m[i][1], -exponent), std::ldexp(m[i][2], -exponent)};
    };
    return dot(cross(row(0), row(1)), row(2));
}

int exponent_of(const Matrix3& m) {
    int exponent = 0;
    std::frexp(largest_entry(m), &exponent);
    return exponent;
}

}  // namespace

double mean_stretch(const Matrix3& m) {
    const int exponent = exponent_of(m);
    return std::ldexp(std::cbrt(std::fabs(determinant_near_one(m, exponent))), exponent);
}

bool Transform::mirrors() const { return determinant_near_one(linear(), exponent_of(linear())) < 0; }

}  // namespace lapidary
