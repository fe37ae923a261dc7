// SPDX-License-Identifier: MIT
#include "kernel/render/tracer.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "kernel/render/optics.h"
#include "kernel/render/packet_paths.h"
#include "kernel/render/sampler.h"
#include "kernel/render/tracer_implementation.h"

namespace lapidary {

TraceStatistics& TraceStatistics::operator+=(const TraceStatistics& o) {
    camera_rays += o.camera_rays, mirrored_rays += o.mirrored_rays, refracted_rays += o.refracted_rays;
    camera_rays_skipped += o.camera_rays_skipped;
    shadow_rays += o.shadow_rays, shadow_rays_spared += o.shadow_rays_spared;
    shadow_rays_skipped += o.shadow_rays_skipped, object_tests += o.object_tests;
    non_finite_samples += o.non_finite_samples, first_cell_disagreements += o.first_cell_disagreements;
    march_steps += o.march_steps, slivers_removed += o.slivers_removed, octaves_faded += o.octaves_faded;
    return *this;
}

namespace {

// A face that neither bends, mirrors nor covers what is behind it.
bool lets_pass(const Encounter& e) {
    return e.matter.is_transparent() && e.index_before == e.index_behind && e.matter.opacity == 0 && e.matter.reflection == 0;
}

}  // namespace

// The index of a side of a face: of the medium just off the point, 1 in empty space.
double Tracer::Implementation::index_of(const Label& label, const MatterSite& site, const Vector& toward,
                                        const Matter* known) const {
    if (label.is_empty()) return 1;
    const Matter matter = known ? *known : matter_beside(world.materials[label.medium], site, toward);
    return matter.is_transparent() ? matter.refraction : 1;
}

// n - (relief - (relief . n) n), normalised; a normal that would face away from the viewer is bent back to the horizon.
Normal Tracer::Implementation::bent_normal(const Vector& arriving, const Normal& geometric, const MaterialInstance& instance,
                                           const Vector& relief) {
    if (relief == Vector{}) return geometric;
    const Vector n = to_vector(geometric), g = to_vector(instance.placement().to_parent(Normal(relief)));
    Vector bent = normalize(n - (g - dot(g, n) * n));
    const double away = dot(bent, arriving);
    if (away > 0) bent = normalize(bent - away * arriving);
    return length_squared(bent) > 0 ? Normal(bent) : geometric;
}

// The material that a boundary shows: its leaf's own, else the innards, those of the solid side.
std::int32_t Tracer::Implementation::shown_at(const Boundary& boundary) const {
    const std::int32_t own = world.leaves[boundary.leaf].appearance;
    if (own >= 0) return own;
    return !boundary.after.is_empty() ? boundary.after.medium : boundary.before.medium;
}

// What the ray meets at a boundary of the World: the matter of the face, and the media on its two sides.
// Nothing where the boundary shows no face (a tie that rounding undid).
std::optional<Encounter> Tracer::Implementation::encounter_face(const Ray& ray, const Boundary& boundary, double travelled,
                                                                FirstFace* first) {
    if (boundary.leaf < 0) return std::nullopt;
    const Leaf& leaf = world.leaves[boundary.leaf];
    const FaceHit face = ray_through_world.face(boundary);

    Encounter e;
    e.point = face.point;
    e.outward = face.normal;
    e.geometric = dot(face.normal, ray.direction) > 0 ? -face.normal : face.normal;
    e.shading = e.geometric;
    e.is_sheet = boundary.is_sheet();
    e.travelled = travelled + boundary.t;
    e.departure.leaf = boundary.leaf;
    e.departure.surface_class = face.surface_class;
    e.cell_before = world.features.transparency ? boundary.before.owner
                    : boundary.starts_inside    ? Departure::unknown_cell
                                                : Departure::no_cell;
    if (world.features.transparency) e.cell_behind = boundary.after.owner;
    if (face.class_flipped) e.outward = -face.normal;  // of a shared surface, sides are those of its representative

    // The face shows its own material, else the innards; matter is sampled on its solid side.
    const MatterSite site{e.point, pixel_footprint * e.travelled};
    const Vector beyond = ahead(ray.direction, e.geometric);
    std::int32_t shown = shown_at(boundary);
    if (shown < 0) return std::nullopt;
    // A sheet has no inside: it is sampled behind its normal, whichever side is looked at.
    bool solid_beyond = dot(face.normal, ray.direction) < 0;
    if (!e.is_sheet && world.features.transparency)
        solid_beyond = !boundary.after.is_empty();
    else if (!e.is_sheet && !world.materials[shown].is_uniform())
        solid_beyond = ray_through_world.enters(boundary);
    e.matter = matter_beside(world.materials[shown], site, solid_beyond ? beyond : -beyond);

    if (world.features.transparency) {
        // Opaque matter behind a transparent face that coincides with it is what is seen.
        if (e.matter.is_transparent() && !boundary.after.is_empty() && boundary.after.medium != shown) {
            const Matter behind = matter_beside(world.materials[boundary.after.medium], site, beyond);
            if (!behind.is_transparent()) e.matter = behind, shown = boundary.after.medium;
        }
        if (e.matter.is_transparent()) {
            const bool known_behind = solid_beyond && boundary.after.medium == shown;
            e.index_behind = index_of(boundary.after, site, beyond, known_behind ? &e.matter : nullptr);
            e.index_before = index_of(boundary.before, site, -beyond, nullptr);
        }
    }
    if (world.features.relief) e.shading = bent_normal(ray.direction, e.geometric, world.materials[shown], e.matter.relief);
    if (first && first->object == 0) {
        first->depth = e.travelled;
        first->normal = e.shading;
        first->position = e.point.rounded();
        first->object = leaf.number;
        first->material = world.materials[shown].number;
    }
    return e;
}

// What the ray meets where a textured medium changes: the same as at a face, with the boundary's own normal.
std::optional<Encounter> Tracer::Implementation::encounter_crossing(const Ray& ray, const MaterialInstance& medium,
                                                                    const Crossing& crossing, double travelled) {
    ++statistics.march_steps;
    Encounter e;
    e.point = crossing_point(medium, ray.origin, ray.direction, crossing.t);
    e.outward = normalize(medium.placement().to_parent(crossing.normal));
    if (e.outward == Normal()) return std::nullopt;
    e.geometric = dot(e.outward, ray.direction) > 0 ? -e.outward : e.outward;
    e.shading = e.geometric;
    e.travelled = travelled + crossing.t;

    const MatterSite site{e.point, pixel_footprint * e.travelled};
    const Vector beyond = ahead(ray.direction, e.geometric);
    e.matter = matter_beside(medium, site, beyond);
    if (e.matter.is_transparent()) {
        const Matter before = matter_beside(medium, site, -beyond);
        e.index_before = before.is_transparent() ? before.refraction : 1;
        e.index_behind = e.matter.refraction;
    }
    if (world.features.relief) e.shading = bent_normal(ray.direction, e.geometric, medium, e.matter.relief);
    return e;
}

// A ray from an encounter. Which side of the departed surface it goes to is read from the true normal.
Ray Tracer::Implementation::depart(const Ray& from, const Encounter& e, const Vector& direction) const {
    Ray ray{e.point, direction, e.departure, from.key};
    ray.departure.inward = dot(direction, e.outward) < 0;
    ray.departure.cell = dot(direction, e.geometric) > 0 ? e.cell_before : e.cell_behind;
    return ray;
}

void Tracer::Implementation::check_first_cell(const Departure& departure, std::int32_t owner) {
    const std::int32_t expected = departure.cell;
    if (expected != Departure::unknown_cell && expected != owner) ++statistics.first_cell_disagreements;
}

// What a medium lets through of a straight ray between two of its places. Of textured matter, piece by piece: each may be
// opaque, and each boundary between has its (1 - opacity).
Colour Tracer::Implementation::medium_lets_through(const MaterialInstance& medium, const Ray& ray, double from, double to) const {
    if (!medium.may_be_transparent) return Colour::black();
    const MaterialLine line = material_line(medium, ray.origin, ray.direction);
    if (medium.is_uniform() || !medium.material().has_boundaries()) return transmittance(medium, line, from, to);
    Colour passed = Colour::white();
    for (double piece = from; piece < to && !is_black(passed);) {
        const double end = std::min(next_crossing(medium.material(), line, piece, to).t, to);
        constexpr double far_enough = 1e6;  // a place inside of a piece without end
        const Matter matter = medium.material().evaluate({line.at(0.5 * piece + 0.5 * std::min(end, piece + far_enough)), 0});
        if (!matter.is_transparent()) return Colour::black();
        if (piece > from) passed = (1 - matter.opacity) * passed;
        passed = passed * transmittance(medium, line, piece, end);
        piece = end;
    }
    return passed;
}

// The part of a straight ray that a face lets through: nothing where it is opaque.
double Tracer::Implementation::face_lets_through(const Boundary& boundary, const Ray& ray) const {
    if (boundary.is_sheet()) return 0;
    const std::int32_t shown = shown_at(boundary);
    if (shown < 0) return 1;
    const Vector toward = (boundary.after.is_empty() ? -1.0 : 1.0) * ray.direction;
    const MatterSite site{{ray.origin.anchor, ray.origin.offset + boundary.t * ray.direction}, 0};
    const Matter matter = matter_beside(world.materials[shown], site, toward);
    return matter.is_transparent() ? 1 - matter.opacity : 0;
}

// What of a light's radiance arrives over a distance: in an opaque World all or nothing; else the product of what all media and
// all faces on the straight way let through.
Colour Tracer::Implementation::light_through(const Ray& shadow, double distance) {
    ++statistics.shadow_rays;
    RayThroughWorld& through = shadow_through_world;
    through.start(shadow);
    const double end = end_before_light(shadow.origin.rounded(), distance);
    if (!world.features.transparency) return through.is_blocked(end) ? Colour::black() : Colour::white();

    Colour passed = Colour::white();
    Label label = through.label(0, Side::after);
    check_first_cell(shadow.departure, label.owner);
    for (double from = 0; !is_black(passed) && !is_stopped();) {
        const Boundary boundary = through.next(from, label);
        if (!label.is_empty())
            passed = passed * medium_lets_through(world.materials[label.medium], shadow, from, std::min(boundary.t, distance));
        if (boundary.t >= end) break;
        const bool has_face = boundary.leaf >= 0 && (boundary.is_sheet() || !(boundary.before == boundary.after));
        if (has_face) passed = face_lets_through(boundary, shadow) * passed;
        label = boundary.after;
        from = boundary.t;
    }
    return passed;
}

std::optional<AimedLight> Tracer::Implementation::aim(const Light& light, const Ray& ray, const Encounter& e,
                                                      const Vector& mirrored, std::uint32_t& samples) {
    LightSample sample;
    if (light.has_extent()) {
        const SamplePair pair = sample_pair(ray.key, dimension_pair::first_light + samples++);
        sample = {pair.u, pair.v};
    }
    AimedLight aimed;
    aimed.illumination = light.toward(e.point.rounded(), sample);
    const Vector& direction = aimed.illumination.direction;
    const double cosine = dot(e.shading, direction);
    if (!is_black(aimed.illumination.radiance) && cosine > 0) {
        // (R . V)^shininess, with R . V = the light against the mirrored view.
        const bool needs_diffuse = !e.matter.is_transparent() || e.matter.opacity > 0;
        aimed.highlight = highlight(std::fmax(0, dot(mirrored, direction)), e.matter.shininess);
        aimed.diffuse = needs_diffuse ? std::fmax(0, cosine - aimed.highlight) : 0;
        // Light from behind an opaque face or a sheet is blocked by it.
        const bool behind = dot(e.geometric, direction) <= 0 && (e.is_sheet || !e.matter.is_transparent());
        if ((aimed.highlight > 0 || aimed.diffuse > 0) && !behind) return aimed;
    }
    ++statistics.shadow_rays_skipped;
    return std::nullopt;
}

// The sums over the lights: ambient, D and S parts.
Lit Tracer::Implementation::light(const Ray& ray, const Encounter& e, const Path& path) {
    Lit lit;
    for (const auto& ambient : world.ambient_lights) lit.ambient += ambient->toward(e.point.rounded(), {}).radiance;
    const Vector mirrored = mirror(ray.direction, e.shading);
    std::uint32_t light_samples = extended_lights * path.faces;
    for (const auto& light : world.lights) {
        const std::optional<AimedLight> aimed = aim(*light, ray, e, mirrored, light_samples);
        if (!aimed) continue;
        const Illumination& illumination = aimed->illumination;
        const Colour arrives =
            illumination.radiance * light_through(depart(ray, e, illumination.direction), illumination.distance);
        lit.diffuse += aimed->diffuse * arrives;
        lit.highlight += aimed->highlight * arrives;
    }
    return lit;
}

Vector Tracer::Implementation::mirrored_direction(const Ray& ray, const Encounter& e) const {
    return turned_out(mirror(ray.direction, e.shading), e.geometric);
}

// Follows a path from an encounter, or ends it with the background where it counts too little.
Colour Tracer::Implementation::continue_path(const Ray& from, const Encounter& e, const Vector& direction, double weight,
                                             const Path& path, Turn turn) {
    const Path next{path.weight * weight, path.depth + 1, e.travelled, 2 * path.branch + (turn == Turn::refracted),
                    path.faces + 1};
    if (next.ends(settings)) return world.background;
    return radiance(depart(from, e, direction), next, nullptr);
}

void Tracer::Implementation::tell_observer(const Ray& ray, const Encounter& e, const Path& path, const Colour& passed) const {
    observer(
        {path.branch, path.weight, e.travelled, e.point, ray.direction, e.geometric, e.index_before, e.index_behind, passed});
}

Colour Tracer::Implementation::shade(const Ray& ray, const Encounter& e, const Path& path) {
    const Matter& matter = e.matter;
    const Lit lit = light(ray, e, path);
    const Colour local = matter.colour * (lit.ambient + lit.diffuse) + lit.highlight;

    const bool transparent = matter.is_transparent();
    const double fresnel = transparent ? fresnel_reflectance(ray.direction, e.shading, e.index_before, e.index_behind) : 0;
    const double clear = transparent ? (1 - matter.reflection) * (1 - matter.opacity) : 0;  // what Fresnel divides
    const double mirrored_weight = matter.reflection + clear * fresnel;
    const double refracted_weight = clear * (1 - fresnel);

    Colour result = transparent ? (1 - matter.reflection) * (matter.opacity * local + (1 - matter.opacity) * lit.highlight)
                                : (1 - matter.reflection) * local;
    if (mirrored_weight > 0) {
        ++statistics.mirrored_rays;
        result += mirrored_weight * continue_path(ray, e, mirrored_direction(ray, e), mirrored_weight, path, Turn::mirrored);
    }
    if (refracted_weight > 0) {
        const Refraction refraction = refracted(ray.direction, e.shading, e.geometric, e.index_before / e.index_behind);
        ++statistics.refracted_rays;
        result += refracted_weight * (refraction.is_total
                                          ? world.background
                                          : continue_path(ray, e, refraction.direction, refracted_weight, path, Turn::refracted));
    }
    return result;
}

// Follows a straight ray through what lets it pass, to the first face that does not.
Colour Tracer::Implementation::radiance(const Ray& ray, const Path& path, FirstFace* first) {
    const bool transparency = world.features.transparency;
    ray_through_world.start(ray);
    Label label = transparency ? ray_through_world.label(0, Side::after) : Label{};
    if (transparency) check_first_cell(ray.departure, label.owner);
    Colour gathered, passed = Colour::white();
    Path here = path;
    for (double from = 0; !is_stopped();) {
        const Boundary boundary = ray_through_world.next(from, label);
        std::optional<Encounter> encounter;
        double to = boundary.t;

        const MaterialInstance* medium = label.is_empty() ? nullptr : &world.materials[label.medium];
        if (medium && medium->may_be_transparent) {
            const MaterialLine line = material_line(*medium, ray.origin, ray.direction);
            if (!medium->is_uniform() && medium->material().has_boundaries()) {
                const Crossing crossing = next_crossing(medium->material(), line, from, boundary.t);
                if (crossing.t < boundary.t) {
                    to = crossing.t;
                    encounter = encounter_crossing(ray, *medium, crossing, path.travelled);
                    if (encounter) encounter->cell_before = encounter->cell_behind = label.owner;
                }
            }
            passed = passed * transmittance(*medium, line, from, to);
        }
        if (is_black(passed)) return gathered;
        if (to == infinity) return gathered + passed * world.background;
        if (to == boundary.t) {
            label = boundary.after;
            if (boundary.is_sheet() || !transparency || !(boundary.before == boundary.after))
                encounter = encounter_face(ray, boundary, path.travelled, first);
            if (boundary.is_sheet()) label = boundary.before;
        }
        from = to;
        if (!encounter) continue;
        if (observer) tell_observer(ray, *encounter, path, passed);
        if (lets_pass(*encounter)) {
            gathered += passed * light(ray, *encounter, here).highlight;
            ++here.faces;
            continue;
        }
        here.weight *= largest(passed);
        return gathered + passed * shade(ray, *encounter, here);
    }
    return gathered;
}

Tracer::Implementation::Implementation(const World& w, const RenderSettings& s, double footprint)
    : world(w),
      settings(s),
      pixel_footprint(footprint),
      ray_through_world(w, statistics),
      shadow_through_world(w, statistics),
      beam(w) {
    for (const auto& light : world.lights) extended_lights += light->has_extent() ? 1 : 0;
    packets = std::make_unique<PacketPaths>(*this);
}
Tracer::Implementation::~Implementation() = default;

Tracer::Tracer(const World& world, const RenderSettings& settings, double pixel_footprint)
    : implementation_(std::make_unique<Implementation>(world, settings, pixel_footprint)) {}
Tracer::~Tracer() = default;

void Tracer::Implementation::trace_rays(std::span<const RayPacket> rays, std::span<Colour> colours, std::span<FirstFace> faces) {
    for (std::size_t i = 0; i < colours.size() && !is_stopped(); ++i) {
        const Ray ray = rays[i / batch_size].ray(static_cast<int>(i % batch_size));
        colours[i] = radiance(ray, Path{}, faces.empty() ? nullptr : &faces[i]);
    }
}

void Tracer::trace(std::span<const Ray> rays, std::span<RaySample> samples) {
    std::vector<RayPacket> packets((rays.size() + batch_size - 1) / batch_size);
    for (std::size_t i = 0; i < rays.size(); ++i) packets[i / batch_size].add(rays[i]);
    if (!packets.empty()) packets.back().fill_up();
    std::vector<Colour> colours(rays.size());
    std::vector<FirstFace> faces(rays.size());
    trace(packets, colours, faces);
    for (std::size_t i = 0; i < rays.size(); ++i) samples[i] = {faces[i], colours[i]};
}

void Tracer::trace(std::span<const RayPacket> rays, std::span<Colour> colours, std::span<FirstFace> faces) {
    Implementation& tracer = *implementation_;
    tracer.statistics.camera_rays += colours.size();
    std::fill(faces.begin(), faces.end(), FirstFace{});
    const std::uint64_t faded_before = octaves_faded_by_thread();
    if (!tracer.observer && !tracer.one_by_one)
        tracer.packets->trace(rays, colours, faces);
    else
        tracer.trace_rays(rays, colours, faces);
    tracer.statistics.octaves_faded += octaves_faded_by_thread() - faded_before;
}

void Tracer::begin_tile(const Beam* beam) { implementation_->beam.begin_tile(beam); }

std::optional<Colour> Tracer::begin_part(const Beam* beam, bool in_quarters) {
    Implementation& tracer = *implementation_;
    if (tracer.observer || tracer.one_by_one) return std::nullopt;
    tracer.beam.begin_part(beam, in_quarters);
    if (!tracer.beam.is_empty()) return std::nullopt;
    return tracer.world.background;
}

void Tracer::trace_one_by_one(bool one_by_one) { implementation_->one_by_one = one_by_one; }

void Tracer::observe(std::function<void(const PathEvent&)> observer) { implementation_->observer = std::move(observer); }

void Tracer::stop_when(const std::atomic<bool>* flag) { implementation_->stop = flag; }

const TraceStatistics& Tracer::statistics() const { return implementation_->statistics; }

}  // namespace lapidary
