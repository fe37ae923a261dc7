// SPDX-License-Identifier: MIT
#include "kernel/prepare/surface_classes.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <functional>

#include "kernel/interfaces/object.h"

namespace lapidary {

namespace {

using Row = std::array<double, 3>;

// A face in the world, in a form in which two faces can be compared.
//
// Planes are n . (x - c) = e with a unit normal. Quadrics are (x - c) M (x - c)^T = 1 (a cone: = 0), with the matrix
// M = A^-1 Q A^-T, which does not care by which chain of rotations the leaf was placed, nor about turns of the surface in
// itself. A torus has two such matrices, of its plane and of its axis. A solid without known faces is compared as a whole.
struct PlacedSurface {
    enum class Kind { plane, sphere, cylinder, cone, torus, whole };
    Kind kind = Kind::plane;
    TwoPartPoint centre;
    Vector normal;
    double offset = 0;
    Matrix3 form{}, axis_form{};
    double ratio = 0;
    const Object* object = nullptr;

    std::int32_t leaf = -1, face = 0;
    double key = 0;  // of the sweep: equal surfaces have nearly equal keys
    std::int32_t surface_class = -1;
    bool flipped = false;
};

// A^-1 diag(q) A^-T / scale
Matrix3 quadratic_form(const Matrix3& inverse, const Row& q, double scale) {
    Matrix3 form{};
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            double sum = 0;
            for (int k = 0; k < 3; ++k) sum += inverse[i][k] * q[k] * inverse[j][k];
            form[i][j] = sum / scale;
        }
    return form;
}

double value(const Matrix3& form, const Vector& v) {
    const Row r{v.x, v.y, v.z};
    double sum = 0;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) sum += r[i] * form[i][j] * r[j];
    return sum;
}

double largest_difference(const Matrix3& a, const Matrix3& b) {
    double largest = 0;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) largest = std::max(largest, std::fabs(a[i][j] - b[i][j]));
    return largest;
}

Vector rounded(const TwoPartVector& v) { return v.hi + v.lo; }

PlacedSurface place(const Leaf& leaf, const Surface& surface) {
    PlacedSurface placed;
    const Transform& placement = leaf.placement;
    const Matrix3& inverse = placement.inverse_linear();
    placed.centre = placement.centre();
    switch (surface.kind) {
        case Surface::Kind::plane: {
            placed.kind = PlacedSurface::Kind::plane;
            const Vector normal = to_vector(placement.to_parent(Normal(surface.a, surface.b, surface.c)));
            const double size = length(normal);
            placed.normal = normal / size;
            placed.offset = surface.d / size;
            break;
        }
        case Surface::Kind::sphere:
            placed.kind = PlacedSurface::Kind::sphere;
            placed.form = quadratic_form(inverse, {1, 1, 1}, surface.a * surface.a);
            break;
        case Surface::Kind::cylinder:
            placed.kind = PlacedSurface::Kind::cylinder;
            placed.form = quadratic_form(inverse, {1, 0, 1}, surface.a * surface.a);
            break;
        case Surface::Kind::cone:
            placed.kind = PlacedSurface::Kind::cone;
            placed.centre = placement.to_parent_two_part(Point{0, surface.b, 0});
            placed.form = quadratic_form(inverse, {1, -surface.a * surface.a, 1}, 1);
            placed.form = quadratic_form(inverse, {1, -surface.a * surface.a, 1}, largest_entry(placed.form));
            break;
        case Surface::Kind::torus:
            placed.kind = PlacedSurface::Kind::torus;
            placed.form = quadratic_form(inverse, {1, 0, 1}, surface.a * surface.a);
            placed.axis_form = quadratic_form(inverse, {0, 1, 0}, surface.a * surface.a);
            placed.ratio = surface.b / surface.a;
            break;
    }
    return placed;
}

PlacedSurface place_whole(const Leaf& leaf) {
    PlacedSurface placed;
    placed.kind = PlacedSurface::Kind::whole;
    placed.centre = leaf.placement.centre();
    placed.form = leaf.placement.inverse_linear();
    placed.object = leaf.object;
    return placed;
}

