// SPDX-License-Identifier: MIT
//
// Paths, many at a time. A wave of rays goes together from stage to stage:
//
//     first boundaries -> faces, by leaf -> lights, one after the other, with their shadow rays -> colours -> mirrored rays,
//
// which are the next wave. Where matter is transparent (packet_paths_through_matter.cpp), first changes of it take the place of
// boundaries, and refracted rays join the mirrored ones; a ray that has to do with anything unusual is traced by itself. In each
// stage the rays of a packet stand in lanes; what all rays of a stage share (the leaf's placement, its matter, the light) is
// looked up once. Colours are put together in the order of the single path, to the same bits.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "kernel/csg/packet_through_world.h"
#include "kernel/csg/placed_lines.h"
#include "kernel/csg/shaft_through_world.h"
#include "kernel/interfaces/light.h"
#include "kernel/render/tracer_implementation.h"

namespace lapidary {

struct ColourLanes {
    Lanes r, g, b;
    Colour operator[](int lane) const { return {r[lane], g[lane], b[lane]}; }
    void set(int lane, const Colour& c) { r[lane] = c.r, g[lane] = c.g, b[lane] = c.b; }
    void add(int lane, const Colour& c) { r[lane] += c.r, g[lane] += c.g, b[lane] += c.b; }
};

class PacketPaths {
public:
    static constexpr int width = RayPacket::width;

    explicit PacketPaths(Tracer::Implementation& tracer);

    void trace(std::span<const RayPacket> rays, std::span<Colour> colours, std::span<FirstFace> faces);

private:
    // So many that most packets of faces are full, whether many small solids are seen or rays are spread by glass.
    static constexpr int wave_size = 256;

    // Through transparent matter a ray may send two: waves longer than a portion are traced one portion after the other.
    static constexpr int portion_size = 2 * wave_size;
    // So many waves one after the other; then each ray goes on by itself.
    static constexpr std::size_t most_waves = 64;

    // Rays of a wave whose faces are to be gathered with those of others: of each packet, bit i for ray i.
    using WaitingRays = std::array<unsigned, wave_size / width>;

    // What a ray of the next wave, or the background where the path ends, adds to a ray of this one.
    struct Contribution {
        std::int32_t to = 0;
        std::int32_t from = -1;  // -1: the background
        double weight = 0;
    };

    // What the rays of a packet meet where their matter first changes. A plain face is one of which all that it shows can be had
    // without asking the single ray: which leaf it is of is known, and of it which surface, and no opaque matter may lie right
    // behind a transparent face.
    struct Meetings {
        unsigned plain, dimmed;  // bit i for ray i: meets a plain face; its matter takes something of its light
        bool are_alike;          // all rays come from the same cell, meet the same face and go on into the same cell
        std::array<std::int32_t, width> shown;                     // the material; -1: none, or it has to be asked for
        std::array<std::int32_t, width> cell_before, cell_behind;  // by owner
    };

    // Rays on their way, and what each brings back.
    struct Wave {
        Wave();

        int count = 0;
        std::span<const RayPacket> rays;  // its own ones, or those of the camera
        std::vector<RayPacket> own_rays;
        std::array<BoundaryPacket, wave_size / width> boundaries;
        bool some_start_inside = false;  // of the rays whose boundaries are found
        std::vector<Path> paths;
        std::span<Colour> colours;  // its own ones, or those asked for
        std::vector<Colour> own_colours;
        std::array<std::int32_t, wave_size> sender;  // of a mirrored ray: which ray of the wave before
        std::array<double, wave_size> reflection;    // of the face that it comes from

        // Where matter is transparent: of each ray where it begins, what light from faces that it has passed is gathered, and
        // what is left of light on the way; of the portion under way what changes first, and what comes back, mirrored before
        // refracted.
        std::vector<PacketThroughWorld::Stretch> stretches;
        std::vector<Colour> gathered, passed;
        std::vector<std::uint32_t> lit;  // faces that it has passed
        int begin = 0, end = 0;
        std::vector<ChangePacket> changes;
        std::vector<Meetings> meetings;
        std::vector<Contribution> contributions;

        void make_room(int rays);
        void clear();
        void fill_up();
        Ray ray(int i) const { return rays[i / width].ray(i % width); }
        double t(int i) const { return boundaries[i / width].t[i % width]; }
        std::int32_t leaf(int i) const { return boundaries[i / width].leaf[i % width]; }
        std::int32_t face(int i) const { return boundaries[i / width].face[i % width]; }
        std::int32_t solid(int i) const { return boundaries[i / width].solid[i % width]; }
        void begin_camera_rays();
        void send(const RayPacket& from, int lane);
        double from(int i) const { return stretches[static_cast<std::size_t>(i / width)].from[i % width]; }
        int packets_under_way() const { return (end - begin + width - 1) / width; }
        const ChangePacket& change(int i) const { return changes[(i - begin) / width]; }
        const Meetings& meeting(int i) const { return meetings[(i - begin) / width]; }
        bool starts_inside(int i) const { return (boundaries[i / width].starts_inside >> i % width & 1) != 0; }
    };

