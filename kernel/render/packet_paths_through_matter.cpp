// SPDX-License-Identifier: MIT
//
// Waves of rays through transparent matter. What is the same for all rays of a packet of faces is looked up once, as in opaque
// Worlds; in addition each ray knows the solids that own the cells before and behind its face, and at a transparent face light
// divides into a mirrored and a refracted ray, both of the next wave. Rays in textured matter march by themselves to where it
// changes.
//
// Whatever is unusual (rounding, several faces at one place, faces that let light pass as if they were not there) is left to the
// single path, from the start of the ray.
#include <algorithm>
#include <bit>
#include <span>

#include "kernel/csg/near_root.h"
#include "kernel/csg/placed_lines.h"
#include "kernel/render/packet_paths.h"

namespace lapidary {

void PacketPaths::trace_wave_through_matter(std::size_t depth, std::span<RaySample> first) {
    while (waves_.size() <= depth + 1) waves_.push_back(std::make_unique<Wave>(true));
    Wave& wave = *waves_[depth];
    if (depth > 0) wave.fill_up();
    if (depth >= most_waves) {
        for (int i = 0; i < wave.count && !tracer_.is_stopped(); ++i) trace_alone(wave, i, first);
        return;
    }
    for (wave.begin = 0; wave.begin < wave.count && !tracer_.is_stopped(); wave.begin += portion_size) {
        wave.end = std::min(wave.begin + portion_size, wave.count);
        trace_portion(depth, first);
    }
}

void PacketPaths::trace_portion(std::size_t depth, std::span<RaySample> first) {
    Wave &wave = *waves_[depth], &next = *waves_[depth + 1];
    find_changes(wave, in_reach_of(depth));
    face_packets_ = 0;
    next.clear();
    wave.contributions.clear();
    collect_faces_at_changes(wave, next, first);
    light_faces(depth);
    for (std::size_t p = 0; p < face_packets_; ++p) divide_light(wave, next, *faces_[p]);

    if (next.count > 0 && !tracer_.is_stopped()) trace_wave_through_matter(depth + 1, {});
    for (const Contribution& c : wave.contributions)
        wave.colours[c.to] += c.weight * (c.from < 0 ? world_.background : next.colours[c.from]);
    for (int i = wave.begin; i < wave.end; ++i) wave.colours[i] = wave.gathered[i] + wave.passed[i] * wave.colours[i];
}

void PacketPaths::find_changes(Wave& wave, const SolidsInReach* among) {
    const std::size_t begin = static_cast<std::size_t>(wave.begin) / width;
    const std::size_t packets = (static_cast<std::size_t>(wave.end - wave.begin) + width - 1) / width;
    for (std::size_t p = 0; p < packets; ++p)
        packet_.first_changes(wave.rays[begin + p], wave.stretches[begin + p], among, wave.changes[p]);
}

// ---- faces -----------------------------------------------------------------------------------------------------------

Label PacketPaths::label_of(std::int32_t solid) const { return solid < 0 ? Label{} : world_.insides[solid]; }

Boundary PacketPaths::boundary_of(const ChangePacket& changes, int lane) const {
    Boundary boundary;
    boundary.t = changes.first.t[lane], boundary.solid = changes.first.solid[lane], boundary.leaf = changes.first.leaf[lane];
    boundary.before = label_of(changes.before[lane]), boundary.after = label_of(changes.after[lane]);
    return boundary;
}

void PacketPaths::collect_faces_at_changes(Wave& wave, Wave& next, std::span<RaySample> first) {
    single_faces_ = nullptr;
    plain_.clear();
    for (int i = wave.begin; i < wave.end; ++i) {
        const Meeting meeting = go_to_change(wave, i, first);
        if (meeting == Meeting::no_face) go_on(wave, next, i, wave.change(i).first.t[i % width], first);
        if (meeting == Meeting::single_face) meet_single_face_at_change(wave, i, first);
        if (meeting == Meeting::plain_face) plain_.push_back(sorting_key(wave, i));
    }
    if (single_faces_) single_faces_->fill_up();

    std::sort(plain_.begin(), plain_.end());
    for (std::size_t begin = 0; begin < plain_.size();) {
        std::size_t end = begin + 1;
        while (end < plain_.size() && end < begin + width && is_same_face(wave, plain_[begin], plain_[end])) ++end;
        meet_plain_faces_at_changes(wave, std::span(plain_).subspan(begin, end - begin), first);
        begin = end;
    }
}

// Rays that meet the same face come to stand together.
std::uint64_t PacketPaths::sorting_key(const Wave& wave, int ray) const {
    const ChangePacket& changes = wave.change(ray);
    const auto leaf = static_cast<std::uint64_t>(changes.first.leaf[ray % width]);
    const auto face = static_cast<std::uint64_t>(changes.first.face[ray % width] + 1) & 0xff;
    const auto shown = static_cast<std::uint64_t>(shown_at_change(wave, ray)) & 0xffff;
    return leaf << 32 | face << 24 | shown << 8 | static_cast<std::uint64_t>(ray - wave.begin);
}

int PacketPaths::ray_of(const Wave& wave, std::uint64_t sorting_key) { return wave.begin + static_cast<int>(sorting_key & 0xff); }

bool PacketPaths::is_same_face(const Wave& wave, std::uint64_t key, std::uint64_t other) const {
    return key >> 8 == other >> 8 && shown_at_change(wave, ray_of(wave, key)) == shown_at_change(wave, ray_of(wave, other));
}

// Through the matter that a ray starts in, and what it meets at the end of it. Rays that are finished have their colours, to be
// multiplied by what has passed.
PacketPaths::Meeting PacketPaths::go_to_change(Wave& wave, int ray, std::span<RaySample> first) {
    const ChangePacket& changes = wave.change(ray);
    const int lane = ray % width;
    const double t = changes.first.t[lane];
    Colour& passed = wave.passed[ray];
    wave.colours[ray] = world_.background;
    if ((changes.unclear >> lane & 1) != 0) {
        trace_alone(wave, ray, first);
        return Meeting::nothing;
    }
    const double from = wave.from(ray);
    if (from == 0) tracer_.check_first_cell(wave.departure(ray), label_of(changes.before[lane]).owner);
    if (const std::int32_t owner = changes.before[lane]; owner >= 0) {
        const MaterialInstance& medium = world_.materials[world_.insides[owner].medium];
        if (!medium.is_uniform() && medium.may_be_transparent) {
            if (march(wave, ray, medium, first)) return Meeting::nothing;
        } else if (medium.may_be_transparent) {
            passed = passed * transmittance(medium, {}, from, t);
        }
    }
    if (is_black(passed) || t == infinity) return Meeting::nothing;
    if (is_plain_at_change(wave, ray)) return Meeting::plain_face;
    const bool is_sheet = changes.first.solid[lane] < 0;
    if (!is_sheet && changes.before[lane] == changes.after[lane]) return Meeting::no_face;
    if (changes.first.leaf[lane] >= 0) return Meeting::single_face;
    // A boundary without a leaf is one that rounding undid, or that several leaves share.
    trace_alone(wave, ray, first);
    return Meeting::nothing;
}

// To the next boundary within textured matter, and whether there is one, or nothing is left of light on the way.
bool PacketPaths::march(Wave& wave, int number, const MaterialInstance& medium, std::span<RaySample> first) {
    const Ray ray = wave.ray(number);
    const MaterialLine line = material_line(medium, ray.origin, ray.direction);
    const ChangePacket& changes = wave.change(number);
    const double from = wave.from(number), t = changes.first.t[number % width];
    Crossing crossing;
    if (medium.material().has_boundaries()) crossing = next_crossing(medium.material(), line, from, t);
    const double to = std::min(crossing.t, t);
    wave.passed[number] = wave.passed[number] * transmittance(medium, line, from, to);
    if (is_black(wave.passed[number])) return true;
    if (!(crossing.t < t)) return false;

    std::optional<Encounter> encounter = tracer_.encounter_crossing(ray, medium, crossing, wave.paths[number].travelled);
    if (!encounter) {
        trace_alone(wave, number, first);
        return true;
    }
    encounter->cell_before = encounter->cell_behind = world_.insides[changes.before[number % width]].owner;
    add_single_face_at_change(wave, number, crossing.t, *encounter);
    return true;
}

// By the single path, all of it.
void PacketPaths::trace_alone(Wave& wave, int ray, std::span<RaySample> first) {
    wave.gathered[ray] = Colour::black(), wave.passed[ray] = Colour::white();
    wave.colours[ray] =
        tracer_.radiance(wave.ray(ray), wave.paths[ray], first.empty() ? nullptr : &first[static_cast<std::size_t>(ray)]);
}

// Straight on from a place that shows no face, or one that lets all light pass, as a ray of the next wave. The layers of a camera
// ray that has not met anything yet are left to the single path.
void PacketPaths::go_on(Wave& wave, Wave& next, int ray, double from, std::span<RaySample> first) {
    if (!first.empty() && first[static_cast<std::size_t>(ray)].object == 0) {
        trace_alone(wave, ray, first);
        return;
    }
    wave.contributions.push_back({ray, next.count, 1});
    next.add_through_matter(wave.ray(ray), wave.paths[ray], from, wave.gathered[ray], wave.passed[ray], wave.lit[ray]);
    wave.colours[ray] = wave.gathered[ray] = Colour::black(), wave.passed[ray] = Colour::white();
}

void PacketPaths::Wave::begin_camera_rays() {
    for (PacketThroughWorld::Stretch& stretch : stretches) stretch.from.v.fill(0), stretch.limit.v.fill(infinity);
    std::fill_n(gathered.begin(), count, Colour::black());
    std::fill_n(passed.begin(), count, Colour::white());
    std::fill_n(lit.begin(), count, 0);
}

void PacketPaths::Wave::add_through_matter(const Ray& ray, const Path& path, double from, const Colour& gathered_before,
                                           const Colour& passed_before, std::uint32_t lit_before) {
    PacketThroughWorld::Stretch& stretch = stretches[static_cast<std::size_t>(count / width)];
    stretch.from[count % width] = from, stretch.limit[count % width] = infinity;
    gathered[count] = gathered_before, passed[count] = passed_before, lit[count] = lit_before;
    add(ray, path);
}

// Of a face with a leaf.
std::int32_t PacketPaths::shown_at_change(const Wave& wave, int ray) const {
    const ChangePacket& changes = wave.change(ray);
    const int lane = ray % width;
    const std::int32_t own = world_.leaves[changes.first.leaf[lane]].appearance;
    if (own >= 0) return own;
    return world_.insides[changes.after[lane] >= 0 ? changes.after[lane] : changes.before[lane]].medium;
}

// Whether all that a face shows can be had without asking the single ray: which leaf it is of is known, and of it which surface,
// and no opaque matter may lie right behind a transparent face.
bool PacketPaths::is_plain_at_change(const Wave& wave, int ray) const {
    const ChangePacket& changes = wave.change(ray);
    const int lane = ray % width;
    const std::int32_t leaf = changes.first.leaf[lane], after = changes.after[lane];
    if (leaf < 0 || changes.first.solid[lane] < 0 || changes.before[lane] == after) return false;
    if (world_.leaves[leaf].first_surface >= 0 && changes.first.face[lane] < 0) return false;
    const std::int32_t shown = shown_at_change(wave, ray);
    return after < 0 || world_.insides[after].medium == shown || !world_.materials[shown].may_be_transparent;
}

// Rays that meet the same face of a leaf.
void PacketPaths::meet_plain_faces_at_changes(Wave& wave, std::span<const std::uint64_t> run, std::span<RaySample> first) {
    const int leader = ray_of(wave, run.front());
    const ChangePacket& leading = wave.change(leader);
    const std::int32_t index = leading.first.leaf[leader % width], shown = shown_at_change(wave, leader);
    const Leaf& leaf = world_.leaves[index];
    FacePacket& faces = new_faces();
    RayPacket rays;
    Lanes t;
    for (const std::uint64_t key : run) {
        const int ray = ray_of(wave, key), lane = ray % width;
        const ChangePacket& changes = wave.change(ray);
        const int number = faces.count;
        t[number] = changes.first.t[lane];
        faces.departure.set(number, {index, -1, false, label_of(changes.before[lane]).owner});
        faces.cell_behind[number] = label_of(changes.after[lane]).owner;
        if (changes.after[lane] < 0) faces.leaving |= 1U << number;
        add_plain_face(wave, ray, faces, rays, t);
        faces.light_samples[number] += tracer_.extended_lights * wave.lit[ray];
        faces.t[number] = t[number];
    }
    rays.fill_up();
    for (int lane = faces.count; lane < width; ++lane) {
        t[lane] = t[0], faces.travelled[lane] = faces.travelled[0];
        faces.departure.set(lane, faces.departure[0]), faces.key[static_cast<std::size_t>(lane)] = faces.key[0];
    }
    faces.depart_alike = true;
    place_faces(leaf, leading.first.face[leader % width], rays, t, faces);
    give_matter_at_changes(shown, wave, faces);
    describe(leaf, world_.materials[shown], faces, first);
}

void PacketPaths::add_single_face_at_change(Wave& wave, int ray, double t, const Encounter& encounter) {
    add_single_face(wave, ray, encounter);
    const int lane = single_faces_->count - 1;
    single_faces_->light_samples[lane] += tracer_.extended_lights * wave.lit[ray];
    single_faces_->t[lane] = t;
}

void PacketPaths::meet_single_face_at_change(Wave& wave, int number, std::span<RaySample> first) {
    const Ray ray = wave.ray(number);
    tracer_.ray_through_world.start(ray);
    RaySample* sample = first.empty() ? nullptr : &first[static_cast<std::size_t>(number)];
    const std::optional<Encounter> encounter =
        tracer_.encounter_face(ray, boundary_of(wave.change(number), number % width), wave.paths[number].travelled, sample);
    if (encounter)
        add_single_face_at_change(wave, number, wave.change(number).first.t[number % width], *encounter);
    else
        trace_alone(wave, number, first);
}

// Of uniform matter at once.
double PacketPaths::index_of(std::int32_t solid, const MatterSite& site, const Vector& toward, const Matter* known) const {
    if (solid < 0) return 1;
    const MaterialInstance& medium = world_.materials[world_.insides[solid].medium];
    if (!medium.is_uniform()) return tracer_.index_of(label_of(solid), site, toward, known);
    return medium.finish->is_transparent() ? medium.finish->refraction : 1;
}

void PacketPaths::give_matter_at_changes(std::int32_t shown, const Wave& wave, FacePacket& faces) {
    const MaterialInstance& material = world_.materials[shown];
    for (int i = 0; i < faces.count; ++i) {
        const Vector arriving = faces.arriving[i];
        const Normal geometric(faces.geometric[i]);
        const MatterSite site{{to_point(faces.anchor[i]), faces.offset[i]}, tracer_.pixel_footprint * faces.travelled[i]};
        const Vector beyond = Tracer::Implementation::ahead(arriving, geometric);
        const bool leaving = (faces.leaving >> i & 1) != 0;
        const Matter matter = matter_beside(material, site, leaving ? -beyond : beyond);
        faces.colour.set(i, matter.colour);
        faces.reflection[i] = matter.reflection, faces.shininess[i] = matter.shininess;
        faces.opacity[i] = matter.opacity;
        if (matter.is_transparent()) {
            const ChangePacket& changes = wave.change(faces.ray[i]);
            const int lane = faces.ray[i] % width;
            faces.transparent |= 1U << i;
            const bool known_behind = !leaving && world_.insides[changes.after[lane]].medium == shown;
            faces.index_behind[i] = index_of(changes.after[lane], site, beyond, known_behind ? &matter : nullptr);
            faces.index_before[i] = index_of(changes.before[lane], site, -beyond, nullptr);
        }
        if (world_.features.relief)
            faces.shading.set(i, Tracer::Implementation::bent_normal(arriving, geometric, material, matter));
    }
    for (int i = faces.count; i < width; ++i) {
        faces.colour.set(i, faces.colour[0]);
        faces.reflection[i] = faces.reflection[0], faces.shininess[i] = faces.shininess[0];
    }
}

// ---- shadows in colours ----------------------------------------------------------------------------------------------

// Tracer::Implementation::light_through for all lanes, from change to change.
void PacketPaths::cast_dimmed_shadows() {
    if (dimmed_.rays.count == 0) return;
    const unsigned all = dimmed_.rays.lanes();
    PacketThroughWorld::Stretch stretch;
    ChangePacket changes;
    std::array<Colour, width> passed;
    passed.fill(Colour::white());
    dimmed_.rays.fill_up();
    stretch.from.v.fill(0), stretch.limit.v.fill(-1);
    for (int lane = 0; lane < dimmed_.rays.count; ++lane) stretch.limit[lane] = dimmed_.to_light[lane];

    for (unsigned under_way = all; under_way != 0;) {
        packet_.first_changes(dimmed_.rays, stretch, before_light_, changes);
        for (unsigned rest = under_way; rest != 0; rest &= rest - 1) {
            const int lane = std::countr_zero(rest);
            const bool goes_on = dim(lane, changes, stretch.from[lane], passed[lane]);
            stretch.from[lane] = changes.first.t[lane];
            if (goes_on) continue;
            stretch.limit[lane] = -1;
            under_way &= ~(1U << lane);
        }
    }
    for (int lane = 0; lane < dimmed_.rays.count; ++lane) light_face(dimmed_, lane, passed[lane]);
    dimmed_.rays.clear();
}

// What the matter up to the next change, and the face there, leave of the light. Whether the way goes on behind it.
bool PacketPaths::dim(int lane, const ChangePacket& changes, double from, Colour& passed) {
    const RayPacket& rays = dimmed_.rays;
    const double to_light = dimmed_.to_light[lane];
    const Boundary boundary = boundary_of(changes, lane);
    const bool changes_here = !(boundary.before == boundary.after);
    const bool at_light = boundary.t >= dimmed_.distances[lane];
    if ((changes.unclear >> lane & 1) != 0 || (!at_light && changes_here && boundary.leaf < 0)) {
        passed = tracer_.light_through(rays.ray(lane), to_light);
        return false;
    }
    if (!boundary.before.is_empty()) {
        const MaterialInstance& medium = world_.materials[boundary.before.medium];
        const double to = std::min(boundary.t, to_light);
        passed = passed * tracer_.medium_lets_through(medium, rays.ray(lane), from, to);
    }
    if (at_light) return false;
    if (boundary.is_sheet() || changes_here) passed = tracer_.face_lets_through(boundary, rays.ray(lane)) * passed;
    return !is_black(passed) && !tracer_.is_stopped();
}

// ---- colours ---------------------------------------------------------------------------------------------------------

// Tracer::Implementation::shade for all faces of a packet, without what comes back along the rays that are sent.
// All mirrored rays of a packet before the refracted ones: so these stay together.
void PacketPaths::divide_light(Wave& wave, Wave& next, const FacePacket& faces) {
    using Turn = Tracer::Implementation::Turn;
    Lanes refracted_weight;
    for (int i = 0; i < faces.count; ++i) {
        const int ray = faces.ray[i];
        const Colour highlight = faces.highlight[i];
        const Colour local = faces.colour[i] * (faces.ambient[i] + faces.diffuse[i]) + highlight;
        const double reflection = faces.reflection[i], opacity = faces.opacity[i];
        double mirrored_weight = reflection;
        refracted_weight[i] = 0;
        if (!faces.is_transparent(i)) {
            wave.colours[ray] = (1 - reflection) * local;
        } else if (faces.index_before[i] == faces.index_behind[i] && opacity == 0 && reflection == 0) {
            wave.gathered[ray] += wave.passed[ray] * highlight;
            ++wave.lit[ray];
            go_on(wave, next, ray, faces.t[i], {});
            continue;
        } else {
            const double fresnel =
                fresnel_reflectance(faces.arriving[i], Normal(faces.shading[i]), faces.index_before[i], faces.index_behind[i]);
            const double clear = (1 - reflection) * (1 - opacity);
            mirrored_weight = reflection + clear * fresnel;
            refracted_weight[i] = clear * (1 - fresnel);
            wave.colours[ray] = (1 - reflection) * (opacity * local + (1 - opacity) * highlight);
        }
        if (!(mirrored_weight > 0)) continue;
        const Vector mirrored = Tracer::Implementation::turned_out(faces.mirrored[i], Normal(faces.geometric[i]));
        send(wave, next, faces, i, mirrored, mirrored_weight, Turn::mirrored);
    }
    if (faces.transparent == 0) return;
    for (int i = 0; i < faces.count; ++i) {
        if (!(refracted_weight[i] > 0)) continue;
        if (const std::optional<Vector> direction = refracted_direction(faces, i)) {
            send(wave, next, faces, i, *direction, refracted_weight[i], Turn::refracted);
        } else {
            ++tracer_.statistics.refracted_rays;
            wave.contributions.push_back({faces.ray[i], -1, refracted_weight[i]});
        }
    }
}

// A direction that a bent normal would turn back to the viewer's side is refracted at the true one.
std::optional<Vector> PacketPaths::refracted_direction(const FacePacket& faces, int lane) {
    const Vector arriving = faces.arriving[lane];
    const Normal geometric(faces.geometric[lane]);
    const double eta = faces.index_before[lane] / faces.index_behind[lane];
    std::optional<Vector> direction = eta == 1 ? arriving : refract(arriving, Normal(faces.shading[lane]), eta);
    if (direction && dot(*direction, geometric) >= 0) direction = refract(arriving, geometric, eta);
    return direction;
}

// The ray that goes on from a face, or the background where it would count too little.
void PacketPaths::send(Wave& wave, Wave& next, const FacePacket& faces, int lane, const Vector& direction, double weight,
                       Tracer::Implementation::Turn turn) {
    const bool refracted = turn == Tracer::Implementation::Turn::refracted;
    ++(refracted ? tracer_.statistics.refracted_rays : tracer_.statistics.mirrored_rays);
    const int ray = faces.ray[lane];
    const Path& path = wave.paths[ray];
    const double weight_here = path.weight * largest(wave.passed[ray]);
    const Path onward{weight_here * weight, path.depth + 1, faces.travelled[lane], 2 * path.branch + refracted,
                      path.faces + wave.lit[ray] + 1};
    if (onward.ends(tracer_.settings)) {
        wave.contributions.push_back({ray, -1, weight});
        return;
    }
    wave.contributions.push_back({ray, next.count, weight});
    next.add_through_matter(faces.depart(lane, direction), onward, 0, Colour::black(), Colour::white(), 0);
}

}  // namespace lapidary