// The part of a box that is finite, an infinite side cut at the scene's; for infinite solids alone, a unit box.
Bounds finite_part(const Bounds& box, const Bounds& scene) {
    Bounds finite = box.is_finite() ? box : intersect(box, scene);
    if (finite.is_empty() || !finite.is_finite()) finite = scene;
    return finite;
}

Bounds widened(const Bounds& box, double by) {
    const Vector margin{by, by, by};
    return {box.low - margin, box.high + margin};
}

// How far apart two surfaces are, in world units, where either leaf uses them; infinity where they are plainly different.
double distance_between(const PlacedSurface& a, const PlacedSurface& b, const Bounds& used) {
    if (a.kind != b.kind) return infinity;
    const double extent = length(used.diagonal());
    const Vector between = rounded(a.centre - b.centre);
    switch (a.kind) {
        case PlacedSurface::Kind::plane: {
            const double sign = dot(a.normal, b.normal) < 0 ? -1 : 1;
            if (length(a.normal - sign * b.normal) > 1e-6) return infinity;
            double apart = 0;
            for (int corner = 0; corner < 8; ++corner) {
                const Point p{corner & 1 ? used.high.x : used.low.x, corner & 2 ? used.high.y : used.low.y,
                              corner & 4 ? used.high.z : used.low.z};
                const double of_a = dot(a.normal, rounded(TwoPartPoint(p) - a.centre)) - a.offset;
                const double of_b = dot(b.normal, rounded(TwoPartPoint(p) - b.centre)) - b.offset;
                apart = std::max(apart, std::fabs(of_a - sign * of_b));
            }
            return apart;
        }
        case PlacedSurface::Kind::sphere:
            return length(between) + 0.5 * extent * largest_difference(a.form, b.form) * (0.25 * extent * extent);
        case PlacedSurface::Kind::cylinder: {
            const double radius = std::sqrt(1 / largest_entry(a.form));
            return radius * (std::sqrt(std::fmax(0, value(a.form, between))) +
                             0.5 * largest_difference(a.form, b.form) * (0.25 * extent * extent));
        }
        case PlacedSurface::Kind::cone:
            return length(between) + extent * largest_difference(a.form, b.form);
        case PlacedSurface::Kind::torus:
            return length(between) + extent * std::fabs(a.ratio - b.ratio) +
                   0.5 * extent * (largest_difference(a.form, b.form) + largest_difference(a.axis_form, b.axis_form)) *
                       (0.25 * extent * extent);
        case PlacedSurface::Kind::whole:
            if (a.object != b.object) return infinity;
            return length(between) + extent * largest_difference(a.form, b.form) / largest_entry(a.form);
    }
    return infinity;
}

// The value of the surface's equation at one point in general position: surfaces that are the same have the same value to
// rounding, others by accident only. Values of quadrics are compared by their logarithm.
double sweep_key(const PlacedSurface& s, const Point& probe) {
    const Vector from_centre = rounded(TwoPartPoint(probe) - s.centre);
    switch (s.kind) {
        case PlacedSurface::Kind::plane:
            return std::fabs(dot(s.normal, from_centre) - s.offset);
        case PlacedSurface::Kind::whole:
            return std::log2(length(from_centre));
        case PlacedSurface::Kind::torus:
            return std::log2(value(s.form, from_centre) + value(s.axis_form, from_centre));
        default:
            return std::log2(std::fabs(value(s.form, from_centre)));
    }
}

class Recogniser {
public:
    Recogniser(World& world, Messages& messages) : world_(world), messages_(messages) {}