    // Faces that rays of a wave have met, with all that shading asks: an Encounter in lanes.
    struct FacePacket {
        int count = 0;
        std::array<std::int32_t, width> ray;  // number in the wave
        VectorLanes anchor, offset;           // of the place
        VectorLanes arriving;                 // direction of the ray
        VectorLanes outward, geometric, shading, mirrored;
        PointBatch points;  // rounded
        Lanes travelled, reflection, shininess;
        ColourLanes colour, ambient, diffuse, highlight;
        DepartureLanes departure;
        std::array<SampleKey, width> key;
        bool depart_alike;                               // all of the same face
        bool is_mirrored;                                // `mirrored` is known
        std::array<std::uint32_t, width> light_samples;  // taken so far along the path

        bool is_full() const { return count == width; }
        unsigned lanes() const { return (1u << count) - 1; }  // that hold faces: bit i for face i
        // Of transparent matter, bit i for lane i: which faces are of it, which are sheets, and which are seen from inside.
        unsigned transparent, sheets, leaving;
        Lanes t, opacity, index_before, index_behind;
        std::array<std::int32_t, width> cell_behind;

        void add(const Wave& wave, int ray, const Encounter& encounter);
        void set_matter(int lane, const Matter& matter);
        void copy_matter(int lane, int from);
        void fill_up();
        // Rays that start at the faces, each at the side that its direction points to.
        void depart(const VectorLanes& directions, RayPacket& rays) const;
    };

    using FacePackets = std::span<const std::unique_ptr<FacePacket>>;

    // Points of the lanes that meet a face beside the origins of their rays.
    struct NearPoints {
        std::uint64_t lanes = 0;
        std::array<TwoPartPoint, width> points;

        void find(const RayPacket& rays, const Lanes& t, const Lanes& anchor);
        void replace_local(const Transform& placement, PointBatch& local) const;
        void replace(FacePacket& faces) const;
    };

    // A light as it falls on a packet of faces, before shadow.
    struct AimedLights {
        IlluminationBatch illumination;
        Lanes diffuse, highlight;
        unsigned arrives = 0;  // the lanes that it may reach
        Colour radiance(int lane) const { return {illumination.r[lane], illumination.g[lane], illumination.b[lane]}; }
    };

    // Shadow rays of faces in the same lanes. Those that are not sent have a distance below 0.
    struct AimedShadows {
        RayPacket rays;
        Lanes distances;
    };
    // Shadow rays of faces of any packets, each with what it adds to which face if nothing is in the way.
    struct Shadows {
        RayPacket rays;
        Lanes distances;
        ColourLanes radiance;
        Lanes diffuse, highlight, to_light;  // `to_light` is the distance to the light, of which the ray's lacks a little
        std::array<FacePacket*, width> faces;
        std::array<std::int32_t, width> lane;

        void add(const AimedShadows& shadows, const AimedLights& lights, FacePacket& to, int from);
        void take(const Shadows& other, int from);
    };

    const SolidsInReach* in_reach_of(std::size_t depth) const { return depth == 0 ? &tracer_.beam.solids() : nullptr; }
    unsigned quarter_of(std::size_t depth, int packet) const;
    // Depth 0 are camera rays; `first` is empty or has a place for each ray.
    void trace_wave(std::size_t depth, std::span<FirstFace> first);
    unsigned collect_faces_of(Wave& wave, int packet, std::span<FirstFace> first);
    void collect_faces(Wave& wave, WaitingRays& waiting, std::span<FirstFace> first);
    bool is_plain(const Wave& wave, int ray) const;
    void meet_plain_faces(Wave& wave, int leader, WaitingRays& waiting, std::span<FirstFace> first);
    void note_paths(const Wave& wave, const Lanes& t, FacePacket& faces);
    void note_rays(const Wave& wave, std::int32_t leaf, const RayPacket& rays, const Lanes& t, FacePacket& faces);
    void show_leaf(const Leaf& leaf, std::int32_t solid, FacePacket& faces, std::span<FirstFace> first);
    void describe(const Leaf& leaf, const MaterialInstance& material, const FacePacket& faces, std::span<FirstFace> first);
    void meet_single_face(Wave& wave, int ray, std::span<FirstFace> first);
    void add_single_face(Wave& wave, int ray, const Encounter& encounter);
    void add_single_face_at_change(Wave& wave, int ray, double t, const Encounter& encounter);
    std::int32_t frame_of(std::int32_t leaf, std::int32_t face) const;
    void place_faces(std::int32_t leaf, std::int32_t face, const RayPacket& rays, const Lanes& t, FacePacket& faces);
    void place_own_faces(const Leaf& leaf, const RayPacket& rays, const Lanes& t, const PlacedLines& placed,
                         const SpanBatch& spans, FacePacket& faces);
    void place_shared_faces(const Leaf& leaf, std::int32_t face, const RayPacket& rays, const Lanes& t, const PlacedLines& placed,
                            FacePacket& faces);
    static void place_points(const Transform& placement, const PointBatch& local, FacePacket& faces);
    void turn_normals(const Transform& placement, const NormalBatch& normals, FacePacket& faces);
    static void round_points(FacePacket& faces);
    MatterSite site_of(const FacePacket& faces, int lane) const;
    void give_matter(const MaterialInstance& material, FacePacket& faces);
    void light_faces(std::size_t depth);
    void light_faces(FacePackets packets, bool are_close);
    void begin_light(FacePacket& faces);
    void pass_over(const Light& light, FacePackets packets);
    static LightSampleBatch light_samples(FacePacket& faces);
    void aim(const Light& light, FacePacket& faces, AimedLights& aimed);
    void send_shadow_rays(FacePacket& faces, const AimedLights& aimed);
    static void aim_shadow_rays(const FacePacket& faces, const AimedLights& aimed, AimedShadows& shadows);
    static Bounds bounds_of(FacePackets packets);
    bool are_clear(const FacePacket& faces, const AimedLights& aimed) const;
    PacketThroughWorld::Shadows find_shadows(const RayPacket& rays, const Lanes& distances);
    static void light_faces_of(const AimedLights& aimed, unsigned lanes, FacePacket& faces);
    void cast_waiting_shadows();
    static void light_face(const Shadows& shadows, int ray, const Colour& passed);
    void finish_colours(std::size_t depth);
    static void show_colours(const FacePacket& faces, ColourLanes& shown);
    static void turn_mirrored_out(FacePacket& faces);
    void mirror_rays(FacePacket& faces, Wave& wave, Wave& next);
    FacePacket& new_faces();

