// SPDX-License-Identifier: MIT
//
// Affine maps in the row-vector convention of the scene language: p' = p M + c, so that factors apply
// in the order written.
//
// Every factor knows its inverse in closed form, and chains are composed in two-part arithmetic and
// rounded once, at the end (an inverse by elimination loses ten digits where this loses none).
#pragma once

#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "kernel/export.h"
#include "kernel/math/bounds.h"
#include "kernel/math/two_part.h"
#include "kernel/math/vector.h"

namespace lapidary {

// One operation of a `transform` block, as written: kept so that a scene can be printed again.
struct TransformFactor {
    enum class Kind { translate, scale, rotx, roty, rotz, rotate, shear, matrix };
    Kind kind = Kind::translate;
    std::array<double, 12> values{};  // in the order of the language; angles in radians
    bool inverted = false;            // stands inside an odd number of `inverse { }`
};

using Matrix3 = std::array<std::array<double, 3>, 3>;
// v M for the row vector v.
inline Vector multiply(const Vector& v, const Matrix3& m) {
    return {v.x * m[0][0] + v.y * m[1][0] + v.z * m[2][0], v.x * m[0][1] + v.y * m[1][1] + v.z * m[2][1],
            v.x * m[0][2] + v.y * m[1][2] + v.z * m[2][2]};
}

inline double largest_entry(const Matrix3& m) {
    double largest = 0;
    for (const auto& row : m)
        for (double entry : row) largest = std::fmax(largest, std::fabs(entry));
    return largest;
}

// How much a map stretches lengths on the mean of all directions: the cube root of its determinant, for maps of any size.
LAPIDARY_API double mean_stretch(const Matrix3& m);

// v M^T for the row vector v.
inline Vector multiply_transposed(const Vector& v, const Matrix3& m) {
    return {v.x * m[0][0] + v.y * m[0][1] + v.z * m[0][2], v.x * m[1][0] + v.y * m[1][1] + v.z * m[1][2],
            v.x * m[2][0] + v.y * m[2][1] + v.z * m[2][2]};
}

using TwoPartMatrix3 = std::array<std::array<TwoPart, 3>, 3>;

inline constexpr Matrix3 identity_matrix{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};

// A linear map with its inverse, rounded and in two parts. One is shared by all maps that differ from one another by
// a translation only; none stands for the identity.
struct LinearMap {
    Matrix3 linear, inverse;
    TwoPartMatrix3 exact_linear, exact_inverse;
    bool lopsided = false;     // some directions are stretched much more than others
    bool extreme = false;      // squares of lengths, there or back, are beyond a double
    double squared_scale = 0;  // of one that keeps shapes, by how much it scales areas; 0: of others
};

// Shares a map: std::shared_ptr in half the room, as every leaf of a World has one.
class LinearMapPtr {
public:
    LinearMapPtr() = default;  // the identity
    explicit LinearMapPtr(const LinearMap& map) : shared_(new Shared{map, 1}) {}
    LinearMapPtr(const LinearMapPtr& other) : shared_(other.shared_) {
        if (shared_) shared_->owners.fetch_add(1, std::memory_order_relaxed);
    }
    LinearMapPtr(LinearMapPtr&& other) noexcept : shared_(std::exchange(other.shared_, nullptr)) {}
    LinearMapPtr& operator=(LinearMapPtr other) noexcept {
        std::swap(shared_, other.shared_);
        return *this;
    }
    ~LinearMapPtr() {
        if (shared_ && shared_->owners.fetch_sub(1, std::memory_order_acq_rel) == 1) delete shared_;
    }

    const LinearMap& operator*() const { return shared_->map; }
    const LinearMap* operator->() const { return &shared_->map; }
    explicit operator bool() const { return shared_ != nullptr; }
    bool operator==(const LinearMapPtr&) const = default;

private:
    struct Shared {
        LinearMap map;
        std::atomic<std::int64_t> owners;
    };
    Shared* shared_ = nullptr;
};

// A composition under way: matrix, inverse and translation in two parts.
class LAPIDARY_API ExactTransform {
public:
    ExactTransform() = default;  // identity
    // The map of one factor; nothing where it is singular (a zero scale, a rank-deficient or non-finite matrix).
    static std::optional<ExactTransform> of(const TransformFactor& factor);
    static std::optional<ExactTransform> of(const std::vector<TransformFactor>& factors);

    // First this, then next.
    ExactTransform then(const ExactTransform& next) const;
    ExactTransform inverse() const;

    const LinearMapPtr& linear_map() const { return linear_; }
    const TwoPartMatrix3& linear() const;
    const TwoPartMatrix3& inverse_linear() const;
    const std::array<TwoPart, 3>& translation() const { return translation_; }
    bool has_identity_linear() const { return !linear_; }

private:
    LinearMapPtr linear_;
    std::array<TwoPart, 3> translation_;
};

// The rounded map between a local space and its parent's (for a flattened leaf: the world).
class LAPIDARY_API Transform {
public:
    Transform() = default;  // identity
    explicit Transform(const ExactTransform& exact);

    // Whether both were composed of one linear map, and are at one place: what is certainly the same map.
    bool is_same_as(const Transform& other) const {
        return linear_ == other.linear_ && centre_.anchor == other.centre_.anchor && centre_.offset == other.centre_.offset;
    }

    Point to_parent(const Point& p) const;
    Vector to_parent(const Vector& v) const { return linear_ ? multiply(v, linear_->linear) : v; }
    Normal to_parent(const Normal& n) const {  // by the inverse transpose; not normalised
        return linear_ ? Normal(multiply_transposed(to_vector(n), linear_->inverse)) : n;
    }
    Bounds to_parent(const Bounds& b) const;
    Point to_local(const Point& p) const;
    Vector to_local(const Vector& v) const { return linear_ ? multiply(v, linear_->inverse) : v; }
    Normal to_local(const Normal& n) const { return linear_ ? Normal(multiply_transposed(to_vector(n), linear_->linear)) : n; }

    // A^-1 (p - centre), the difference taken in two parts: keeps its digits far from the world's origin.
    Point to_local(const TwoPartPoint& p) const;
    // The same in two parts throughout, for what a point beside a large surface asks.
    std::array<TwoPart, 3> to_local_two_part(const TwoPartPoint& p) const;
    std::array<TwoPart, 3> to_local_two_part(const Vector& v) const;
    // The parent's point as anchor (this space's centre) and offset.
    TwoPartPoint to_parent_two_part(const Point& p) const;

    const TwoPartPoint& centre() const { return centre_; }
    const Matrix3& linear() const { return linear_ ? linear_->linear : identity_matrix; }
    const Matrix3& inverse_linear() const { return linear_ ? linear_->inverse : identity_matrix; }
    bool has_identity_linear() const { return !linear_; }
    bool mirrors() const;  // the map turns left hands into right ones
    // Some directions are stretched much more than others: what is near here may be far away in the local space.
    bool is_lopsided() const { return linear_ && linear_->lopsided; }
    // It makes things so large or so small that squares of lengths overflow or vanish in one of the spaces.
    bool is_extreme() const { return linear_ && linear_->extreme; }
    // It turns, mirrors and scales alike in all directions: balls stay balls.
    bool keeps_shapes() const { return squared_scale() > 0; }
    // If it does, by how much it scales areas; else 0.
    double squared_scale() const { return linear_ ? linear_->squared_scale : 1; }

private:
    std::array<TwoPart, 3> to_local_two_part(const std::array<TwoPart, 3>& v) const;

    TwoPartPoint centre_;
    LinearMapPtr linear_;
};

}  // namespace lapidary