    void run() {
        scene_ = region_of_interest(world_);
        // Goes with the scene's size: the same scene at another scale gets the same classes, and the same representatives.
        probe_ = scene_.centre() + length(scene_.diagonal()) * Vector{0.7310, 0.6173, 0.9137};
        gather();
        classify();
        assign();
    }

private:
    void gather() {
        for (std::size_t i = 0; i < world_.leaves.size(); ++i) {
            const Leaf& leaf = world_.leaves[i];
            warn_of_distance(leaf);
            Surfaces surfaces = leaf.object->surfaces();
            if (leaf.object->is_sheet()) {
                // A sheet bounds nothing, but may lie in a face: its one plane takes part.
                if (surfaces.empty()) continue;
                surfaces.resize(1);
            }
            if (surfaces.empty() && leaf.object->max_spans() <= 2) add(place_whole(leaf), static_cast<std::int32_t>(i), 0);
            for (std::size_t face = 0; face < surfaces.size(); ++face)
                add(place(leaf, surfaces[face]), static_cast<std::int32_t>(i), static_cast<std::int32_t>(face));
        }
    }

    // Once: what stands so far out that its faces cannot be told from one another.
    void warn_of_distance(const Leaf& leaf) {
        const Vector own = leaf.object->bounds().diagonal();
        if (is_far_ || !(dot(own, own) < infinity)) return;
        const double size = length(leaf.placement.to_parent(own)), far = length(to_vector(leaf.placement.centre().anchor));
        const double tolerance = coincidence_tolerance(far, size);
        if (size > 16 * tolerance) return;
        is_far_ = true;
        messages_.warning(
            leaf.source->place,
            fmt::format("this object of size {:.2g} stands where numbers are {:.2g} apart, and faces within {:.2g} count as "
                        "one; move the scene nearer to the origin",
                        size, std::nextafter(far, infinity) - far, tolerance));
    }

    void add(PlacedSurface surface, std::int32_t leaf, std::int32_t face) {
        surface.leaf = leaf;
        surface.face = face;
        surface.key = sweep_key(surface, probe_);
        if (!std::isfinite(surface.key)) surface.key = 0;
        surfaces_.push_back(surface);
    }

    // A sweep over the keys: each surface is compared with the representatives just below it, never with other members, so
    // that differences cannot add up along a chain.
    void classify() {
        std::vector<std::int32_t> order(surfaces_.size());
        for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<std::int32_t>(i);
        std::sort(order.begin(), order.end(), [this](std::int32_t a, std::int32_t b) {
            const PlacedSurface &x = surfaces_[a], &y = surfaces_[b];
            return std::tie(x.kind, x.key, x.leaf, x.face) < std::tie(y.kind, y.key, y.leaf, y.face);
        });
        const double plane_window = 4000 * coincidence_tolerance(largest_coordinate(scene_), length(scene_.diagonal()));
        std::deque<std::int32_t> representatives;
        for (std::int32_t index : order) {
            PlacedSurface& surface = surfaces_[index];
            const double window = surface.kind == PlacedSurface::Kind::plane ? plane_window : 1e-8;
            while (!representatives.empty()) {
                const PlacedSurface& oldest = surfaces_[representatives.front()];
                if (oldest.kind == surface.kind && surface.key - oldest.key <= window) break;
                representatives.pop_front();
            }
            for (std::int32_t candidate : representatives)
                if (join(surface, surfaces_[candidate], candidate)) break;
            if (surface.surface_class < 0) {
                surface.surface_class = index;
                representatives.push_back(index);
            }
        }
    }

    bool join(PlacedSurface& surface, const PlacedSurface& representative, std::int32_t surface_class) {
        const Leaf &leaf = world_.leaves[surface.leaf], &other = world_.leaves[representative.leaf];
        const Bounds used = unite(finite_part(leaf.box, scene_), finite_part(other.box, scene_));
        const double tolerance = coincidence_tolerance(largest_coordinate(used), length(used.diagonal()));
        const double apart = distance_between(surface, representative, used);
        if (!(apart <= tolerance)) {
            if (apart <= 1000 * tolerance && widened(leaf.box, apart).overlaps(other.box)) report_near(leaf, other, apart);
            return false;
        }
        surface.surface_class = surface_class;
        surface.flipped = surface.kind == PlacedSurface::Kind::plane && dot(surface.normal, representative.normal) < 0;
        return true;
    }

