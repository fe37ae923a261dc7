// SPDX-License-Identifier: MIT
//
// Rays in lanes: each quantity stands in one array for all of them, so that a plain loop over the lanes becomes vector
// instructions.
#pragma once

#include <array>
#include <cstdint>

#include "kernel/interfaces/object.h"
#include "kernel/render/ray.h"

namespace lapidary {

// One number for each ray of a packet.
struct alignas(64) Lanes {
    std::array<double, batch_size> v;
    double& operator[](int lane) { return v[static_cast<std::size_t>(lane)]; }
    double operator[](int lane) const { return v[static_cast<std::size_t>(lane)]; }
};

// `a && b` and `a || b` without a branch, so that loops over lanes stay vector instructions.
inline bool both(bool a, bool b) { return (static_cast<int>(a) & static_cast<int>(b)) != 0; }
inline bool either(bool a, bool b) { return (static_cast<int>(a) | static_cast<int>(b)) != 0; }

// The lanes with a number below infinity: bit i for lane i.
inline unsigned finite_lanes(const Lanes& lanes) {
    std::int64_t finite = 0;
    for (int i = 0; i < batch_size; ++i) finite |= lanes[i] < infinity ? bit_of(i) : 0;
    return static_cast<unsigned>(finite);
}

// Those with one above 0.
inline unsigned positive_lanes(const Lanes& lanes) {
    std::int64_t positive = 0;
    for (int i = 0; i < batch_size; ++i) positive |= lanes[i] > 0 ? bit_of(i) : 0;
    return static_cast<unsigned>(positive);
}

// The lanes with this number: bit i for lane i.
inline unsigned lanes_with(const std::array<std::int32_t, batch_size>& numbers, std::int32_t number) {
    std::int32_t lanes = 0;
    for (int i = 0; i < batch_size; ++i)
        lanes |= numbers[static_cast<std::size_t>(i)] == number ? static_cast<std::int32_t>(bit_of(i)) : 0;
    return static_cast<unsigned>(lanes);
}

// Whether a number is the same in all lanes.
inline bool is_same_in_lanes(const std::array<std::int32_t, batch_size>& values) {
    int same = 0;
    for (std::int32_t value : values) same += value == values[0];
    return same == batch_size;
}

inline unsigned lanes_that_differ(const std::array<std::int32_t, batch_size>& a, const std::array<std::int32_t, batch_size>& b) {
    std::int64_t differ = 0;
    for (int i = 0; i < batch_size; ++i) {
        const auto lane = static_cast<std::size_t>(i);
        differ |= a[lane] != b[lane] ? bit_of(i) : 0;
    }
    return static_cast<unsigned>(differ);
}

// The least and the largest number of all lanes: by halves, as vectors are folded.
template <class Choose>
double fold_lanes(const double* __restrict v, Choose choose) {
    static_assert(batch_size == 16);
    std::array<double, 8> eight;
    for (std::size_t i = 0; i < 8; ++i) eight[i] = choose(v[i], v[8 + i]);
    std::array<double, 4> four;
    for (std::size_t i = 0; i < 4; ++i) four[i] = choose(eight[i], eight[4 + i]);
    return choose(choose(four[0], four[2]), choose(four[1], four[3]));
}
inline double least(const double* lanes) {
    return fold_lanes(lanes, [](double a, double b) { return a < b ? a : b; });
}
inline double largest(const double* lanes) {
    return fold_lanes(lanes, [](double a, double b) { return a > b ? a : b; });
}
inline double least(const Lanes& lanes) { return least(lanes.v.data()); }
inline double largest(const Lanes& lanes) { return largest(lanes.v.data()); }

struct VectorLanes {
    Lanes x, y, z;
    Vector operator[](int lane) const { return {x[lane], y[lane], z[lane]}; }
    template <class Triple>
    void set(int lane, const Triple& t) {
        x[lane] = t.x, y[lane] = t.y, z[lane] = t.z;
    }
};

// What each ray departs from.
struct alignas(64) DepartureLanes {
    std::array<std::int32_t, batch_size> leaf, surface_class, inward, cell;

