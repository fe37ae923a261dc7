// SPDX-License-Identifier: MIT
//
// The inside of a Tracer: one path at a time (tracer.cpp), and packets of paths (packet_paths.h). Both do the same arithmetic in
// the same order; the single path is the oracle of the packets.
#pragma once

#include <atomic>
#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>

#include "kernel/csg/beam_through_world.h"
#include "kernel/csg/ray_through_world.h"
#include "kernel/interfaces/light.h"
#include "kernel/prepare/world.h"
#include "kernel/render/medium.h"
#include "kernel/render/optics.h"
#include "kernel/render/tracer.h"
#include "kernel/scene/scene.h"

namespace lapidary {

// A path on its way: how much it counts in the pixel, how many faces have turned it, how far it has come.
struct Path {
    double weight = 1;
    int depth = 0;
    double travelled = 0;
    std::uint64_t branch = 1;  // as in PathEvent
    std::uint32_t faces = 0;   // lit so far along it

    bool ends(const RenderSettings& settings) const { return depth > settings.depth || weight < settings.cutoff; }
};

// A place where the ray meets a face of a solid or a boundary within matter, with all that shading asks.
struct Encounter {
    TwoPartPoint point;
    Normal geometric;  // unit, toward the viewer
    Normal shading;    // the same, bent by the relief
    Matter matter;     // of the surface
    double index_before = 1, index_behind = 1;
    bool is_sheet = false;
    double travelled = 0;  // by the path, up to here

    // What rays that start here depart from, and the cells on the viewer's side and behind; `outward` is the leaf's normal.
    Departure departure;
    std::int32_t cell_before = Departure::unknown_cell, cell_behind = Departure::unknown_cell;
    Normal outward;
};

// Behind a face and on along the ray: where it meets an edge between regions of a texture, matter is that of the region which it
// goes on in.
inline Vector ahead(const Vector& arriving, const Normal& geometric) { return arriving - to_vector(geometric); }

// Where a shadow ray ends: as far before the light as makes sure that a face which the light stands on does not block it,
// whatever rounding does, while the cosine between ray and face normal is above 1/1000. Of a light at infinity: nowhere.
inline double end_before_light(const Point& from, double distance) {
    const double size = largest_magnitude(from);
    const double before = distance - 4096 * 0x1p-53 * (distance + size);
    return distance < infinity ? before : distance;
}

// A light as it falls on an encounter, before shadow.
struct AimedLight {
    Illumination illumination;
    double diffuse = 0, highlight = 0;  // D and S, as tracer.cpp has them
};

// What lights send to an encounter: the ambient light, and the sums of E D and of E S over the others.
struct Lit {
    Colour ambient, diffuse, highlight;
};

class PacketPaths;

struct Tracer::Implementation {
    Implementation(const World& w, const RenderSettings& s, double footprint);
    ~Implementation();

    const World& world;
    const RenderSettings& settings;
    double pixel_footprint;
    TraceStatistics statistics;
    RayThroughWorld ray_through_world, shadow_through_world;
    BeamThroughWorld beam;  // of the camera rays
    std::unique_ptr<PacketPaths> packets;
    bool one_by_one = false;
    std::function<void(const PathEvent&)> observer;
    const std::atomic<bool>* stop = nullptr;
    std::uint32_t extended_lights = 0;

    bool is_stopped() const { return stop && stop->load(std::memory_order_relaxed); }

    void trace_rays(std::span<const RayPacket> rays, std::span<Colour> colours, std::span<FirstFace> faces);
    Colour radiance(const Ray& ray, const Path& path, FirstFace* first);
    Colour shade(const Ray& ray, const Encounter& encounter, const Path& path);
    enum class Turn : std::uint8_t { mirrored, refracted };
    Colour continue_path(const Ray& from, const Encounter& encounter, const Vector& direction, double weight, const Path& path,
                         Turn turn);

    void tell_observer(const Ray& ray, const Encounter& encounter, const Path& path, const Colour& passed) const;

    std::optional<Encounter> encounter_face(const Ray& ray, const Boundary& boundary, double travelled, FirstFace* first);
    std::optional<Encounter> encounter_crossing(const Ray& ray, const MaterialInstance& medium, const Crossing& crossing,
                                                double travelled);
    static Normal bent_normal(const Vector& arriving, const Normal& geometric, const MaterialInstance& instance,
                              const Vector& relief);
    // Off a bent normal the mirrored ray may point into the surface: it is turned back out.
    static Vector turned_out(const Vector& mirrored, const Normal& geometric) {
        const double below = dot(mirrored, geometric);
        return below < 0 ? renormalize(mirrored - 2 * below * to_vector(geometric)) : mirrored;
    }
    // A direction that a bent normal would turn back to the viewer's side is refracted at the true one.
    static Refraction refracted(const Vector& arriving, const Normal& shading, const Normal& geometric, double eta) {
        const Refraction refraction = eta == 1 ? Refraction{arriving} : refract(arriving, shading, eta);
        const bool turned_back = !refraction.is_total && dot(refraction.direction, geometric) >= 0;
        return turned_back ? refract(arriving, geometric, eta) : refraction;
    }
    double index_of(const Label& label, const MatterSite& site, const Vector& toward, const Matter* known) const;
    Lit light(const Ray& ray, const Encounter& encounter, const Path& path);
    // What a light would add to an encounter if nothing stood between; nothing where that is nothing.
    std::optional<AimedLight> aim(const Light& light, const Ray& ray, const Encounter& encounter, const Vector& mirrored,
                                  std::uint32_t& samples);
    Vector mirrored_direction(const Ray& ray, const Encounter& encounter) const;
    std::int32_t shown_at(const Boundary& boundary) const;
    Colour medium_lets_through(const MaterialInstance& medium, const Ray& ray, double from, double to) const;
    double face_lets_through(const Boundary& boundary, const Ray& ray) const;
    Colour light_through(const Ray& shadow, double distance);
    void check_first_cell(const Departure& departure, std::int32_t owner);
    Ray depart(const Ray& from, const Encounter& encounter, const Vector& direction) const;
};

}  // namespace lapidary
