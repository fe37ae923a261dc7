// SPDX-License-Identifier: MIT
//
// Paths in an opaque World, many at a time. A wave of rays goes together from stage to stage:
//
//     first boundaries -> faces, by leaf -> lights, one after the other, with their shadow rays -> colours -> mirrored rays,
//
// which are the next wave. In each stage eight rays stand in lanes; what all rays of a stage share (the leaf's placement, its
// matter, the light) is looked up once. Colours are put together in the order of the single path, to the same bits.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "kernel/csg/packet_through_world.h"
#include "kernel/interfaces/light.h"
#include "kernel/render/tracer_implementation.h"

namespace lapidary {

struct ColourLanes {
    Lanes r, g, b;
    Colour operator[](int lane) const { return {r[lane], g[lane], b[lane]}; }
    void set(int lane, const Colour& c) { r[lane] = c.r, g[lane] = c.g, b[lane] = c.b; }
};

class PacketPaths {
public:
    static constexpr int width = RayPacket::width;

    explicit PacketPaths(Tracer::Implementation& tracer);

    void trace(std::span<const RayPacket> rays, std::span<RaySample> samples, bool all_layers);

private:
    static constexpr int wave_size = 64;

    // Rays on their way, and what each brings back.
    struct Wave {
        int count = 0;
        std::array<RayPacket, wave_size / width> rays;
        std::array<BoundaryPacket, wave_size / width> boundaries;
        std::array<Path, wave_size> paths;
        std::array<Colour, wave_size> colours;
        std::array<std::int32_t, wave_size> sender;  // of a mirrored ray: which ray of the wave before
        std::array<double, wave_size> reflection;    // of the face that it comes from

        void clear();
        void add(const Ray& ray, const Path& path);
        void fill_up();
        Ray ray(int i) const { return rays[i / width].ray(i % width); }
        double t(int i) const { return boundaries[i / width].t[i % width]; }
        std::int32_t leaf(int i) const { return boundaries[i / width].leaf[i % width]; }
        std::int32_t solid(int i) const { return boundaries[i / width].solid[i % width]; }
        bool starts_inside(int i) const { return (boundaries[i / width].starts_inside >> i % width & 1) != 0; }
    };

    // Eight faces that rays of a wave have met, with all that shading asks: an Encounter in lanes.
    struct FacePacket {
        int count = 0;
        std::array<std::int32_t, width> ray;  // number in the wave
        VectorLanes anchor, offset;           // of the place
        VectorLanes arriving;                 // direction of the ray
        VectorLanes outward, geometric, shading, mirrored;
        PointBatch points;  // rounded
        Lanes travelled, reflection, shininess;
        ColourLanes colour, ambient, diffuse, highlight;
        std::array<Departure, width> departure;
        std::array<SampleKey, width> key;
        std::array<std::uint32_t, width> light_samples;  // taken so far along the path

        bool is_full() const { return count == width; }
        void add(const Wave& wave, int ray, const Encounter& encounter);
        void fill_up();
    };

    // A light as it falls on a packet of faces, before shadow.
    struct AimedLights {
        IlluminationBatch illumination;
        Lanes diffuse, highlight;
        unsigned arrives = 0;  // the lanes that it may reach
    };

    // Shadow rays on their way, and what each adds if nothing is in the way.
    struct Shadows {
        static constexpr int most = static_cast<int>(PacketThroughWorld::most_packets) * width;
        int count = 0;
        std::array<RayPacket, PacketThroughWorld::most_packets> rays;
        std::array<Lanes, PacketThroughWorld::most_packets> distances;
        std::array<Colour, most> diffuse, highlight;
        std::array<FacePacket*, most> faces;
        std::array<std::int32_t, most> lane;
    };

    // Depth 0 are camera rays; `first` is empty or has a place for each ray.
    void trace_wave(std::size_t depth, std::span<RaySample> first);
    void collect_faces(Wave& wave, std::span<RaySample> first);
    bool is_plain(const Wave& wave, int ray) const;
    void meet_plain_faces(Wave& wave, std::uint64_t& waiting, std::span<RaySample> first);
    void meet_single_face(Wave& wave, int ray, std::span<RaySample> first);
    void place_faces(const Leaf& leaf, const RayPacket& rays, const Lanes& t, FacePacket& faces);
    void give_matter(const MaterialInstance& material, FacePacket& faces);
    void light_faces();
    void begin_light(FacePacket& faces);
    void aim(const Light& light, FacePacket& faces, AimedLights& aimed);
    void send_shadow_rays(FacePacket& faces, const AimedLights& aimed);
    void cast_shadows();
    void finish_colours(std::size_t depth);
    void mirror_ray(FacePacket& faces, int lane, Wave& wave, Wave& next);
    FacePacket& new_faces();

    Tracer::Implementation& tracer_;
    const World& world_;
    PacketThroughWorld packet_;
    std::uint32_t extended_lights_ = 0;
    std::vector<std::unique_ptr<Wave>> waves_;  // by depth
    std::vector<std::unique_ptr<FacePacket>> faces_;
    std::size_t face_packets_ = 0;  // in use
    FacePacket* single_faces_ = nullptr;
    Shadows shadows_;
};

}  // namespace lapidary
