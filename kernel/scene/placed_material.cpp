// SPDX-License-Identifier: MIT
#include "kernel/scene/placed_material.h"

#include <cmath>
#include <utility>

namespace lapidary {

namespace {

double frobenius_norm(const Matrix3& m) {
    double sum = 0;
    for (const auto& row : m)
        for (double entry : row) sum += entry * entry;
    return std::sqrt(sum);
}

Matrix3 product_with_transpose(const Matrix3& m) {
    Matrix3 product{};
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) product[i][j] = m[i][0] * m[j][0] + m[i][1] * m[j][1] + m[i][2] * m[j][2];
    return product;
}

// An upper bound of the spectral norm, at most one per cent above it. The Frobenius norm |.| of a matrix is between
// its spectral norm and sqrt(3) times it. With S = M M^T, whose norm is the square of M's, and S^2 = S S^T again for
// every square, the root of |S^(2^k)| taken as often as was squared brings sqrt(3) down to 3^(1/2^(k+2)).
double norm_bound(Matrix3 m) {
    constexpr int squarings = 6;
    double logarithm = 0, weight = 1;  // log of what was divided out so far
    for (int k = 0; k < squarings; ++k) {
        const double scale = largest_entry(m);
        if (!(scale > 0)) return 0;
        for (auto& row : m)
            for (double& entry : row) entry /= scale;
        logarithm += weight * std::log(scale);
        m = product_with_transpose(m);
        weight /= 2;
    }
    return std::exp(logarithm + weight * std::log(frobenius_norm(m))) * (1 + 1e-12);
}

}  // namespace

PlacedMaterial::PlacedMaterial(MaterialPtr material, const ExactTransform& to_surroundings)
    : material_(std::move(material)),
      transform_(to_surroundings),
      footprint_scale_(mean_stretch(transform_.inverse_linear())),
      greatest_stretch_(norm_bound(transform_.inverse_linear())) {}

Matter PlacedMaterial::evaluate(const Site& site) const {
    Matter matter = material_->evaluate({transform_.to_local(site.point), site.footprint * footprint_scale_});
    // A gradient goes from one space to the other like a normal, length included.
    matter.relief = to_vector(transform_.to_parent(Normal(matter.relief)));
    return matter;
}

Crossing PlacedMaterial::next_boundary(const MaterialLine& line, double from, double to) const {
    const MaterialLine local{transform_.to_local(line.origin), transform_.to_local(line.direction)};
    Crossing crossing = material_->next_boundary(local, from, to);
    crossing.normal = transform_.to_parent(crossing.normal);
    return crossing;
}

std::uint64_t PlacedMaterial::region(const Point& point) const { return material_->region(transform_.to_local(point)); }

double PlacedMaterial::clearance(const Point& point) const {
    return material_->clearance(transform_.to_local(point)) / greatest_stretch_;
}

}  // namespace lapidary
