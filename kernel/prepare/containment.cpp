// SPDX-License-Identifier: MIT
#include "kernel/prepare/containment.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace lapidary {

namespace {

// A solid as another one sees it: all points c + u_1 v_1 + u_2 v_2 + u_3 v_3, with every |u_i| <= 1 or, of a ball, |u| <= 1.
struct Extent {
    Vector centre;
    std::array<Vector, 3> axes;
    bool is_ball = false;
};

Extent extent_of(const PlacedObject& solid, const Transform& seen_from) {
    Extent extent;
    extent.is_ball = solid.faces.size() == 1 && solid.faces[0].kind == Surface::Kind::sphere;
    const Bounds own = solid.object.bounds();
    const Point middle = extent.is_ball ? Point{} : own.centre();
    const double radius = extent.is_ball ? solid.faces[0].a : 0;
    const Vector half = extent.is_ball ? Vector{radius, radius, radius} : 0.5 * own.diagonal();
    extent.centre = to_vector(seen_from.to_local(solid.placement.to_parent_two_part(middle)));
    const std::array<Vector, 3> axes{Vector{half.x, 0, 0}, Vector{0, half.y, 0}, Vector{0, 0, half.z}};
    for (int i = 0; i < 3; ++i) extent.axes[i] = seen_from.to_local(solid.placement.to_parent(axes[i]));
    return extent;
}

// How far it reaches from its centre along a direction: |n . v_1| + |n . v_2| + |n . v_3|, of a ball the root of the squares.
double reach_along(const Vector& n, const Extent& extent) {
    double sum = 0, squares = 0;
    for (const Vector& axis : extent.axes) {
        const double part = std::fabs(dot(n, axis));
        sum += part, squares += part * part;
    }
    return extent.is_ball ? std::sqrt(squares) : sum;
}

// How far it reaches at most, in any direction. Of a box to the farthest corner; of a ball the greatest of the sums of the rows
// of the matrix of all v_i . v_j is no less than its greatest eigenvalue, and the same where the ball is seen as a ball.
double reach(const Extent& extent) {
    const auto& [a, b, c] = extent.axes;
    double squares = 0;
    if (extent.is_ball) {
        for (const Vector& axis : extent.axes)
            squares = std::max(squares, std::fabs(dot(axis, a)) + std::fabs(dot(axis, b)) + std::fabs(dot(axis, c)));
    } else {
        for (const Vector& corner : {a + b + c, a + b - c, a - b + c, a - b - c})
            squares = std::max(squares, dot(corner, corner));
    }
    return std::sqrt(squares);
}

Extent across_y(Extent extent) {
    extent.centre.y = 0;
    for (Vector& axis : extent.axes) axis.y = 0;
    return extent;
}

// Where everything between two distances lies that ends at a third one.
Containment compare(double least, double greatest, double end) {
    // Far more than rounding: what is nearly a contact is left to the rays.
    const double margin = 1e-9 * (std::max(std::fabs(least), std::fabs(greatest)) + std::fabs(end));
    if (greatest < end - margin) return Containment::inside;
    return least > end + margin ? Containment::outside : Containment::unknown;
}

Containment compare_round(const Extent& extent, double radius) {
    const double distance = length(extent.centre), reaches = reach(extent);
    return compare(distance - reaches, distance + reaches, radius);
}

Containment containment_within(const Surface& surface, const Extent& extent) {
    switch (surface.kind) {
        case Surface::Kind::plane: {
            const Vector n{surface.a, surface.b, surface.c};
            const double height = dot(n, extent.centre), reaches = reach_along(n, extent);
            return compare(height - reaches, height + reaches, surface.d);
        }
        case Surface::Kind::sphere:
            return compare_round(extent, surface.a);
        case Surface::Kind::cylinder:
            return compare_round(across_y(extent), surface.a);
        case Surface::Kind::cone:
        case Surface::Kind::torus:
            break;
    }
    return Containment::unknown;
}

}  // namespace

Containment containment_of(const PlacedObject& solid, const PlacedObject& other) {
    if (other.faces.empty() || !solid.object.bounds().is_finite()) return Containment::unknown;
    if (solid.placement.is_extreme() || other.placement.is_extreme()) return Containment::unknown;
    const Extent extent = extent_of(solid, other.placement);
    Containment containment = Containment::inside;  // of all surfaces
    for (const Surface& face : other.faces) {
        const Containment of_face = containment_within(face, extent);
        if (of_face == Containment::outside) return Containment::outside;
        if (of_face == Containment::unknown) containment = Containment::unknown;
    }
    return containment;
}

}  // namespace lapidary