    Departure operator[](int lane) const {
        const auto i = static_cast<std::size_t>(lane);
        return {leaf[i], surface_class[i], inward[i] != 0, cell[i]};
    }
    void set(int lane, const Departure& d) {
        const auto i = static_cast<std::size_t>(lane);
        leaf[i] = d.leaf, surface_class[i] = d.surface_class, inward[i] = d.inward ? 1 : 0, cell[i] = d.cell;
    }
    void fill(const Departure& d) {
        leaf.fill(d.leaf), surface_class.fill(d.surface_class), inward.fill(d.inward ? 1 : 0), cell.fill(d.cell);
    }
};

struct RayPacket {
    static constexpr int width = batch_size;

    int count = 0;         // the first lanes hold rays
    bool departs = false;  // some lane departs from a surface
    VectorLanes anchor, offset, direction;
    DepartureLanes departure;
    std::array<SampleKey, width> key;

    void clear() { count = 0, departs = false; }
    bool is_full() const { return count == width; }
    unsigned lanes() const { return (1u << count) - 1; }  // that hold rays: bit i for ray i

    void add(const Ray& ray) {
        const int lane = count++;
        anchor.set(lane, ray.origin.anchor), offset.set(lane, ray.origin.offset), direction.set(lane, ray.direction);
        departure.set(lane, ray.departure);
        key[static_cast<std::size_t>(lane)] = ray.key;
        departs |= ray.departure.leaf >= 0 || ray.departure.surface_class >= 0;
    }

    // One of another packet.
    void add(const RayPacket& other, int from) {
        const int lane = count++;
        const auto i = static_cast<std::size_t>(from);
        anchor.set(lane, other.anchor[from]), offset.set(lane, other.offset[from]), direction.set(lane, other.direction[from]);
        departure.set(lane, other.departure[from]);
        key[static_cast<std::size_t>(lane)] = other.key[i];
        departs |= other.departs;
    }

    Ray ray(int lane) const {
        return {{to_point(anchor[lane]), offset[lane]}, direction[lane], departure[lane], key[static_cast<std::size_t>(lane)]};
    }

    // Lanes without a ray repeat the first one, so that arithmetic on all lanes meets nothing strange.
    void fill_up() {
        for (int lane = count; lane < width; ++lane) {
            anchor.set(lane, anchor[0]), offset.set(lane, offset[0]), direction.set(lane, direction[0]);
            departure.set(lane, departure[0]);
            key[static_cast<std::size_t>(lane)] = key[0];
        }
    }
};

// Where each ray of a packet first meets something; t is infinite where it meets nothing.
struct BoundaryPacket {
    Lanes t;
    std::array<std::int32_t, batch_size> solid;  // in World::solids; -1: nothing, or a sheet
    std::array<std::int32_t, batch_size> leaf;   // whose face it is; -1: nothing, or not known
    std::array<std::int32_t, batch_size> face;   // of a leaf that shares faces: which of its surfaces; -1: not known
    unsigned starts_inside;                      // the rays that start in a solid: bit i for ray i

    bool are_of_one_face() const { return is_same_in_lanes(leaf) && is_same_in_lanes(face) && is_same_in_lanes(solid); }
};

// Where what each ray of a packet is in first changes, and the solids that own the cells before and behind.
struct ChangePacket {
    BoundaryPacket first;
    std::array<std::int32_t, batch_size> before, after;  // in World::solids; -1: empty space
    unsigned unclear;                                    // the rays whose answers are not to be used, but those of the single ray

    bool are_alike() const { return first.are_of_one_face() && is_same_in_lanes(before) && is_same_in_lanes(after); }
};

}  // namespace lapidary