    void report_near(const Leaf& leaf, const Leaf& other, double apart) {
        // Far from the origin the tolerance is large; what is not near for the size of the objects is meant.
        if (apart > 1e-3 * std::min(length(leaf.box.diagonal()), length(other.box.diagonal()))) return;
        messages_.warning(
            leaf.source->place,
            fmt::format("a face of this object is {:.1g} away from a face of the one at line {}; is that meant? They are "
                        "rendered as they are, with the gap",
                        apart, other.source->place.line));
    }

    // Leaves that share a face with another one that they touch get all their faces as classes; others none.
    void assign() {
        std::vector<std::vector<std::int32_t>> members(surfaces_.size());
        for (std::size_t i = 0; i < surfaces_.size(); ++i)
            members[surfaces_[i].surface_class].push_back(static_cast<std::int32_t>(i));
        std::vector<bool> shared(world_.leaves.size(), false);
        for (const auto& list : members) mark_touching(list, shared);

        std::vector<std::int32_t> class_of(surfaces_.size(), -1);
        for (std::size_t i = 0; i < surfaces_.size(); ++i) {
            const PlacedSurface& surface = surfaces_[i];
            Leaf& leaf = world_.leaves[surface.leaf];
            if (!shared[surface.leaf]) continue;
            world_.features.shared_surfaces = true;
            if (surface.face == 0) leaf.first_surface = static_cast<std::int32_t>(world_.surface_uses.size());
            ++leaf.surface_count;
            std::int32_t& number = class_of[surface.surface_class];
            if (number < 0) {
                number = static_cast<std::int32_t>(world_.surface_classes.size());
                const PlacedSurface& representative = surfaces_[surface.surface_class];
                const Surfaces faces = world_.leaves[representative.leaf].object->surfaces();
                SurfaceClass surface_class{representative.leaf, {}, faces.empty()};
                if (!faces.empty()) surface_class.surface = faces[representative.face];
                world_.surface_classes.push_back(surface_class);
            }
            world_.surface_uses.push_back({number, surface.flipped});
        }
    }

    void mark_touching(const std::vector<std::int32_t>& list, std::vector<bool>& shared) const {
        constexpr std::size_t worth_comparing = 32;
        if (list.size() < 2) return;
        for (std::int32_t a : list) {
            const std::int32_t leaf = surfaces_[a].leaf;
            const auto touches = [&](std::int32_t b) {
                return surfaces_[b].leaf != leaf && world_.leaves[leaf].box.overlaps(world_.leaves[surfaces_[b].leaf].box);
            };
            if (list.size() > worth_comparing || std::any_of(list.begin(), list.end(), touches)) shared[leaf] = true;
        }
    }

    World& world_;
    Messages& messages_;
    bool is_far_ = false;  // and that was told
    Bounds scene_;
    Point probe_;
    std::vector<PlacedSurface> surfaces_;
};

}  // namespace

double largest_coordinate(const Bounds& box) {
    double largest = 0;
    for (double c : {box.low.x, box.low.y, box.low.z, box.high.x, box.high.y, box.high.z})
        if (std::isfinite(c)) largest = std::max(largest, std::fabs(c));
    return largest;
}

Bounds region_of_interest(const World& world) {
    if (!world.bounds.is_empty()) return world.bounds;
    Bounds of_leaves, of_centres;
    for (const Leaf& leaf : world.leaves) {
        if (leaf.box.is_finite()) of_leaves = unite(of_leaves, leaf.box);
        of_centres = unite(of_centres, leaf.placement.centre().rounded());
    }
    for (const Bounds& region : {of_leaves, of_centres})
        if (!region.is_empty() && length(region.diagonal()) > 0) return region;
    return Bounds::cube(1);
}

void recognise_coincident_surfaces(World& world, Messages& messages) { Recogniser(world, messages).run(); }

}  // namespace lapidary
