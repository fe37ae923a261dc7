// SPDX-License-Identifier: MIT
//
// A packet of rays through a World: the same answers as RayThroughWorld, bit for bit, several times faster.
//
// A packet needs no coherence to pay: walking a hierarchy waits for memory, and all rays wait together. Boxes are tested in
// floats, so conservatively that no ray loses a box which its doubles would meet; what is found is evaluated in doubles.
#pragma once

#include <array>
#include <cstdint>

#include "kernel/csg/packet_through_solid.h"
#include "kernel/csg/ray_packet.h"
#include "kernel/csg/ray_through_world.h"
#include "kernel/csg/solids_in_reach.h"

namespace lapidary {

class LAPIDARY_API PacketThroughWorld {
public:
    static constexpr int width = RayPacket::width;

    PacketThroughWorld(const World& world, TraceStatistics& statistics);

    // What each ray meets first in a World that has nothing transparent. Packets are filled up.
    // `among`: the solids that the rays may meet; null: all. `quarter`: the part of them that the rays are, where they are
    // divided.
    void first_boundaries(const RayPacket& rays, const SolidsInReach* among, BoundaryPacket& boundaries,
                          unsigned quarter = SolidInReach::all_rays);

    // The lines of the last packet of rays in a leaf's space.
    const PlacedLines& placed_lines(std::int32_t leaf) { return solid_.placed_lines(leaf); }
    const SpanBatch& local_spans(std::int32_t leaf) { return solid_.local_spans(leaf); }

    // Whether anything lies between each ray's start and its distance: bit i for ray i. Rays with a distance below 0 are left
    // out.
    unsigned blocked(const RayPacket& rays, const Lanes& distances, const SolidsInReach* among = nullptr);

    // Whether rays with this departure, which may meet these solids only, meet none of them for certain, or only such as change
    // nothing of light.
    bool are_clear(const Departure& departure, const SolidsInReach& among) const;

    // The same for a World with transparent matter: the first change of what a ray is in, behind `from` and not beyond its limit.
    // Rays whose limit is below 0 are left out.
    struct Stretch {
        Lanes from, limit;
    };
    void first_changes(const RayPacket& rays, const Stretch& stretch, const SolidsInReach* among, ChangePacket& changes,
                       unsigned quarter = SolidInReach::all_rays);

    // Of the rays to a light: those that are blocked, and, of the others, those that are dimmed, or may be.
    struct Shadows {
        unsigned blocked = 0, asked = 0;
    };
    Shadows shadows(const RayPacket& rays, const Lanes& distances, const SolidsInReach* among = nullptr);

private:
    struct alignas(64) FloatLanes {
        std::array<float, width> v;
        float& operator[](int lane) { return v[static_cast<std::size_t>(lane)]; }
        float operator[](int lane) const { return v[static_cast<std::size_t>(lane)]; }
    };
    // As seen from the anchor of the hierarchy: origins rounded up and down, and inverse directions.
    struct FloatRays {
        FloatLanes high_x, high_y, high_z, low_x, low_y, low_z;
        FloatLanes inverse_x, inverse_y, inverse_z;
    };
    enum class Order : std::uint8_t { near_first, any };

    void start(const RayPacket& rays);
    void get_ready_for_boxes();
    void round_rays();
    void set_limits();
    static void round_limits(const Lanes& limits, const Lanes& shifts, FloatLanes& rounded);
    template <Order order, class Visit>
    void for_each_solid(const SolidsInReach* among, unsigned quarter, Visit visit);
    template <Order order, class Visit>
    void walk(Visit visit);
    void ask_for_children(const Hierarchy::Node& node) const;
    void ask_for_first_leaf(std::int32_t child) const;
    bool meets(const std::array<float, 3>& low, const std::array<float, 3>& high, FloatLanes& near) const;
    static int votes_for_second(const FloatLanes& first, const FloatLanes& second);
    // Whether any ray reaches a box within its limit.
    static bool is_within(const FloatLanes& near, const FloatLanes& limits);
    void meet_solid(std::int32_t index, BoundaryPacket& boundaries);
    void name_shared_faces(BoundaryPacket& boundaries);
    void meet_sheets(const Lanes& from, BoundaryPacket& boundaries);
    unsigned blocked_by_sheets(const Lanes& distances, unsigned among);
    void change_at_solid(std::int32_t index, ChangePacket& changes);
    void change_at_solid_of_single(std::int32_t index, ChangePacket& changes);
    void finish_changes(ChangePacket& changes);
    unsigned reached(std::int32_t index);
    bool takes_precedence(std::int32_t solid, std::int32_t other) const;

    const World& world_;
    TraceStatistics& statistics_;
    RayThroughWorld single_;
    double reach_ = 0;  // a radius about the hierarchy's anchor that all of its boxes are within

    const RayPacket* packet_ = nullptr;
    bool is_ready_for_boxes_ = false;  // the rays are rounded
    PacketThroughSolid solid_;
    Lanes limits_, shifts_;
    // Of the solids that a ray starts in the two that come first, and whether what it meets first is shared, or not for lanes.
    struct Starts {
        std::array<std::int32_t, width> first, second;
        unsigned leaves_first, shared;
    };
    Starts starts_;
    Lanes from_;
    FloatRays rays_{};
    FloatLanes float_limits_;
    std::array<std::int32_t, 128> children_;
    std::array<FloatLanes, 128> nears_;
};

}  // namespace lapidary
