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

void PacketPaths::trace_wave_through_matter(std::size_t depth, std::span<FirstFace> first) {
    while (waves_.size() <= depth + 1) waves_.push_back(std::make_unique<Wave>());
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

void PacketPaths::trace_portion(std::size_t depth, std::span<FirstFace> first) {
    Wave &wave = *waves_[depth], &next = *waves_[depth + 1];
    face_packets_ = 0;
    single_faces_ = nullptr;
    next.make_room(2 * (wave.end - wave.begin));  // as a face may send two
    next.clear();
    wave.contributions.clear();
    for (int packet = 0; packet < wave.packets_under_way(); ++packet) go_to_changes(depth, packet, first);
    if (single_faces_) single_faces_->fill_up();
    gather_faces_at_changes(wave, first);
    light_faces(depth);
    for (std::size_t p = 0; p < face_packets_; ++p) divide_light(wave, next, *faces_[p]);

    if (next.count > 0 && !tracer_.is_stopped()) trace_wave_through_matter(depth + 1, {});
    for (const Contribution& c : wave.contributions)
        wave.colours[c.to] += c.weight * (c.from < 0 ? world_.background : next.colours[c.from]);
    for (int i = wave.begin; i < wave.end; ++i) wave.colours[i] = wave.gathered[i] + wave.passed[i] * wave.colours[i];
}

// ---- faces -----------------------------------------------------------------------------------------------------------

Label PacketPaths::label_of(std::int32_t solid) const { return solid < 0 ? Label{} : world_.insides[solid]; }

Boundary PacketPaths::boundary_of(const ChangePacket& changes, int lane) const {
    Boundary boundary;
    boundary.t = changes.first.t[lane], boundary.solid = changes.first.solid[lane], boundary.leaf = changes.first.leaf[lane];
    boundary.before = label_of(changes.before[lane]), boundary.after = label_of(changes.after[lane]);
    return boundary;
}

namespace {

// Of uniform matter that does not absorb: its transmittance() is exactly 1 over any length.
bool is_clear(const MaterialInstance& medium) {
    return medium.is_uniform() && medium.colour.r >= 1 && medium.colour.g >= 1 && medium.colour.b >= 1;
}

}  // namespace

void PacketPaths::find_meeting(const ChangePacket& changes, int lane, Meetings& meetings) const {
    const auto i = static_cast<std::size_t>(lane);
    const std::int32_t before = changes.before[i], after = changes.after[i], index = changes.first.leaf[i];
    const Label label_before = label_of(before), label_after = label_of(after);
    const auto bit = static_cast<unsigned>(bit_of(lane));
    meetings.cell_before[i] = label_before.owner, meetings.cell_behind[i] = label_after.owner;
    meetings.shown[i] = -1;
    if (before >= 0) {
        const MaterialInstance& medium = world_.materials[label_before.medium];
        if (medium.may_be_transparent && !is_clear(medium)) meetings.dimmed |= bit;
    }
    if (index < 0 || changes.first.solid[i] < 0 || before == after) return;
    const Leaf& leaf = world_.leaves[index];
    if (leaf.first_surface >= 0 && changes.first.face[i] < 0) return;
    const std::int32_t innards = after >= 0 ? label_after.medium : label_before.medium;
    const std::int32_t shown = leaf.appearance >= 0 ? leaf.appearance : innards;
    meetings.shown[i] = shown;
    if (after < 0 || label_after.medium == shown || !world_.materials[shown].may_be_transparent) meetings.plain |= bit;
}

// Most packets are of rays that come from the same matter and meet the same face.
void PacketPaths::find_meetings(const ChangePacket& changes, Meetings& meetings) const {
    constexpr unsigned all = (1u << width) - 1;
    meetings.plain = meetings.dimmed = 0;
    meetings.are_alike = changes.are_alike();
    find_meeting(changes, 0, meetings);
    for (int lane = 1; lane < width && !meetings.are_alike; ++lane) find_meeting(changes, lane, meetings);
    if (!meetings.are_alike) return;
    meetings.plain = meetings.plain != 0 ? all : 0, meetings.dimmed = meetings.dimmed != 0 ? all : 0;
    meetings.shown.fill(meetings.shown[0]);
    meetings.cell_before.fill(meetings.cell_before[0]), meetings.cell_behind.fill(meetings.cell_behind[0]);
}

void PacketPaths::check_first_cells(const RayPacket& rays, const Lanes& from, const Meetings& meetings, unsigned lanes) {
    const unsigned others = lanes_that_differ(rays.departure.cell, meetings.cell_before);
    for (unsigned rest = lanes & others; rest != 0; rest &= rest - 1) {
        const int lane = std::countr_zero(rest);
        if (from[lane] == 0) tracer_.check_first_cell(rays.departure[lane], meetings.cell_before[lane]);
    }
}

// The rays of a packet go through the matter that they start in, to what they meet at the end of it. Those that are finished have
// their colours, to be multiplied by what has passed; plain faces are left to be gathered, if not all rays meet the same.
void PacketPaths::go_to_changes(std::size_t depth, int packet, std::span<FirstFace> first) {
    Wave& wave = *waves_[depth];
    const int begin = wave.begin + packet * width, count = std::min(width, wave.end - begin);
    const RayPacket& rays = wave.rays[begin / width];
    const PacketThroughWorld::Stretch& stretch = wave.stretches[begin / width];
    ChangePacket& changes = wave.changes[packet];
    Meetings& meetings = wave.meetings[packet];
    packet_.first_changes(rays, stretch, in_reach_of(depth), changes, quarter_of(depth, packet));
    find_meetings(changes, meetings);
    std::fill_n(wave.colours.begin() + begin, count, world_.background);

    const unsigned with_ray = (1u << count) - 1, unclear = changes.unclear & with_ray;
    for (unsigned rest = unclear; rest != 0; rest &= rest - 1) trace_alone(wave, begin + std::countr_zero(rest), first);
    unsigned arriving = with_ray & ~unclear;
    check_first_cells(rays, stretch.from, meetings, arriving);
    for (unsigned rest = arriving & meetings.dimmed; rest != 0; rest &= rest - 1)
        if (!pass_matter(wave, begin + std::countr_zero(rest), first)) arriving &= ~(rest & -rest);
    arriving &= finite_lanes(changes.first.t);
    meetings.plain &= arriving;
    for (unsigned rest = arriving & ~meetings.plain; rest != 0; rest &= rest - 1)
        meet_unusual(wave, *waves_[depth + 1], begin + std::countr_zero(rest), first);
    if (meetings.are_alike && meetings.plain == (1u << width) - 1) {
        meet_one_face(wave, packet, first);
        meetings.plain = 0;
    }
}

// What is not a plain face.
void PacketPaths::meet_unusual(Wave& wave, Wave& next, int ray, std::span<FirstFace> first) {
    const ChangePacket& changes = wave.change(ray);
    const int lane = ray % width;
    const bool is_sheet = changes.first.solid[lane] < 0;
    if (!is_sheet && changes.before[lane] == changes.after[lane])
        go_on(wave, next, ray, changes.first.t[lane], first);
    else if (changes.first.leaf[lane] >= 0)
        meet_single_face_at_change(wave, ray, first);
    else  // A boundary without a leaf is one that rounding undid, or that several leaves share.
        trace_alone(wave, ray, first);
}

// Through matter that dims light, and whether the ray comes to the end of it.
bool PacketPaths::pass_matter(Wave& wave, int ray, std::span<FirstFace> first) {
    const ChangePacket& changes = wave.change(ray);
    const MaterialInstance& medium = world_.materials[world_.insides[changes.before[ray % width]].medium];
    if (!medium.is_uniform()) return !march(wave, ray, medium, first);
    Colour& passed = wave.passed[ray];
    passed = passed * transmittance(medium, {}, wave.from(ray), changes.first.t[ray % width]);
    return !is_black(passed);
}

// All rays of a packet meet the same face.
void PacketPaths::meet_one_face(Wave& wave, int packet, std::span<FirstFace> first) {
    const int begin = wave.begin + packet * width;
    const ChangePacket& changes = wave.changes[packet];
    FacePacket& faces = new_faces();
    faces.count = width;
    for (int lane = 0; lane < width; ++lane) faces.ray[lane] = begin + lane;
    faces.departure.cell = wave.meetings[packet].cell_before, faces.cell_behind = wave.meetings[packet].cell_behind;
    show_faces_at_changes(wave, wave.rays[begin / width], changes.first.t, faces, first);
}

// The rays of the packets under way that meet the same face come together.
void PacketPaths::gather_faces_at_changes(Wave& wave, std::span<FirstFace> first) {
    for (int packet = 0; packet < wave.packets_under_way(); ++packet)
        while (wave.meetings[packet].plain != 0) gather_face(wave, packet, first);
}

// The first waiting ray's face, with those of others that meet the same one.
void PacketPaths::gather_face(Wave& wave, int packet, std::span<FirstFace> first) {
    const auto leader = static_cast<std::size_t>(std::countr_zero(wave.meetings[packet].plain));
    const BoundaryPacket& leading = wave.changes[packet].first;
    const std::int32_t leaf = leading.leaf[leader], face = leading.face[leader], shown = wave.meetings[packet].shown[leader];
    FacePacket& faces = new_faces();
    RayPacket rays;
    Lanes t;
    for (int p = packet; p < wave.packets_under_way() && !faces.is_full(); ++p) {
        Meetings& meetings = wave.meetings[p];
        if (meetings.plain == 0) continue;
        const BoundaryPacket& met = wave.changes[p].first;
        unsigned rest =
            meetings.plain & lanes_with(met.leaf, leaf) & lanes_with(met.face, face) & lanes_with(meetings.shown, shown);
        for (; rest != 0 && !faces.is_full(); rest &= rest - 1) {
            const int lane = std::countr_zero(rest), ray = wave.begin + p * width + lane;
            meetings.plain &= ~(1u << lane);
            const int number = faces.count++;
            t[number] = met.t[lane], faces.ray[number] = ray;
            faces.departure.cell[number] = meetings.cell_before[lane], faces.cell_behind[number] = meetings.cell_behind[lane];
            rays.add(wave.rays[ray / width], lane);
        }
    }
    rays.fill_up();
    for (int lane = faces.count; lane < width; ++lane) {
        t[lane] = t[0], faces.ray[lane] = faces.ray[0];
        faces.departure.cell[lane] = faces.departure.cell[0], faces.cell_behind[lane] = faces.cell_behind[0];
    }
    show_faces_at_changes(wave, rays, t, faces, first);
}

// To the next boundary within textured matter, and whether there is one, or nothing is left of light on the way.
bool PacketPaths::march(Wave& wave, int number, const MaterialInstance& medium, std::span<FirstFace> first) {
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
void PacketPaths::trace_alone(Wave& wave, int ray, std::span<FirstFace> first) {
    wave.gathered[ray] = Colour::black(), wave.passed[ray] = Colour::white();
    wave.colours[ray] =
        tracer_.radiance(wave.ray(ray), wave.paths[ray], first.empty() ? nullptr : &first[static_cast<std::size_t>(ray)]);
}

// Straight on from a place that shows no face, or one that lets all light pass, as a ray of the next wave. The layers of a camera
// ray that has not met anything yet are left to the single path.
void PacketPaths::go_on(Wave& wave, Wave& next, int ray, double from, std::span<FirstFace> first) {
    if (!first.empty() && first[static_cast<std::size_t>(ray)].object == 0) {
        trace_alone(wave, ray, first);
        return;
    }
    const int onward = next.count;
    wave.contributions.push_back({ray, onward, 1});
    next.paths[onward] = wave.paths[ray];
    next.send(wave.rays[ray / width], ray % width);
    next.stretches[onward / width].from[onward % width] = from;
    next.gathered[onward] = wave.gathered[ray], next.passed[onward] = wave.passed[ray], next.lit[onward] = wave.lit[ray];
    wave.colours[ray] = wave.gathered[ray] = Colour::black(), wave.passed[ray] = Colour::white();
}

void PacketPaths::Wave::begin_camera_rays() {
    for (PacketThroughWorld::Stretch& stretch : stretches) stretch.from.v.fill(0);
    std::fill_n(gathered.begin(), count, Colour::black());
    std::fill_n(passed.begin(), count, Colour::white());
    std::fill_n(lit.begin(), count, 0);
}

// A ray that sets out from a face; its path is set.
void PacketPaths::Wave::send(const RayPacket& from, int lane) {
    stretches[count / width].from[count % width] = 0;
    gathered[count] = Colour::black(), passed[count] = Colour::white(), lit[count] = 0;
    own_rays[count / width].add(from, lane);
    ++count;
}

// Rays that meet the same face of a leaf; which ones and the cells on both sides is known already.
void PacketPaths::show_faces_at_changes(const Wave& wave, const RayPacket& rays, const Lanes& t, FacePacket& faces,
                                        std::span<FirstFace> first) {
    const int leader = faces.ray[0], lane = leader % width;
    const BoundaryPacket& leading = wave.change(leader).first;
    const std::int32_t shown = wave.meeting(leader).shown[lane];
    const Leaf& leaf = world_.leaves[leading.leaf[lane]];
    note_rays_at_changes(wave, leading.leaf[lane], rays, t, faces);
    place_faces(leading.leaf[lane], leading.face[lane], rays, t, faces);
    give_matter(world_.materials[shown], faces);
    find_indices(shown, wave, faces);
    describe(leaf, world_.materials[shown], faces, first);
}

void PacketPaths::note_rays_at_changes(const Wave& wave, std::int32_t leaf, const RayPacket& rays, const Lanes& t,
                                       FacePacket& faces) {
    faces.key = rays.key, faces.t = t;
    faces.departure.leaf.fill(leaf), faces.departure.surface_class.fill(-1), faces.departure.inward.fill(0);
    faces.depart_alike = true;
    note_paths(wave, t, faces);
    for (int lane = 0; tracer_.extended_lights > 0 && lane < width; ++lane)
        faces.light_samples[lane] += tracer_.extended_lights * wave.lit[faces.ray[lane]];
    std::int64_t leaving = 0;
    for (int lane = 0; lane < width; ++lane) leaving |= faces.cell_behind[lane] < 0 ? bit_of(lane) : 0;
    faces.leaving = static_cast<unsigned>(leaving);
}

void PacketPaths::add_single_face_at_change(Wave& wave, int ray, double t, const Encounter& encounter) {
    add_single_face(wave, ray, encounter);
    const int lane = single_faces_->count - 1;
    single_faces_->light_samples[lane] += tracer_.extended_lights * wave.lit[ray];
    single_faces_->t[lane] = t;
}

void PacketPaths::meet_single_face_at_change(Wave& wave, int number, std::span<FirstFace> first) {
    const Ray ray = wave.ray(number);
    tracer_.ray_through_world.start(ray);
    FirstFace* sample = first.empty() ? nullptr : &first[static_cast<std::size_t>(number)];
    const std::optional<Encounter> encounter =
        tracer_.encounter_face(ray, boundary_of(wave.change(number), number % width), wave.paths[number].travelled, sample);
    if (encounter)
        add_single_face_at_change(wave, number, wave.change(number).first.t[number % width], *encounter);
    else
        trace_alone(wave, number, first);
}

// Of a solid's matter just before or behind a face. Of uniform matter at once.
double PacketPaths::index_beside(const FacePacket& faces, int lane, std::int32_t solid, Side side) const {
    if (solid < 0) return 1;
    const MaterialInstance& medium = world_.materials[world_.insides[solid].medium];
    if (medium.is_uniform()) return medium.finish->is_transparent() ? medium.finish->refraction : 1;
    const Vector beyond = ahead(faces.arriving[lane], Normal(faces.geometric[lane]));
    return tracer_.index_of(label_of(solid), site_of(faces, lane), side == Side::after ? beyond : -beyond, nullptr);
}

// Behind faces that show the matter which begins there, the index is known already.
void PacketPaths::find_indices(std::int32_t shown, const Wave& wave, FacePacket& faces) const {
    for (unsigned rest = faces.transparent; rest != 0; rest &= rest - 1) {
        const int lane = std::countr_zero(rest), from = faces.ray[lane] % width;
        const ChangePacket& changes = wave.change(faces.ray[lane]);
        const std::int32_t before = changes.before[from], after = changes.after[from];
        const bool is_known = after >= 0 && world_.insides[after].medium == shown;
        if (!is_known) faces.index_behind[lane] = index_beside(faces, lane, after, Side::after);
        faces.index_before[lane] = index_beside(faces, lane, before, Side::before);
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

namespace {

// How light divides at the faces of a packet: what counts of the mirrored and of the refracted rays. Bit i for lane i.
struct DividedLight {
    Lanes mirrored, refracted;
    unsigned passes;  // the faces that neither bend, mirror nor cover what is behind them
};

template <class Faces>
[[gnu::noinline]] void divide(const Faces& __restrict faces, DividedLight& __restrict divided) {
    const std::int64_t transparent_lanes = faces.transparent;
    for (int i = 0; i < batch_size; ++i) {
        const bool transparent = (transparent_lanes & bit_of(i)) != 0;
        const double before = transparent ? faces.index_before[i] : 1, behind = transparent ? faces.index_behind[i] : 1;
        const double reflection = faces.reflection[i];
        const double fresnel = fresnel_reflectance(faces.arriving[i], Normal(faces.shading[i]), before, behind);
        const double clear = transparent ? (1 - reflection) * (1 - faces.opacity[i]) : 0;
        divided.mirrored[i] = reflection + clear * fresnel;
        divided.refracted[i] = clear * (1 - fresnel);
    }
    std::int64_t passes = 0;
    for (int i = 0; i < batch_size; ++i) {
        const bool is_smooth = faces.index_before[i] == faces.index_behind[i];
        const bool covers = either(faces.opacity[i] != 0, faces.reflection[i] != 0);
        passes |= both(is_smooth, !covers) ? bit_of(i) : 0;
    }
    divided.passes = static_cast<unsigned>(passes & transparent_lanes);
}

// Refracted rays for all lanes, and those of total reflection. Returns the lanes that are unusual: where light goes straight on,
// or a bent normal would turn it back.
template <class Faces>
[[gnu::noinline]] unsigned find_refracted(const Faces& __restrict faces, VectorLanes& __restrict directions,
                                          unsigned& __restrict total) {
    std::int64_t unusual = 0, total_lanes = 0;
    for (int i = 0; i < batch_size; ++i) {
        const double eta = faces.index_before[i] / faces.index_behind[i];
        const Refraction refraction = refract(faces.arriving[i], Normal(faces.shading[i]), eta);
        directions.set(i, refraction.direction);
        total_lanes |= refraction.is_total ? bit_of(i) : 0;
        unusual |= either(eta == 1, dot(refraction.direction, faces.geometric[i]) >= 0) ? bit_of(i) : 0;
    }
    total = static_cast<unsigned>(total_lanes);
    return static_cast<unsigned>(unusual);
}

}  // namespace

// Tracer::Implementation::shade for all faces of a packet, without what comes back along the rays that are sent.
// All mirrored rays of a packet before the refracted ones: so these stay together.
void PacketPaths::divide_light(Wave& wave, Wave& next, FacePacket& faces) {
    using Turn = Tracer::Implementation::Turn;
    DividedLight divided{faces.reflection, {}, 0};
    if (faces.transparent != 0) divide(faces, divided);
    ColourLanes shown;
    show_colours(faces, shown);
    for (int i = 0; i < faces.count; ++i) wave.colours[faces.ray[i]] = shown[i];
    for (unsigned rest = divided.passes; rest != 0; rest &= rest - 1) {
        const int lane = std::countr_zero(rest), ray = faces.ray[lane];
        wave.gathered[ray] += wave.passed[ray] * faces.highlight[lane];
        ++wave.lit[ray];
        go_on(wave, next, ray, faces.t[lane], {});
    }
    const unsigned divides = faces.lanes() & ~divided.passes;
    const unsigned mirrored = positive_lanes(divided.mirrored) & divides;
    if (mirrored != 0) {
        turn_mirrored_out(faces);
        send(wave, next, faces, faces.mirrored, divided.mirrored, mirrored, Turn::mirrored);
    }
    const unsigned refracted = positive_lanes(divided.refracted) & faces.transparent & divides;
    if (refracted != 0) refract_rays(wave, next, faces, divided.refracted, refracted);
}

// Where nothing is refracted, the background is what is seen.
void PacketPaths::refract_rays(Wave& wave, Wave& next, const FacePacket& faces, const Lanes& weights, unsigned lanes) {
    VectorLanes directions;
    unsigned total = 0;
    const unsigned unusual = find_refracted(faces, directions, total);
    for (unsigned rest = lanes & unusual; rest != 0; rest &= rest - 1) {
        const int i = std::countr_zero(rest);
        const Normal shading(faces.shading[i]), geometric(faces.geometric[i]);
        const double eta = faces.index_before[i] / faces.index_behind[i];
        const Refraction refraction = Tracer::Implementation::refracted(faces.arriving[i], shading, geometric, eta);
        directions.set(i, refraction.direction);
        total = refraction.is_total ? total | 1u << i : total & ~(1u << i);
    }
    for (unsigned rest = lanes & total; rest != 0; rest &= rest - 1) {
        const int i = std::countr_zero(rest);
        ++tracer_.statistics.refracted_rays;
        wave.contributions.push_back({faces.ray[i], -1, weights[i]});
    }
    send(wave, next, faces, directions, weights, lanes & ~total, Tracer::Implementation::Turn::refracted);
}

// The rays that go on from faces, or the background where they would count too little.
void PacketPaths::send(Wave& wave, Wave& next, const FacePacket& faces, const VectorLanes& directions, const Lanes& weights,
                       unsigned lanes, Tracer::Implementation::Turn turn) {
    const bool refracted = turn == Tracer::Implementation::Turn::refracted;
    (refracted ? tracer_.statistics.refracted_rays : tracer_.statistics.mirrored_rays) +=
        static_cast<std::uint64_t>(std::popcount(lanes));
    RayPacket rays;
    faces.depart(directions, rays);
    for (unsigned rest = lanes; rest != 0; rest &= rest - 1) {
        const int lane = std::countr_zero(rest), ray = faces.ray[lane];
        const Path& path = wave.paths[ray];
        const double weight = weights[lane], weight_here = path.weight * largest(wave.passed[ray]);
        const Path onward{weight_here * weight, path.depth + 1, faces.travelled[lane], 2 * path.branch + refracted,
                          path.faces + wave.lit[ray] + 1};
        const bool ends = onward.ends(tracer_.settings);
        wave.contributions.push_back({ray, ends ? -1 : next.count, weight});
        next.paths[next.count] = onward;
        if (!ends) next.send(rays, lane);
    }
}

}  // namespace lapidary