    // Through transparent matter.
    void trace_wave_through_matter(std::size_t depth, std::span<FirstFace> first);
    void trace_portion(std::size_t depth, std::span<FirstFace> first);
    void find_meeting(const ChangePacket& changes, int lane, Meetings& meetings) const;
    void find_meetings(const ChangePacket& changes, Meetings& meetings) const;
    void check_first_cells(const RayPacket& rays, const Lanes& from, const Meetings& meetings, unsigned lanes);
    void go_to_changes(std::size_t depth, int packet, std::span<FirstFace> first);
    void meet_unusual(Wave& wave, Wave& next, int ray, std::span<FirstFace> first);
    bool pass_matter(Wave& wave, int ray, std::span<FirstFace> first);
    bool march(Wave& wave, int ray, const MaterialInstance& medium, std::span<FirstFace> first);
    void trace_alone(Wave& wave, int ray, std::span<FirstFace> first);
    void meet_one_face(Wave& wave, int packet, std::span<FirstFace> first);
    void gather_faces_at_changes(Wave& wave, std::span<FirstFace> first);
    void gather_face(Wave& wave, int packet, std::span<FirstFace> first);
    void show_faces_at_changes(const Wave& wave, const RayPacket& rays, const Lanes& t, FacePacket& faces,
                               std::span<FirstFace> first);
    void note_rays_at_changes(const Wave& wave, std::int32_t leaf, const RayPacket& rays, const Lanes& t, FacePacket& faces);
    void meet_single_face_at_change(Wave& wave, int ray, std::span<FirstFace> first);
    double index_beside(const FacePacket& faces, int lane, std::int32_t solid, Side side) const;
    void find_indices(std::int32_t shown, const Wave& wave, FacePacket& faces) const;
    void divide_light(Wave& wave, Wave& next, FacePacket& faces);
    void refract_rays(Wave& wave, Wave& next, const FacePacket& faces, const Lanes& weights, unsigned lanes);
    void go_on(Wave& wave, Wave& next, int ray, double from, std::span<FirstFace> first);
    void send(Wave& wave, Wave& next, const FacePacket& faces, const VectorLanes& directions, const Lanes& weights,
              unsigned lanes, Tracer::Implementation::Turn turn);
    void cast_dimmed_shadows();
    bool dim(int lane, const ChangePacket& changes, double from, Colour& passed);
    Label label_of(std::int32_t solid) const;
    Boundary boundary_of(const ChangePacket& changes, int lane) const;

    Tracer::Implementation& tracer_;
    const World& world_;
    PacketThroughWorld packet_;
    std::size_t camera_packets_ = 0, camera_packets_before_ = 0;  // of all that are traced, and before the wave under way
    std::vector<std::unique_ptr<Wave>> waves_;                    // by depth
    std::vector<std::unique_ptr<FacePacket>> faces_;
    std::size_t face_packets_ = 0;  // in use
    FacePacket* single_faces_ = nullptr;
    ShaftThroughWorld to_light_;                   // of the light under way
    const SolidsInReach* before_light_ = nullptr;  // what may lie before it; null: anything
    AimedShadows aimed_shadows_;
    Shadows waiting_;  // for company
    Shadows dimmed_;   // that meet matter which may dim them
};

}  // namespace lapidary
