// SPDX-License-Identifier: MIT
#include "kernel/render/placed_material.h"

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

// Transform::to_local of all lanes. A space that lies about the centre of its surroundings asks for no difference.
template <bool identity, bool centred>
[[gnu::noinline]] void place_sites(const Transform& transform, double footprint_scale, const SiteBatch& __restrict sites,
                                   SiteBatch& __restrict local) {
    const TwoPartPoint& centre = transform.centre();
    const Matrix3& inverse = transform.inverse_linear();
    const auto to_local = [&inverse](const Vector& v) { return identity ? v : multiply(v, inverse); };
    for (int lane = 0; lane < batch_size; ++lane) {
        const Point p = sites.points.point(lane);
        if constexpr (centred) {
            local.points.set(lane, to_point(to_local(to_vector(p))));
        } else {
            const TwoPartVector from_centre = TwoPartPoint(p) - centre;
            local.points.set(lane, to_point(to_local(from_centre.hi) + to_local(from_centre.lo)));
        }
        local.footprint[lane] = footprint_scale * sites.footprint[lane];
    }
}

bool is_centred(const Transform& transform) {
    return transform.centre().anchor == Point() && transform.centre().offset == Vector();
}

}  // namespace

PlacedMaterial::PlacedMaterial(MaterialPtr material, const ExactTransform& to_surroundings)
    : material_(std::move(material)),
      transform_(to_surroundings),
      footprint_scale_(mean_stretch(transform_.inverse_linear())),
      greatest_stretch_(norm_bound(transform_.inverse_linear())) {}

Matter PlacedMaterial::evaluate(const Site& site) const {
    Matter matter = material_->evaluate({transform_.to_local(site.point), site.footprint * footprint_scale_});
    matter.relief = relief_in_surroundings(matter.relief);
    return matter;
}

void PlacedMaterial::evaluate_batch(const SiteBatch& sites, unsigned lanes, MatterBatch& matter) const {
    SiteBatch local;
    const auto place = transform_.has_identity_linear() ? place_sites<true, false>
                       : is_centred(transform_)         ? place_sites<false, true>
                                                        : place_sites<false, false>;
    place(transform_, footprint_scale_, sites, local);
    material_->evaluate_batch(local, lanes, matter);
    if (!material_->may_have_relief()) return;
    for_each_lane(lanes, [&](int lane) { matter.set_relief(lane, relief_in_surroundings(matter.relief(lane))); });
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
