// SPDX-License-Identifier: MIT
#include "kernel/prepare/surface_classes.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <deque>
#include <functional>
#include <span>

#include "kernel/interfaces/object.h"
#include "kernel/prepare/placed_bounds.h"

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
    double key = 0;
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

PlacedSurface::Kind kind_of(const Surface& surface) {
    switch (surface.kind) {
        case Surface::Kind::plane:
            return PlacedSurface::Kind::plane;
        case Surface::Kind::sphere:
            return PlacedSurface::Kind::sphere;
        case Surface::Kind::cylinder:
            return PlacedSurface::Kind::cylinder;
        case Surface::Kind::cone:
            return PlacedSurface::Kind::cone;
        case Surface::Kind::torus:
            return PlacedSurface::Kind::torus;
    }
    return PlacedSurface::Kind::whole;
}

PlacedSurface place(const Leaf& leaf, const Surface& surface) {
    PlacedSurface placed;
    placed.kind = kind_of(surface);
    const Transform& placement = leaf.placement;
    const Matrix3& inverse = placement.inverse_linear();
    placed.centre = placement.centre();
    switch (surface.kind) {
        case Surface::Kind::plane: {
            const Vector normal = to_vector(placement.to_parent(Normal(surface.a, surface.b, surface.c)));
            const double size = length(normal);
            placed.normal = normal / size;
            placed.offset = surface.d / size;
            break;
        }
        case Surface::Kind::sphere:
            placed.form = quadratic_form(inverse, {1, 1, 1}, surface.a * surface.a);
            break;
        case Surface::Kind::cylinder:
            placed.form = quadratic_form(inverse, {1, 0, 1}, surface.a * surface.a);
            break;
        case Surface::Kind::cone:
            placed.centre = placement.to_parent_two_part(Point{0, surface.b, 0});
            placed.form = quadratic_form(inverse, {1, -surface.a * surface.a, 1}, 1);
            placed.form = quadratic_form(inverse, {1, -surface.a * surface.a, 1}, largest_entry(placed.form));
            break;
        case Surface::Kind::torus:
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

// The same without the forms, where most scenes spend their time.
double sweep_key(const Leaf& leaf, const Surface& surface, const Point& probe) {
    if (surface.kind != Surface::Kind::sphere) return sweep_key(place(leaf, surface), probe);
    const Vector from_centre = to_vector(leaf.placement.to_local(probe));
    return std::log2(dot(from_centre, from_centre) / (surface.a * surface.a));
}

// The surfaces by which an object is compared with others. A sheet bounds nothing, but may lie in a face: its one plane takes
// part.
std::span<const Surface> compared_faces(const World& world, const Leaf& leaf) {
    const std::span<const Surface> faces = world.faces_of(leaf);
    return faces.size() < 2 || !leaf.object->is_sheet() ? faces : faces.first(1);
}

bool is_compared_as_a_whole(const Leaf& leaf) { return leaf.face_count == 0 && !leaf.object->is_sheet() && leaf.most_spans <= 2; }

// A face and where it stands in the sweep: equal surfaces have nearly equal keys.
struct SweptFace {
    double key = 0;
    std::int32_t leaf = -1, face = 0;
    PlacedSurface::Kind kind = PlacedSurface::Kind::plane;
};

// Which faces have others of nearly the same key: a table of how many keys fall into each slot, of which a window covers two at
// most. Slots are shared by accident, now and then; with another multiplier, an odd number, there are other accidents.
class KeyTable {
public:
    KeyTable(std::size_t count, std::uint64_t multiplier, double plane_window, double window)
        : multiplier_(multiplier), plane_window_(plane_window), window_(window) {
        counts_.resize(std::bit_ceil(std::max<std::size_t>(16 * count, 64)) / slots_in_word);
    }
    void add(const SweptFace& face) {
        const std::size_t place = slot(face, 0);
        std::uint32_t& counts = counts_[place / slots_in_word];
        if (count_in(place) < 2) counts += std::uint32_t{1} << shift(place);
    }
    bool has_neighbours(const SweptFace& face) const {
        return count_in(slot(face, 0)) > 1 || count_in(slot(face, -1)) > 0 || count_in(slot(face, 1)) > 0;
    }

private:
    static constexpr std::size_t slots_in_word = 16;  // none, one or more, in two bits
    static constexpr unsigned shift(std::size_t slot) { return static_cast<unsigned>(2 * (slot % slots_in_word)); }
    std::uint32_t count_in(std::size_t slot) const { return counts_[slot / slots_in_word] >> shift(slot) & 3; }

    std::size_t slot(const SweptFace& face, double offset) const {
        const double window = face.kind == PlacedSurface::Kind::plane ? plane_window_ : window_;
        const double step = std::floor(face.key / (2 * window)) + offset;
        // Neighbouring slots mostly stand in one line of the cache.
        constexpr double together = 64;
        const double line = std::floor(step / together), place = step - together * line;
        const std::uint64_t hash = (std::bit_cast<std::uint64_t>(line) + static_cast<std::uint64_t>(face.kind)) * multiplier_;
        const auto within = static_cast<std::uint64_t>(place < together ? place : 0);  // where keys are beyond numbers: any
        return (static_cast<std::uint64_t>(together) * (hash ^ hash >> 32) + within) & (slots_in_word * counts_.size() - 1);
    }

    std::uint64_t multiplier_;
    double plane_window_, window_;
    std::vector<std::uint32_t> counts_;
};

class Recogniser {
public:
    Recogniser(World& world, Messages& messages) : world_(world), messages_(messages) {}

    void run() {
        scene_ = region_of_interest(world_);
        // Goes with the scene's size: the same scene at another scale gets the same classes, and the same representatives.
        probe_ = scene_.centre() + length(scene_.diagonal()) * Vector{0.7310, 0.6173, 0.9137};
        plane_window_ = 4000 * coincidence_tolerance(largest_coordinate(scene_), length(scene_.diagonal()));
        gather();
        classify();
        const auto classes = list_members();
        for (const auto& members : classes) elect(members);
        assign(classes);
    }

private:
    // The faces that may be on one surface with others. Most have no other of nearly the same key, and are done with.
    void gather() {
        std::vector<SweptFace> faces;
        faces.reserve(world_.leaves.size());
        for (std::size_t i = 0; i < world_.leaves.size(); ++i) {
            warn_of_distance(world_.leaves[i]);
            warn_of_scale(world_.leaves[i]);
            add_faces(static_cast<std::int32_t>(i), faces);
        }
        for (const std::uint64_t multiplier : {0x9E3779B97F4A7C15, 0xC2B2AE3D27D4EB4F}) {
            KeyTable table(faces.size(), multiplier, plane_window_, window_);
            for (const SweptFace& face : faces) table.add(face);
            std::erase_if(faces, [&](const SweptFace& face) { return !table.has_neighbours(face); });
        }
        for (const SweptFace& face : faces) surfaces_.push_back(place_face(face));
    }

    // Once: what stands so far out that its faces cannot be told from one another.
    void warn_of_distance(const Leaf& leaf) {
        // By its box alone, and without a look at the object: no size that rounding may come near to. Boxes that floats cannot
        // hold have none.
        const Vector from_origin = to_vector(leaf.placement.centre().anchor), across = leaf.bounds().diagonal();
        const double size_squared = dot(across, across);
        if (size_squared > 1e-18 * dot(from_origin, from_origin) && size_squared < infinity) return;
        const auto length_of = [](const Vector& v) { return std::hypot(v.x, v.y, v.z); };  // of any size
        const Vector own = leaf.object->bounds().diagonal();
        if (is_far_ || !(length_of(own) < infinity)) return;
        const double size = length_of(leaf.placement.to_parent(own)), far = length_of(from_origin);
        const double tolerance = coincidence_tolerance(far, size);
        if (size > 16 * tolerance) return;
        is_far_ = true;
        messages_.warning(
            leaf.source->place,
            fmt::format("this object of size {:.2g} stands where numbers are {:.2g} apart, and faces within {:.2g} count as "
                        "one; move the scene nearer to the origin",
                        size, std::nextafter(far, infinity) - far, tolerance));
    }

    // Once: what is shrunk or blown up so much that a step in the world has no square in the object's own space.
    void warn_of_scale(const Leaf& leaf) {
        if (!leaf.placement.is_extreme() || is_scaled_) return;
        is_scaled_ = true;
        const double shrunk = 1 / largest_entry(leaf.placement.inverse_linear()), grown = largest_entry(leaf.placement.linear());
        messages_.warning(leaf.source->place,
                          fmt::format("this object is scaled by {:.2g}: beyond 1e-150 and 1e150 squares of lengths are lost, and "
                                      "it may not show as it is; scale less, and give it its size by its own properties",
                                      shrunk < 1 / grown ? shrunk : grown));
    }

    void add_faces(std::int32_t index, std::vector<SweptFace>& faces) const {
        const Leaf& leaf = world_.leaves[index];
        const std::span<const Surface> surfaces = compared_faces(world_, leaf);
        const auto add = [&](double key, std::size_t face, PlacedSurface::Kind kind) {
            faces.push_back({std::isfinite(key) ? key : 0, index, static_cast<std::int32_t>(face), kind});
        };
        for (std::size_t face = 0; face < surfaces.size(); ++face)
            add(sweep_key(leaf, surfaces[face], probe_), face, kind_of(surfaces[face]));
        if (is_compared_as_a_whole(leaf)) add(sweep_key(place_whole(leaf), probe_), 0, PlacedSurface::Kind::whole);
    }

    PlacedSurface place_face(const SweptFace& face) const {
        const Leaf& leaf = world_.leaves[face.leaf];
        const bool whole = face.kind == PlacedSurface::Kind::whole;
        PlacedSurface placed = whole ? place_whole(leaf) : place(leaf, world_.faces_of(leaf)[face.face]);
        placed.leaf = face.leaf;
        placed.face = face.face;
        placed.key = face.key;
        return placed;
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
        std::deque<std::int32_t> representatives;
        for (std::int32_t index : order) {
            PlacedSurface& surface = surfaces_[index];
            const double window = surface.kind == PlacedSurface::Kind::plane ? plane_window_ : window_;
            while (!representatives.empty()) {
                const PlacedSurface& oldest = surfaces_[representatives.front()];
                if (oldest.kind == surface.kind && surface.key - oldest.key <= window) break;
                representatives.pop_front();
            }
            for (std::int32_t candidate : representatives)
                if (join(surface, candidate)) break;
            if (surface.surface_class < 0) {
                surface.surface_class = index;
                representatives.push_back(index);
            }
        }
    }

    struct Distance {
        double apart, tolerance;
        bool is_none() const { return apart <= tolerance; }
    };
    Distance distance_of(const PlacedSurface& surface, const PlacedSurface& other) const {
        const Bounds box = padded_box(world_, world_.leaves[surface.leaf]),
                     other_box = padded_box(world_, world_.leaves[other.leaf]);
        const Bounds used = unite(finite_part(box, scene_), finite_part(other_box, scene_));
        return {distance_between(surface, other, used), coincidence_tolerance(largest_coordinate(used), length(used.diagonal()))};
    }

    bool join(PlacedSurface& surface, std::int32_t representative) {
        const PlacedSurface& other = surfaces_[representative];
        const Distance distance = distance_of(surface, other);
        if (distance.is_none()) {
            be_represented(surface, representative);
            return true;
        }
        const Leaf &leaf = world_.leaves[surface.leaf], &other_leaf = world_.leaves[other.leaf];
        if (distance.apart <= 1000 * distance.tolerance &&
            widened(padded_box(world_, leaf), distance.apart).overlaps(padded_box(world_, other_leaf)))
            report_near(leaf, other_leaf, distance.apart);
        return false;
    }

    void be_represented(PlacedSurface& surface, std::int32_t by) const {
        surface.surface_class = by;
        surface.flipped = surface.kind == PlacedSurface::Kind::plane && dot(surface.normal, surfaces_[by].normal) < 0;
    }

    // Lines are brought into the space of a leaf that is neither turned nor scaled with less work and less rounding: such a one
    // represents a class where all members are as near to it as they have to be to the first.
    void elect(const std::vector<std::int32_t>& members) {
        const auto is_straight = [this](std::int32_t surface) {
            return world_.leaves[surfaces_[surface].leaf].placement.has_identity_linear();
        };
        if (members.empty() || is_straight(surfaces_[members.front()].surface_class)) return;
        const auto candidate = std::ranges::find_if(members, is_straight);
        if (candidate == members.end()) return;
        const auto is_near = [&](std::int32_t surface) {
            return surface == *candidate || distance_of(surfaces_[surface], surfaces_[*candidate]).is_none();
        };
        if (!std::ranges::all_of(members, is_near)) return;
        for (const std::int32_t surface : members) be_represented(surfaces_[surface], *candidate);
    }

    // By the surface that represents a class.
    std::vector<std::vector<std::int32_t>> list_members() const {
        std::vector<std::vector<std::int32_t>> members(surfaces_.size());
        for (std::size_t i = 0; i < surfaces_.size(); ++i)
            members[surfaces_[i].surface_class].push_back(static_cast<std::int32_t>(i));
        return members;
    }

    void report_near(const Leaf& leaf, const Leaf& other, double apart) {
        // Far from the origin the tolerance is large; what is not near for the size of the objects is meant.
        if (apart > 1e-3 * std::min(length(leaf.bounds().diagonal()), length(other.bounds().diagonal()))) return;
        messages_.warning(
            leaf.source->place,
            fmt::format("a face of this object is {:.1g} away from a face of the one at line {}; is that meant? They are "
                        "rendered as they are, with the gap",
                        apart, other.source->place.line));
    }

    // Leaves that share a face with another one that they touch get all their faces as classes; others none.
    void assign(const std::vector<std::vector<std::int32_t>>& classes) {
        std::vector<bool> shares(world_.leaves.size(), false);
        for (const auto& members : classes) mark_touching(members, shares);
        std::vector<std::int32_t> class_of(surfaces_.size(), -1);
        std::size_t next = 0;  // of the surfaces, which stand in the order of the leaves and their faces
        for (std::size_t i = 0; i < world_.leaves.size(); ++i) {
            if (!shares[i]) continue;
            world_.features.shared_surfaces = true;
            const auto index = static_cast<std::int32_t>(i);
            Leaf& leaf = world_.leaves[i];
            leaf.first_surface = static_cast<std::int32_t>(world_.surface_uses.size());
            leaf.surface_count = std::max(1, static_cast<std::int32_t>(compared_faces(world_, leaf).size()));
            while (surfaces_[next].leaf < index) ++next;
            for (std::int32_t face = 0; face < leaf.surface_count; ++face) {
                const bool has_neighbours =
                    next < surfaces_.size() && surfaces_[next].leaf == index && surfaces_[next].face == face;
                world_.surface_uses.push_back(has_neighbours ? use_of(surfaces_[next++], class_of)
                                                             : SurfaceUse{add_class(index, face), false});
            }
        }
    }

    SurfaceUse use_of(const PlacedSurface& surface, std::vector<std::int32_t>& class_of) {
        std::int32_t& number = class_of[surface.surface_class];
        const PlacedSurface& representative = surfaces_[surface.surface_class];
        if (number < 0) number = add_class(representative.leaf, representative.face);
        return {number, surface.flipped};
    }

    // The new class's number.
    std::int32_t add_class(std::int32_t leaf, std::int32_t face) {
        const std::span<const Surface> surfaces = world_.faces_of(world_.leaves[leaf]);
        SurfaceClass surface_class{leaf, {}, surfaces.empty()};
        if (!surfaces.empty()) {
            const Surface& surface = surface_class.surface = surfaces[face];
            const Normal normal = world_.leaves[leaf].placement.to_parent(Normal(surface.a, surface.b, surface.c));
            if (surface.kind == Surface::Kind::plane) surface_class.shifted_by = dot(normal, generic_shift);
        }
        world_.surface_classes.push_back(surface_class);
        return static_cast<std::int32_t>(world_.surface_classes.size()) - 1;
    }

    // Marks the leaves of a class's surfaces of which two touch, by a sweep along x. Where very many stand side by side, all
    // are taken to.
    void mark_touching(const std::vector<std::int32_t>& list, std::vector<bool>& shares) const {
        if (list.size() < 2) return;
        struct Reach {
            Bounds box;
            std::int32_t leaf;
        };
        std::vector<Reach> reaches;
        reaches.reserve(list.size());
        for (const std::int32_t surface : list) reaches.push_back({reach_of(surfaces_[surface].leaf), surfaces_[surface].leaf});
        std::ranges::sort(reaches, {}, [](const Reach& reach) { return reach.box.low.x; });
        std::size_t left_to_compare = 64 * list.size();
        for (std::size_t a = 0; a < reaches.size(); ++a)
            for (std::size_t b = a + 1; b < reaches.size() && reaches[b].box.low.x <= reaches[a].box.high.x; ++b) {
                if (left_to_compare-- == 0) {
                    for (const Reach& reach : reaches) shares[reach.leaf] = true;
                    return;
                }
                if (reaches[a].leaf != reaches[b].leaf && reaches[a].box.overlaps(reaches[b].box))
                    shares[reaches[a].leaf] = shares[reaches[b].leaf] = true;
            }
    }

    // Where a leaf bounds anything: in the box of the solid that it is part of. A ball that is taken out of many solids lies on
    // one surface in all of them, but solids that stand apart never meet there.
    Bounds reach_of(std::int32_t leaf) const {
        const Bounds box = padded_box(world_, world_.leaves[leaf]);
        for (const std::vector<Solid>* solids : {&world_.solids, &world_.clips}) {
            const auto behind = std::ranges::upper_bound(*solids, leaf, {}, &Solid::first_leaf);
            if (behind == solids->begin()) continue;
            const Solid& solid = *std::prev(behind);
            if (leaf < solid.first_leaf + solid.leaf_count) return intersect(box, world_.box_of(solid.root));
        }
        return box;
    }

    World& world_;
    Messages& messages_;
    bool is_far_ = false;  // and that was told
    bool is_scaled_ = false;
    Bounds scene_;
    Point probe_;
    double plane_window_ = 0;                // how far apart the keys of equal planes may be
    static constexpr double window_ = 1e-8;  // of other surfaces
    std::vector<PlacedSurface> surfaces_;
};

}  // namespace

double largest_coordinate(const Bounds& box) {
    double largest = 0;
    for (double c : {box.low.x, box.low.y, box.low.z, box.high.x, box.high.y, box.high.z})
        if (std::isfinite(c)) largest = std::max(largest, std::fabs(c));
    return largest;
}

// Lines are placed about the leaf's centre, which may be far from what a line meets of an infinite leaf.
Bounds padded_box(const World& world, const Leaf& leaf) {
    const bool is_sheet = leaf.object->is_sheet();
    const Bounds box =
        placed_bounds(leaf.placement, leaf.object->bounds(), is_sheet ? std::span<const Surface>{} : world.faces_of(leaf));
    const Point centre = leaf.placement.centre().rounded();
    const double coordinate = std::max(largest_coordinate(box), largest_coordinate({centre, centre}));
    const double padding = 2 * coincidence_tolerance(coordinate, box.is_finite() ? length(box.diagonal()) : 0);
    const Vector pad{padding, padding, padding};
    return {box.low - pad, box.high + pad};
}

Bounds region_of_interest(const World& world) {
    if (!world.bounds.is_empty()) return world.bounds;
    Bounds of_leaves, of_centres;
    for (const Leaf& leaf : world.leaves) {
        if (const Bounds box = padded_box(world, leaf); box.is_finite()) of_leaves = unite(of_leaves, box);
        of_centres = unite(of_centres, leaf.placement.centre().rounded());
    }
    for (const Bounds& region : {of_leaves, of_centres})
        if (!region.is_empty() && length(region.diagonal()) > 0) return region;
    return Bounds::cube(1);
}

void recognise_coincident_surfaces(World& world, Messages& messages) { Recogniser(world, messages).run(); }

}  // namespace lapidary
