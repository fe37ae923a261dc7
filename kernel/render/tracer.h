// SPDX-License-Identifier: MIT
//
// What a ray returns. With N the unit normal toward the viewer, V toward the viewer, L toward a light, R its mirror image about
// N, E the light that arrives and m the matter's colour,
//
//     S = max(0, R . V)^shininess      D = max(0, N . L - S)      local = sum of m E (ambient) and of m E D + E S (the others)
//
// An opaque face returns (1 - k) local + k mirrored, k its reflection. A transparent one, with F the Fresnel reflectance and a
// the opacity, returns (1 - k) (a local + (1 - a) (sum of E S + F mirrored + (1 - F) refracted)) + k mirrored.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>

#include "kernel/export.h"
#include "kernel/math/colour.h"
#include "kernel/render/ray.h"

namespace lapidary {

struct Beam;
class World;
struct RayPacket;
struct RenderSettings;

// What a camera ray meets first, for the layers beside the colour.
struct FirstFace {
    double depth = infinity;  // distance to the first face
    Normal normal;            // unit shading normal toward the viewer; zero where nothing is met
    Point position;
    std::int32_t object = 0;    // from 1; 0: nothing
    std::int32_t material = 0;  // from 1; 0: nothing
};

// All that a camera ray brings back.
struct RaySample : FirstFace {
    Colour colour;
};

// What tracing cost and what it skipped; one per thread, added up at the end.
struct TraceStatistics {
    std::uint64_t camera_rays = 0, mirrored_rays = 0, refracted_rays = 0, shadow_rays = 0;
    std::uint64_t camera_rays_skipped = 0;       // in parts of the picture where nothing is in reach
    std::uint64_t shadow_rays_spared = 0;        // nothing is in reach on their way: not sent either
    std::uint64_t shadow_rays_skipped = 0;       // lights that send nothing to the point
    std::uint64_t object_tests = 0;              // calls of Object::spans (a batch counts its lanes)
    std::uint64_t slivers_removed = 0;           // cells of rounding length between different surfaces (rule S)
    std::uint64_t non_finite_samples = 0;        // dropped
    std::uint64_t first_cell_disagreements = 0;  // rays that began in another cell than the face before them said
    std::uint64_t march_steps = 0;               // boundaries met inside textured transparent matter
    std::uint64_t octaves_faded = 0;             // of noise, too fine to be seen

    LAPIDARY_API TraceStatistics& operator+=(const TraceStatistics& other);
};

// A face that a path met, for those who want to see how a colour came about.
struct PathEvent {
    // The way that led here: 1 is the camera ray; a mirrored ray appends a bit 0, a refracted one a bit 1.
    std::uint64_t branch = 1;
    double weight = 1;     // of the path in the pixel, up to here
    double travelled = 0;  // length of the path up to here
    TwoPartPoint point;
    Vector direction;  // of the ray that arrived
    Normal normal;     // unit, toward the viewer, not bent by relief
    double index_before = 1, index_behind = 1;
    Colour transmittance;  // of the media on the last stretch
};

// One per thread: it owns scratch memory. Results do not depend on which tracer traces a ray or on what it traced before.
class LAPIDARY_API Tracer {
public:
    // `pixel_footprint`: the angle that a pixel subtends, for textures that fade what is smaller than a pixel.
    Tracer(const World& world, const RenderSettings& settings, double pixel_footprint);
    ~Tracer();
    Tracer(const Tracer&) = delete;
    Tracer& operator=(const Tracer&) = delete;

    // Traces rays independently of one another; samples.size() == rays.size().
    void trace(std::span<const Ray> rays, std::span<RaySample> samples);
    // The same for packets of which all but the last are full. `faces` is empty where only colours are wanted, else as long.
    void trace(std::span<const RayPacket> rays, std::span<Colour> colours, std::span<FirstFace> faces);

    // The camera rays to come lie within a tile's beam; null: anywhere.
    void begin_tile(const Beam* beam);
    // Of these, the next within a part of it. The colour that all of them bring back from nowhere, where it is known that they
    // meet nothing: they need not be traced.
    // `in_quarters`: each quarter of the packets holds rays of one of the part's: left before right, top before bottom.
    std::optional<Colour> begin_part(const Beam* beam, bool in_quarters);

    // Keeps to one ray at a time where packets would be used: the oracle that packets are tested against.
    void trace_one_by_one(bool one_by_one);

    // Once the flag is set, paths end wherever they are: what trace() returns from then on is good for nothing. A single path
    // between mirrors in glass may take many milliseconds.
    void stop_when(const std::atomic<bool>* flag);

    const TraceStatistics& statistics() const;

    // Is told of every face that a path meets, in the order of a depth-first walk. Changes no result.
    void observe(std::function<void(const PathEvent&)> observer);

private:
    friend class PacketPaths;
    struct Implementation;
    std::unique_ptr<Implementation> implementation_;
};

}  // namespace lapidary
