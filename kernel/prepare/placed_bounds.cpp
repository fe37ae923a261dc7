// SPDX-License-Identifier: MIT
#include "kernel/prepare/placed_bounds.h"

#include <cmath>

namespace lapidary {

namespace {

// What lies within `reach` on either side of a centre.
Bounds around(const Point& centre, const Vector& reach) { return {centre - reach, centre + reach}; }

// A local point p stands at sum p_i A_ij, so the points of a unit ball reach as far along axis j of the world as the length of
// column j, and those of a unit disc across the y axis as far as that column without its middle entry.
Vector reach_of_ball(const Matrix3& a) {
    const auto along = [&](int j) { return std::sqrt(a[0][j] * a[0][j] + a[1][j] * a[1][j] + a[2][j] * a[2][j]); };
    return {along(0), along(1), along(2)};
}
Vector reach_of_disc(const Matrix3& a) {
    const auto along = [&](int j) { return std::sqrt(a[0][j] * a[0][j] + a[2][j] * a[2][j]); };
    return {along(0), along(1), along(2)};
}

Bounds bounds_of(const Transform& placement, const Surface& surface, double low_y, double high_y) {
    const Matrix3& a = placement.linear();
    const auto disc = [&](double radius, double y) {
        return around(placement.to_parent(Point{0, y, 0}), radius * reach_of_disc(a));
    };
    switch (surface.kind) {
        case Surface::Kind::plane:
            break;
        case Surface::Kind::sphere:
            return around(placement.to_parent(Point{}), surface.a * reach_of_ball(a));
        case Surface::Kind::cylinder:
            return unite(disc(surface.a, low_y), disc(surface.a, high_y));
        case Surface::Kind::cone:
            // Also where both nappes are used: the apex lies between the discs at their ends.
            return unite(disc(std::fabs(surface.a * (surface.b - low_y)), low_y),
                         disc(std::fabs(surface.a * (surface.b - high_y)), high_y));
        case Surface::Kind::torus:
            return around(placement.to_parent(Point{}), surface.a * reach_of_disc(a) + surface.b * reach_of_ball(a));
    }
    return Bounds::everything();
}

}  // namespace

Bounds placed_bounds(const Transform& placement, const Bounds& own, std::span<const Surface> faces) {
    Bounds box = placement.to_parent(own);
    if (placement.has_identity_linear() || placement.is_extreme() || !own.is_finite()) return box;
    for (const Surface& face : faces) box = intersect(box, bounds_of(placement, face, own.low.y, own.high.y));
    return box;
}

}  // namespace lapidary
