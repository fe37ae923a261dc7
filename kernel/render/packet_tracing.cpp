// SPDX-License-Identifier: MIT
//
// Paths in an opaque World, many at a time: first all faces, then light by light all shadow rays, then all mirrored rays, each
// in packets. Colours are put together in the order of the single path.
#include <algorithm>
#include <array>
#include <vector>

#include "kernel/render/optics.h"
#include "kernel/render/tracer_implementation.h"

namespace lapidary {

namespace {

constexpr std::size_t width = PacketThroughWorld::width;

}  // namespace

void Tracer::Implementation::light_packets(std::span<const Ray> rays, std::span<const Path> paths,
                                           std::span<const std::optional<Encounter>> encounters, std::span<Lit> lit) {
    // A path takes as many samples of lights with extent at every face.
    const auto extended = static_cast<std::uint32_t>(
        std::count_if(world.lights.begin(), world.lights.end(), [](const auto& light) { return light->has_extent(); }));
    std::vector<Vector> mirrored(rays.size());
    std::vector<std::uint32_t> samples(rays.size());
    for (std::size_t i = 0; i < rays.size(); ++i) {
        if (!encounters[i]) continue;
        for (const auto& ambient : world.ambient_lights)
            lit[i].ambient += ambient->toward(encounters[i]->point.rounded(), {}).radiance;
        mirrored[i] = mirror(rays[i].direction, encounters[i]->shading);
        samples[i] = extended * static_cast<std::uint32_t>(paths[i].depth);
    }

    struct Shadow {
        std::size_t index;
        AimedLight light;
    };
    std::array<Shadow, width> shadows;
    RayPacket shadow_rays;
    Lanes distances;
    const auto cast = [&] {
        const int waiting = shadow_rays.count;
        if (waiting == 0) return;
        statistics.shadow_rays += static_cast<std::uint64_t>(waiting);
        shadow_rays.fill_up();
        const unsigned blocked = packet->blocked(shadow_rays, distances);
        for (int k = 0; k < waiting; ++k) {
            const AimedLight& light = shadows[static_cast<std::size_t>(k)].light;
            const Colour arrives = light.illumination.radiance * (blocked & (1u << k) ? Colour::black() : Colour::white());
            lit[shadows[static_cast<std::size_t>(k)].index].diffuse += light.diffuse * arrives;
            lit[shadows[static_cast<std::size_t>(k)].index].highlight += light.highlight * arrives;
        }
        shadow_rays.clear();
    };
    for (const auto& light : world.lights) {
        for (std::size_t i = 0; i < rays.size(); ++i) {
            if (!encounters[i]) continue;
            const std::optional<AimedLight> aimed = aim(*light, rays[i], *encounters[i], mirrored[i], samples[i]);
            if (!aimed) continue;
            shadows[static_cast<std::size_t>(shadow_rays.count)] = {i, *aimed};
            distances[shadow_rays.count] = aimed->illumination.distance;
            shadow_rays.add(depart(rays[i], *encounters[i], aimed->illumination.direction));
            if (shadow_rays.is_full()) cast();
        }
        cast();
    }
}

void Tracer::Implementation::radiances(std::span<const Ray> rays, std::span<const Path> paths, std::span<Colour> colours,
                                       std::span<RaySample> first) {
    std::vector<std::optional<Encounter>> encounters(rays.size());
    std::vector<bool> meets(rays.size());
    for (std::size_t begin = 0; begin < rays.size(); begin += width) {
        const std::size_t count = std::min(width, rays.size() - begin);
        RayPacket rays_in_lanes;
        for (const Ray& ray : rays.subspan(begin, count)) rays_in_lanes.add(ray);
        rays_in_lanes.fill_up();
        BoundaryPacket boundaries;
        packet->first_boundaries(rays_in_lanes, boundaries);
        for (std::size_t k = 0; k < count; ++k) {
            Boundary boundary;
            boundary.t = boundaries.t[static_cast<int>(k)], boundary.solid = boundaries.solid[k],
            boundary.leaf = boundaries.leaf[k];
            if (boundary.t == infinity) continue;
            const std::size_t i = begin + k;
            meets[i] = true;
            ray_through_world.start(rays[i]);
            if (!boundary.is_sheet()) ray_through_world.complete_opaque(boundary);
            encounters[i] = encounter_face(rays[i], boundary, paths[i].travelled, first.empty() ? nullptr : &first[i]);
        }
    }
    std::vector<Lit> lit(rays.size());
    light_packets(rays, paths, encounters, lit);

    std::vector<Ray> mirrored_rays;
    std::vector<Path> mirrored_paths;
    std::vector<std::size_t> mirrored_from;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        if (!encounters[i]) {
            // A boundary without a face is one that rounding undid: the single path knows how to go on.
            colours[i] = meets[i] ? radiance(rays[i], paths[i], first.empty() ? nullptr : &first[i]) : world.background;
            continue;
        }
        const Encounter& e = *encounters[i];
        const Colour local = e.matter.colour * (lit[i].ambient + lit[i].diffuse) + lit[i].highlight;
        const double reflection = e.matter.reflection;
        colours[i] = (1 - reflection) * local;
        if (!(reflection > 0)) continue;
        ++statistics.mirrored_rays;
        const Path next{paths[i].weight * reflection, paths[i].depth + 1, e.travelled, 2 * paths[i].branch};
        if (next.ends(settings)) {
            colours[i] += reflection * world.background;
            continue;
        }
        mirrored_rays.push_back(depart(rays[i], e, mirrored_direction(rays[i], e)));
        mirrored_paths.push_back(next);
        mirrored_from.push_back(i);
    }
    if (mirrored_rays.empty() || is_stopped()) return;
    std::vector<Colour> seen(mirrored_rays.size());
    radiances(mirrored_rays, mirrored_paths, seen, {});
    for (std::size_t k = 0; k < seen.size(); ++k)
        colours[mirrored_from[k]] += encounters[mirrored_from[k]]->matter.reflection * seen[k];
}

}  // namespace lapidary
