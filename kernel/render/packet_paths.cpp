// SPDX-License-Identifier: MIT
#include "kernel/render/packet_paths.h"

#include <algorithm>
#include <bit>

#include "kernel/csg/near_root.h"
#include "kernel/csg/placed_lines.h"
#include "kernel/render/optics.h"
#include "kernel/render/sampler.h"

namespace lapidary {

namespace {

constexpr LightSampleBatch middle_of_light = [] {
    LightSampleBatch middle{};
    for (int i = 0; i < batch_size; ++i) middle.u[i] = 0.5, middle.v[i] = 0.5;
    return middle;
}();

}  // namespace

// ---- waves -----------------------------------------------------------------------------------------------------------

PacketPaths::Wave::Wave() : own_rays(wave_size / width), paths(wave_size), own_colours(wave_size) {
    rays = own_rays, colours = own_colours;
}

// For so many rays through matter. Most waves stay short, and what is never touched costs nothing.
void PacketPaths::Wave::make_room(int most) {
    const auto packets = static_cast<std::size_t>((most + width - 1) / width), size = packets * width;
    if (stretches.size() >= packets) return;
    own_rays.resize(packets), stretches.resize(packets), changes.resize(packets), meetings.resize(packets);
    for (PacketThroughWorld::Stretch& stretch : stretches) stretch.limit.v.fill(infinity);
    paths.resize(size), own_colours.resize(size), gathered.resize(size), passed.resize(size), lit.resize(size);
    rays = own_rays, colours = own_colours;
}

void PacketPaths::Wave::clear() {
    for (int i = 0; i < count; i += width) own_rays[i / width].clear();
    count = 0;
}

void PacketPaths::Wave::fill_up() {
    if (count % width != 0) own_rays[count / width].fill_up();
}

PacketPaths::PacketPaths(Tracer::Implementation& tracer)
    : tracer_(tracer), world_(tracer.world), packet_(tracer.world, tracer.statistics), to_light_(tracer.world) {}

void PacketPaths::trace(std::span<const RayPacket> rays, std::span<Colour> colours, std::span<FirstFace> faces) {
    if (waves_.empty()) waves_.push_back(std::make_unique<Wave>());
    Wave& wave = *waves_[0];
    camera_packets_ = rays.size();
    for (std::size_t begin = 0; begin < colours.size() && !tracer_.is_stopped(); begin += wave_size) {
        camera_packets_before_ = begin / width;
        const std::size_t size = std::min<std::size_t>(wave_size, colours.size() - begin);
        wave.count = static_cast<int>(size);
        if (world_.features.transparency) wave.make_room(wave.count);
        wave.rays = rays.subspan(begin / width, (size + width - 1) / width), wave.colours = colours.subspan(begin, size);
        const auto first = faces.empty() ? faces : faces.subspan(begin, size);
        if (world_.features.transparency) {
            std::fill_n(wave.paths.begin(), wave.count, Path{});  // as rays that went on have taken some
            wave.begin_camera_rays();
            trace_wave_through_matter(0, first);
        } else {
            trace_wave(0, first);
        }
    }
}

// Of a part of the picture, if its camera rays come in quarters, the one that a packet of the wave under way is in.
unsigned PacketPaths::quarter_of(std::size_t depth, int packet) const {
    if (depth > 0) return SolidInReach::all_rays;
    return 1U << 4 * (camera_packets_before_ + static_cast<std::size_t>(packet)) / camera_packets_;
}

void PacketPaths::trace_wave(std::size_t depth, std::span<FirstFace> first) {
    Wave& wave = *waves_[depth];
    if (depth > 0) wave.fill_up();
    const std::size_t packets = (static_cast<std::size_t>(wave.count) + width - 1) / width;
    face_packets_ = 0;
    single_faces_ = nullptr;
    WaitingRays waiting{};
    wave.some_start_inside = false;
    for (std::size_t p = 0; p < packets; ++p) {
        if (tracer_.is_stopped()) return;
        packet_.first_boundaries(wave.rays[p], in_reach_of(depth), wave.boundaries[p], quarter_of(depth, static_cast<int>(p)));
        wave.some_start_inside |= wave.boundaries[p].starts_inside != 0;
        waiting[p] = collect_faces_of(wave, static_cast<int>(p), first);
    }
    collect_faces(wave, waiting, first);
    light_faces(depth);
    finish_colours(depth);

    if (waves_.size() <= depth + 1 || waves_[depth + 1]->count == 0 || tracer_.is_stopped()) return;
    Wave& next = *waves_[depth + 1];
    trace_wave(depth + 1, {});
    for (int i = 0; i < next.count; ++i) wave.colours[next.sender[i]] += next.reflection[i] * next.colours[i];
}

// ---- faces -----------------------------------------------------------------------------------------------------------

PacketPaths::FacePacket& PacketPaths::new_faces() {
    if (face_packets_ == faces_.size()) faces_.push_back(std::make_unique<FacePacket>());
    FacePacket& faces = *faces_[face_packets_++];
    faces.count = 0;
    faces.transparent = 0, faces.sheets = 0, faces.leaving = 0, faces.depart_alike = false, faces.is_mirrored = false;
    return faces;
}

// Whether all that a face shows can be had without asking the single ray: which leaf it is of is known, and of it which surface
// if it is shared, and the innards that a cut shows are those of the first positive leaf.
bool PacketPaths::is_plain(const Wave& wave, int ray) const {
    if (wave.leaf(ray) < 0 || wave.solid(ray) < 0) return false;
    const Leaf& leaf = world_.leaves[wave.leaf(ray)];
    if (leaf.first_surface >= 0 && wave.face(ray) < 0) return false;
    return leaf.appearance >= 0 || world_.solids[wave.solid(ray)].is_product;
}

// Of one packet; returns the rays that are to be gathered with those of others: bit i for ray i. Where all rays meet the same
// face, as is usual where they are close together, nothing has to be gathered.
unsigned PacketPaths::collect_faces_of(Wave& wave, int packet, std::span<FirstFace> first) {
    const BoundaryPacket& boundaries = wave.boundaries[packet];
    const int begin = packet * width, count = std::min(width, wave.count - begin);
    constexpr unsigned all = (1u << width) - 1;
    const unsigned with_ray = (1u << count) - 1, met = finite_lanes(boundaries.t) & with_ray;
    for (unsigned rest = with_ray & ~met; rest != 0; rest &= rest - 1)
        wave.colours[begin + std::countr_zero(rest)] = world_.background;
    if (met != all || !boundaries.are_of_one_face() || !is_plain(wave, begin)) return met;

    const std::int32_t index = boundaries.leaf[0];
    const Leaf& leaf = world_.leaves[index];
    const RayPacket& rays = wave.rays[packet];
    FacePacket& faces = new_faces();
    faces.count = width;
    for (int lane = 0; lane < width; ++lane) faces.ray[lane] = begin + lane;
    note_rays(wave, index, rays, boundaries.t, faces);
    if (leaf.first_surface < 0) {
        const SpanBatch& spans = packet_.local_spans(index);
        place_own_faces(leaf, rays, boundaries.t, packet_.placed_lines(index), spans, faces);
    } else {
        const std::int32_t face = boundaries.face[0];
        place_shared_faces(leaf, face, rays, boundaries.t, packet_.placed_lines(frame_of(index, face)), faces);
    }
    show_leaf(leaf, boundaries.solid[0], faces, first);
    return 0;
}

void PacketPaths::collect_faces(Wave& wave, WaitingRays& waiting, std::span<FirstFace> first) {
    for (std::size_t packet = 0; packet < waiting.size(); ++packet)
        while (waiting[packet] != 0) {
            const int ray = static_cast<int>(packet) * width + std::countr_zero(waiting[packet]);
            if (is_plain(wave, ray)) {
                meet_plain_faces(wave, ray, waiting, first);
            } else {
                waiting[packet] &= waiting[packet] - 1;
                meet_single_face(wave, ray, first);
            }
        }
    if (single_faces_) single_faces_->fill_up();
}

// The first waiting ray's face, together with those of other rays that meet the same one.
void PacketPaths::meet_plain_faces(Wave& wave, int leader, WaitingRays& waiting, std::span<FirstFace> first) {
    const std::int32_t index = wave.leaf(leader), face = wave.face(leader);
    const Leaf& leaf = world_.leaves[index];
    FacePacket& faces = new_faces();
    RayPacket rays;
    Lanes t;
    for (int packet = leader / width; packet < wave_size / width && !faces.is_full(); ++packet) {
        const BoundaryPacket& met = wave.boundaries[packet];
        if (waiting[packet] == 0) continue;
        unsigned rest = waiting[packet] & lanes_with(met.leaf, index) & lanes_with(met.face, face);
        for (; rest != 0 && !faces.is_full(); rest &= rest - 1) {
            const int lane = std::countr_zero(rest), ray = packet * width + lane, number = faces.count++;
            waiting[packet] &= ~(1u << lane);
            rays.add(wave.rays[packet], lane);
            t[number] = met.t[lane], faces.ray[number] = ray;
        }
    }
    rays.fill_up();
    for (int lane = faces.count; lane < width; ++lane) t[lane] = t[0], faces.ray[lane] = faces.ray[0];
    note_rays(wave, index, rays, t, faces);
    place_faces(index, face, rays, t, faces);
    show_leaf(leaf, wave.solid(leader), faces, first);
}

// What is known of the faces of a leaf from their rays alone; faces.ray is known already.
void PacketPaths::note_rays(const Wave& wave, std::int32_t leaf, const RayPacket& rays, const Lanes& t, FacePacket& faces) {
    faces.key = rays.key;
    faces.departure.fill({leaf, -1, false, Departure::no_cell});
    faces.depart_alike = true;
    for (int lane = 0; wave.some_start_inside && lane < width; ++lane)
        if (wave.starts_inside(faces.ray[lane])) faces.departure.cell[static_cast<std::size_t>(lane)] = Departure::unknown_cell;
    note_paths(wave, t, faces);
}

// The matter that faces of a leaf show, where they are.
void PacketPaths::show_leaf(const Leaf& leaf, std::int32_t of_solid, FacePacket& faces, std::span<FirstFace> first) {
    const Solid& solid = world_.solids[of_solid];
    const std::int32_t shown = leaf.appearance >= 0 ? leaf.appearance : world_.leaves[solid.first_leaf].medium;
    const MaterialInstance& material = world_.materials[shown];
    give_matter(material, faces);
    describe(leaf, material, faces, first);
}

void PacketPaths::note_paths(const Wave& wave, const Lanes& t, FacePacket& faces) {
    for (int lane = 0; lane < width; ++lane) faces.travelled[lane] = wave.paths[faces.ray[lane]].travelled + t[lane];
    for (int lane = 0; tracer_.extended_lights > 0 && lane < width; ++lane)
        faces.light_samples[lane] = tracer_.extended_lights * wave.paths[faces.ray[lane]].faces;
}

// For the layers beside the colour.
void PacketPaths::describe(const Leaf& leaf, const MaterialInstance& material, const FacePacket& faces,
                           std::span<FirstFace> first) {
    if (first.empty()) return;
    for (int lane = 0; lane < faces.count; ++lane) {
        FirstFace& sample = first[static_cast<std::size_t>(faces.ray[lane])];
        sample.depth = faces.travelled[lane];
        sample.normal = Normal(faces.shading[lane]);
        sample.position = faces.points.point(lane);
        sample.object = leaf.number;
        sample.material = material.number;
    }
}

namespace {

// LocalLine::at() for all lanes.
[[gnu::noinline]] void find_points(const LineBatch& __restrict lines, const Lanes& __restrict t, PointBatch& __restrict points) {
    for (int i = 0; i < RayPacket::width; ++i) {
        points.x[i] = fused_multiply_add(t[i], lines.direction_x[i], lines.closest_x[i]);
        points.y[i] = fused_multiply_add(t[i], lines.direction_y[i], lines.closest_y[i]);
        points.z[i] = fused_multiply_add(t[i], lines.direction_z[i], lines.closest_z[i]);
    }
}

// Where lines meet a leaf, in its own space. The end of a span before the anchor was added keeps the digits that t has lost at a
// distance.
[[gnu::noinline]] void find_local_ends(const Lanes& __restrict anchors, const SpanBatch& __restrict spans,
                                       const Lanes& __restrict t, Lanes& __restrict local) {
    for (int i = 0; i < RayPacket::width; ++i) {
        const double anchor = anchors[i], in = spans.in[i], out = spans.out[i], at = t[i];
        const double if_in = anchor + in == at ? in : at - anchor;
        local[i] = anchor + out == at ? out : if_in;
    }
}

}  // namespace

// The leaf in whose space a face is met: of one that leaves share, the representative of its class.
std::int32_t PacketPaths::frame_of(std::int32_t leaf, std::int32_t face) const {
    const std::int32_t first_surface = world_.leaves[leaf].first_surface;
    return first_surface < 0 ? leaf : world_.surface_classes[world_.surface_uses[first_surface + face].surface_class].leaf;
}

// LineThroughSolid::face_at for all lanes. `face`: which of the surfaces, of a leaf that shares them.
void PacketPaths::place_faces(std::int32_t index, std::int32_t face, const RayPacket& rays, const Lanes& t, FacePacket& faces) {
    const Leaf& leaf = world_.leaves[index];
    PlacedLines placed;
    place_lines(world_.leaves[frame_of(index, face)].placement, rays, placed);
    if (leaf.first_surface >= 0) {
        place_shared_faces(leaf, face, rays, t, placed, faces);
        return;
    }
    SpanBatch spans;
    leaf.object->spans_batch(placed.lines, width, &spans);
    place_own_faces(leaf, rays, t, placed, spans, faces);
}

// `placed` are the rays in the leaf's space, `spans` what they have in common with it there.
void PacketPaths::place_own_faces(const Leaf& leaf, const RayPacket& rays, const Lanes& t, const PlacedLines& placed,
                                  const SpanBatch& spans, FacePacket& faces) {
    Lanes local_t;
    find_local_ends(placed.anchor, spans, t, local_t);
    PointBatch local;
    find_points(placed.lines, local_t, local);

    NearPoints near;
    if (leaf.face_count > 0) near.find(rays, t, placed.anchor);
    near.replace_local(leaf.placement, local);

    NormalBatch normals;
    leaf.object->normals_batch(local, width, &normals);
    place_points(leaf.placement, local, faces);
    near.replace(faces);
    faces.arriving = rays.direction;
    turn_normals(leaf.placement, normals, faces);
    round_points(faces);
}

// Of a face that a leaf shares: `placed` are the rays in the frame of its class's representative.
void PacketPaths::place_shared_faces(const Leaf& leaf, std::int32_t face, const RayPacket& rays, const Lanes& t,
                                     const PlacedLines& placed, FacePacket& faces) {
    const SurfaceUse& use = world_.surface_uses[leaf.first_surface + face];
    const SurfaceClass& surface_class = world_.surface_classes[use.surface_class];
    const Leaf& frame = world_.leaves[surface_class.leaf];
    NearPoints near;
    if (!surface_class.whole) near.find(rays, t, placed.anchor);
    Lanes local_t;
    for (int i = 0; i < width; ++i) local_t[i] = t[i] - placed.anchor[i];
    PointBatch local;
    find_points(placed.lines, local_t, local);
    place_points(frame.placement, local, faces);
    near.replace(faces);

    NormalBatch normals;
    const auto normal_at = [&](int lane) {
        const TwoPartPoint point{to_point(faces.anchor[lane]), faces.offset[lane]};
        const bool in_own_frame = &frame == &leaf && (near.lanes >> lane & 1) == 0;
        const Point own = in_own_frame ? local.point(lane) : leaf.placement.to_local(point);
        return leaf.object->normal({own, face});
    };
    if (surface_class.is(Surface::Kind::plane)) {
        const Normal normal = normal_at(0);
        for (int i = 0; i < width; ++i) normals.set(i, normal);
    } else {
        for (int i = 0; i < width; ++i) normals.set(i, normal_at(i));
    }
    faces.arriving = rays.direction;
    turn_normals(leaf.placement, normals, faces);
    // Of a shared surface, sides are those of its representative.
    for (int i = 0; use.flipped && i < width; ++i) faces.outward.set(i, -faces.outward[i]);
    faces.departure.surface_class.fill(use.surface_class);
    round_points(faces);
}

// Beside the rays' origins points are taken from there.
void PacketPaths::NearPoints::find(const RayPacket& rays, const Lanes& t, const Lanes& anchor) {
    std::int64_t found = 0;
    for (int i = 0; i < width; ++i) found |= is_near_root(t[i], anchor[i]) ? bit_of(i) : 0;
    lanes = static_cast<std::uint64_t>(found);
    for (std::uint64_t rest = lanes; rest != 0; rest &= rest - 1) {
        const int i = std::countr_zero(rest);
        points[static_cast<std::size_t>(i)] = point_along(rays.ray(i).origin, t[i], rays.direction[i]);
    }
}

void PacketPaths::NearPoints::replace_local(const Transform& placement, PointBatch& local) const {
    for (std::uint64_t rest = lanes; rest != 0; rest &= rest - 1) {
        const int i = std::countr_zero(rest);
        const Point p = placement.to_local(points[static_cast<std::size_t>(i)]);
        local.x[i] = p.x, local.y[i] = p.y, local.z[i] = p.z;
    }
}

void PacketPaths::NearPoints::replace(FacePacket& faces) const {
    for (std::uint64_t rest = lanes; rest != 0; rest &= rest - 1) {
        const int i = std::countr_zero(rest);
        const TwoPartPoint& point = points[static_cast<std::size_t>(i)];
        faces.anchor.set(i, point.anchor), faces.offset.set(i, point.offset);
    }
}

void PacketPaths::round_points(FacePacket& __restrict faces) {
    for (int i = 0; i < width; ++i) {
        faces.points.x[i] = faces.anchor.x[i] + faces.offset.x[i];
        faces.points.y[i] = faces.anchor.y[i] + faces.offset.y[i];
        faces.points.z[i] = faces.anchor.z[i] + faces.offset.z[i];
    }
}

namespace {

template <bool identity>
void place_points_by(const Transform& placement, const PointBatch& __restrict local, VectorLanes& __restrict anchor,
                     VectorLanes& __restrict offset) {
    const TwoPartPoint& centre = placement.centre();
    const Matrix3& linear = placement.linear();
    for (int i = 0; i < PacketPaths::width; ++i) {
        const Vector place = to_vector(local.point(i));
        anchor.set(i, centre.anchor);
        offset.set(i, (identity ? place : multiply(place, linear)) + centre.offset);
    }
}

// Unit normals in the world.
template <bool identity>
[[gnu::noinline]] void find_unit_normals(const Transform& placement, const NormalBatch& __restrict normals,
                                         VectorLanes& __restrict unit) {
    const Matrix3& inverse = placement.inverse_linear();
    for (int i = 0; i < PacketPaths::width; ++i) {
        const Vector normal{normals.x[i], normals.y[i], normals.z[i]};
        unit.set(i, normalize(identity ? normal : multiply_transposed(normal, inverse)));
    }
}

// As on a plane.
[[gnu::noinline]] bool are_alike(const NormalBatch& normals) {
    const double x = normals.x[0], y = normals.y[0], z = normals.z[0];
    std::int64_t different = 0;
    for (int i = 0; i < PacketPaths::width; ++i)
        different += either(normals.x[i] != x, either(normals.y[i] != y, normals.z[i] != z)) ? 1 : 0;
    return different == 0;
}

// Normals turned against the rays that arrive, and the rays mirrored at them as long as no relief bends them.
template <class Faces>
[[gnu::noinline]] void turn_against_rays(Faces& __restrict faces) {
    for (int i = 0; i < PacketPaths::width; ++i) {
        const Vector outward = faces.outward[i], arriving = faces.arriving[i];
        const double sign = dot(outward, arriving) > 0 ? -1 : 1;
        const Vector normal{sign * outward.x, sign * outward.y, sign * outward.z};
        faces.geometric.set(i, normal), faces.shading.set(i, normal);
        faces.mirrored.set(i, mirror(arriving, Normal(normal)));
    }
}

template <class Faces>
[[gnu::noinline]] void mirror_at_shading_normals(Faces& __restrict faces) {
    for (int i = 0; i < PacketPaths::width; ++i) faces.mirrored.set(i, mirror(faces.arriving[i], Normal(faces.shading[i])));
}

}  // namespace

void PacketPaths::place_points(const Transform& placement, const PointBatch& local, FacePacket& faces) {
    if (placement.has_identity_linear())
        place_points_by<true>(placement, local, faces.anchor, faces.offset);
    else
        place_points_by<false>(placement, local, faces.anchor, faces.offset);
}

void PacketPaths::turn_normals(const Transform& placement, const NormalBatch& normals, FacePacket& faces) {
    if (are_alike(normals)) {
        const Normal unit = normalize(placement.to_parent(Normal(normals.x[0], normals.y[0], normals.z[0])));
        for (int i = 0; i < width; ++i) faces.outward.set(i, unit);
    } else if (placement.has_identity_linear()) {
        find_unit_normals<true>(placement, normals, faces.outward);
    } else {
        find_unit_normals<false>(placement, normals, faces.outward);
    }
    turn_against_rays(faces);
    faces.is_mirrored = !world_.features.relief;
}

MatterSite PacketPaths::site_of(const FacePacket& faces, int lane) const {
    return {{to_point(faces.anchor[lane]), faces.offset[lane]}, tracer_.pixel_footprint * faces.travelled[lane]};
}

// As if the same matter lay behind.
void PacketPaths::FacePacket::set_matter(int lane, const Matter& matter) {
    colour.set(lane, matter.colour);
    reflection[lane] = matter.reflection, shininess[lane] = matter.shininess;
    opacity[lane] = matter.opacity, index_behind[lane] = matter.refraction;
}

void PacketPaths::FacePacket::copy_matter(int lane, int from) {
    colour.set(lane, colour[from]);
    reflection[lane] = reflection[from], shininess[lane] = shininess[from];
    opacity[lane] = opacity[from], index_behind[lane] = index_behind[from];
}

namespace {

// Where the matter of faces is to be sampled, in its own space: on the solid side, which is behind but for rays that leave it.
template <bool identity, bool keeps_shapes, class Faces>
[[gnu::noinline]] void find_sites(const PlacedTexture& texture, double pixel_footprint, const Faces& __restrict faces,
                                  SiteBatch& __restrict sites) {
    const TwoPartPoint& centre = texture.placement.centre();
    const Matrix3& inverse = texture.placement.inverse_linear();
    const double scale = texture.scale;
    const std::int64_t leaving = faces.leaving;
    for (int i = 0; i < PacketPaths::width; ++i) {
        const Vector beyond = ahead(faces.arriving[i], Normal(faces.geometric[i]));
        const double side = (leaving & bit_of(i)) != 0 ? -1 : 1;
        const TwoPartPoint point{to_point(faces.anchor[i]), faces.offset[i]};
        const double footprint = pixel_footprint * faces.travelled[i] * scale;
        const Point beside = point_beside<identity, keeps_shapes>(point - centre, footprint, side * beyond, inverse, scale);
        sites.points.x[i] = beside.x, sites.points.y[i] = beside.y, sites.points.z[i] = beside.z;
        sites.footprint[i] = footprint;
    }
}

// That of a batch; lanes without a face get the first one's.
template <class Faces>
[[gnu::noinline]] void take_matter(const MatterBatch& __restrict matter, Faces& __restrict faces) {
    const auto take = [count = faces.count](const double* __restrict values, double* __restrict taken) {
        for (int i = 0; i < PacketPaths::width; ++i) {
            const double own = values[i], first = values[0];
            taken[i] = i < count ? own : first;
        }
    };
    take(matter.r, faces.colour.r.v.data()), take(matter.g, faces.colour.g.v.data()), take(matter.b, faces.colour.b.v.data());
    take(matter.reflection, faces.reflection.v.data()), take(matter.shininess, faces.shininess.v.data());
    take(matter.opacity, faces.opacity.v.data()), take(matter.refraction, faces.index_behind.v.data());
}

}  // namespace

// matter_beside() for all lanes.
void PacketPaths::give_matter(const MaterialInstance& material, FacePacket& faces) {
    if (material.is_uniform()) {
        const Matter matter = material.matter();
        for (int i = 0; i < width; ++i) faces.set_matter(i, matter);
        faces.transparent = matter.is_transparent() ? faces.lanes() : 0;
        return;
    }
    const PlacedTexture& texture = *material.texture;
    SiteBatch sites;
    const auto find = texture.placement.has_identity_linear() ? find_sites<true, true, FacePacket>
                      : texture.placement.keeps_shapes()      ? find_sites<false, true, FacePacket>
                                                              : find_sites<false, false, FacePacket>;
    find(texture, tracer_.pixel_footprint, faces, sites);
    MatterBatch matter;
    texture.material->evaluate_batch(sites, faces.lanes(), matter);
    take_matter(matter, faces);
    faces.transparent |= positive_lanes(faces.index_behind) & faces.lanes();
    if (!world_.features.relief) return;
    for (int i = 0; i < faces.count; ++i) {
        const Normal geometric(faces.geometric[i]);
        faces.shading.set(i, Tracer::Implementation::bent_normal(faces.arriving[i], geometric, material, matter.relief(i)));
    }
}

// What is not plain is asked of the single ray.
void PacketPaths::meet_single_face(Wave& wave, int ray, std::span<FirstFace> first) {
    const Ray single = wave.ray(ray);
    Boundary boundary;
    boundary.t = wave.t(ray), boundary.solid = wave.solid(ray), boundary.leaf = wave.leaf(ray);
    boundary.starts_inside = wave.starts_inside(ray);
    tracer_.ray_through_world.start(single);
    if (!boundary.is_sheet()) tracer_.ray_through_world.complete_opaque(boundary);
    FirstFace* sample = first.empty() ? nullptr : &first[static_cast<std::size_t>(ray)];
    const Path& path = wave.paths[ray];
    const std::optional<Encounter> encounter = tracer_.encounter_face(single, boundary, path.travelled, sample);
    if (!encounter) {
        // A boundary without a face is one that rounding undid: the single path knows how to go on.
        wave.colours[ray] = tracer_.radiance(single, path, sample);
        return;
    }
    add_single_face(wave, ray, *encounter);
}

void PacketPaths::add_single_face(Wave& wave, int ray, const Encounter& encounter) {
    if (!single_faces_ || single_faces_->is_full()) single_faces_ = &new_faces();
    single_faces_->add(wave, ray, encounter);
    single_faces_->light_samples[single_faces_->count - 1] = tracer_.extended_lights * wave.paths[ray].faces;
}

void PacketPaths::FacePacket::add(const Wave& wave, int number, const Encounter& e) {
    const int lane = count++;
    ray[lane] = number;
    anchor.set(lane, e.point.anchor), offset.set(lane, e.point.offset);
    const Point rounded = e.point.rounded();
    points.x[lane] = rounded.x, points.y[lane] = rounded.y, points.z[lane] = rounded.z;
    const RayPacket& rays = wave.rays[number / width];
    arriving.set(lane, rays.direction[number % width]);
    outward.set(lane, e.outward), geometric.set(lane, e.geometric), shading.set(lane, e.shading);
    travelled[lane] = e.travelled;
    set_matter(lane, e.matter);
    departure.set(lane, e.departure);
    departure.cell[static_cast<std::size_t>(lane)] = e.cell_before, cell_behind[lane] = e.cell_behind;
    transparent |= static_cast<unsigned>(e.matter.is_transparent()) << lane;
    sheets |= static_cast<unsigned>(e.is_sheet) << lane;
    index_before[lane] = e.index_before, index_behind[lane] = e.index_behind;
    key[lane] = rays.key[number % width];
}

void PacketPaths::FacePacket::depart(const VectorLanes& __restrict directions, RayPacket& __restrict rays) const {
    rays.count = width, rays.departs = true;
    rays.anchor = anchor, rays.offset = offset, rays.direction = directions;
    rays.departure = departure, rays.key = key;
    std::int64_t behind = 0;
    for (int i = 0; i < width; ++i) {
        rays.departure.inward[static_cast<std::size_t>(i)] = dot(directions[i], outward[i]) < 0;
        behind |= dot(directions[i], geometric[i]) > 0 ? 0 : bit_of(i);
    }
    for (unsigned rest = transparent & static_cast<unsigned>(behind); rest != 0; rest &= rest - 1) {
        const auto i = static_cast<std::size_t>(std::countr_zero(rest));
        rays.departure.cell[i] = cell_behind[i];
    }
}

// The lanes without a face get what arithmetic can take.
void PacketPaths::FacePacket::fill_up() {
    for (int lane = count; lane < width; ++lane) {
        points.x[lane] = points.x[0], points.y[lane] = points.y[0], points.z[lane] = points.z[0];
        arriving.set(lane, arriving[0]), outward.set(lane, outward[0]);
        anchor.set(lane, anchor[0]), offset.set(lane, offset[0]);
        geometric.set(lane, geometric[0]), shading.set(lane, shading[0]);
        departure.set(lane, departure[0]), key[static_cast<std::size_t>(lane)] = key[0];
        copy_matter(lane, 0);
    }
}

// ---- lights ----------------------------------------------------------------------------------------------------------

// Faces of camera rays lie close together, so that little stands between all of them and a light. The fewer faces, the less it
// is; but where rays see many solids it is much for any faces, and those of small solids had rather be many, so that shadow rays
// find company.
void PacketPaths::light_faces(std::size_t depth) {
    constexpr std::size_t few_solids = 8, few_packets = 8;
    const SolidsInReach* seen = in_reach_of(depth);
    const bool are_close = seen && seen->are_known, see_few = are_close && seen->bounded.size() <= few_solids;
    for (std::size_t p = 0; p < face_packets_; ++p) begin_light(*faces_[p]);
    const FacePackets all(faces_.data(), face_packets_);
    const std::size_t at_once = see_few ? few_packets : face_packets_;
    for (std::size_t begin = 0; begin < face_packets_ && !tracer_.is_stopped(); begin += at_once)
        light_faces(all.subspan(begin, std::min(at_once, face_packets_ - begin)), are_close);
}

void PacketPaths::light_faces(FacePackets packets, bool are_close) {
    waiting_.rays.clear(), dimmed_.rays.clear();
    const Bounds bounds = bounds_of(packets);
    AimedLights aimed;
    for (const auto& light : world_.lights) {
        if (!light->may_reach(bounds)) {
            pass_over(*light, packets);
            continue;
        }
        const std::optional<Bounds> place = are_close ? light->place() : std::nullopt;
        before_light_ = nullptr;
        for (const std::unique_ptr<FacePacket>& faces : packets) {
            aim(*light, *faces, aimed);
            if (aimed.arrives == 0) continue;
            if (place && !before_light_) {
                to_light_.begin(bounds, *place);
                before_light_ = &to_light_.solids();
            }
            send_shadow_rays(*faces, aimed);
        }
        cast_waiting_shadows();
        cast_dimmed_shadows();
    }
}

// A light that reaches no face; samples are numbered as if it did.
void PacketPaths::pass_over(const Light& light, FacePackets packets) {
    for (const std::unique_ptr<FacePacket>& faces : packets) {
        tracer_.statistics.shadow_rays_skipped += static_cast<std::uint64_t>(faces->count);
        for (int i = 0; light.has_extent() && i < faces->count; ++i) ++faces->light_samples[i];
    }
}

namespace {

[[gnu::noinline]] void take_in(const PointBatch& __restrict points, PointBatch& __restrict low, PointBatch& __restrict high) {
    const auto widen = [](double p, double& least, double& most) {
        least = p < least ? p : least;
        most = p > most ? p : most;
    };
    for (int i = 0; i < RayPacket::width; ++i) {
        widen(points.x[i], low.x[i], high.x[i]);
        widen(points.y[i], low.y[i], high.y[i]);
        widen(points.z[i], low.z[i], high.z[i]);
    }
}

}  // namespace

Bounds PacketPaths::bounds_of(FacePackets packets) {
    PointBatch low = packets.front()->points, high = low;
    for (const std::unique_ptr<FacePacket>& faces : packets.subspan(1)) take_in(faces->points, low, high);
    return {{least(low.x), least(low.y), least(low.z)}, {largest(high.x), largest(high.y), largest(high.z)}};
}

void PacketPaths::begin_light(FacePacket& faces) {
    if (!faces.is_mirrored) mirror_at_shading_normals(faces);
    for (int i = 0; i < width; ++i)
        faces.ambient.set(i, Colour::black()), faces.diffuse.set(i, Colour::black()), faces.highlight.set(i, Colour::black());
    for (const auto& ambient : world_.ambient_lights) {
        IlluminationBatch all_around;
        ambient->toward_batch(faces.points, middle_of_light, width, &all_around);
        for (int i = 0; i < width; ++i) {
            faces.ambient.r[i] += all_around.r[i];
            faces.ambient.g[i] += all_around.g[i];
            faces.ambient.b[i] += all_around.b[i];
        }
    }
}

namespace {

// What holds in which lanes of a packet: bit i for lane i.
struct AimedLanes {
    unsigned lit;      // the light may fall on the face as it is shaded
    unsigned faced;    // and on the true one
    unsigned shining;  // a highlight may show
};

// The cosines of the angles between light and shading normal, and between light and mirrored ray.
template <class Faces>
AimedLanes find_angles(const Faces& __restrict faces, const IlluminationBatch& __restrict light, Lanes& __restrict cosine,
                       Lanes& __restrict along_mirrored) {
    std::int64_t lit = 0, faced = 0, shining = 0;
    for (int i = 0; i < RayPacket::width; ++i) {
        const Vector direction = light.direction(i);
        const double to_normal = dot(faces.shading[i], direction);
        const double towards = dot(faces.mirrored[i], direction);
        cosine[i] = to_normal;
        along_mirrored[i] = towards > 0 ? towards : 0;
        const double facing = dot(faces.geometric[i], direction);
        const double total = std::fabs(light.r[i]) + std::fabs(light.g[i]) + std::fabs(light.b[i]);
        const bool has_radiance = !(total <= 0);
        lit |= both(has_radiance, to_normal > 0) ? bit_of(i) : 0;
        faced |= facing > 0 ? bit_of(i) : 0;
        shining |= power_vanishes(along_mirrored[i], faces.shininess[i]) ? 0 : bit_of(i);
    }
    return {static_cast<unsigned>(lit), static_cast<unsigned>(faced), static_cast<unsigned>(shining)};
}

// highlight() for the lanes that are lit; the others get numbers without meaning. Faces of the same matter have the same
// shininess: then it is whole_power() for all lanes.
void find_highlights(const Lanes& cosine, const Lanes& shininess, unsigned lit, Lanes& highlights) {
    const double exponent = shininess[0];
    std::int64_t same = 0;
    for (int i = 0; i < RayPacket::width; ++i) same += shininess[i] == exponent;
    if (same < RayPacket::width || !is_small_whole(exponent)) {
        highlights.v.fill(0);
        for (unsigned rest = lit; rest != 0; rest &= rest - 1) {
            const int i = std::countr_zero(rest);
            highlights[i] = highlight(cosine[i], shininess[i]);
        }
        return;
    }
    Lanes square = cosine, power;
    power.v.fill(1);
    for (int n = static_cast<int>(exponent); n > 0; n >>= 1) {
        for (int i = 0; (n & 1) != 0 && i < RayPacket::width; ++i) power[i] *= square[i];
        for (int i = 0; i < RayPacket::width; ++i) square[i] *= square[i];
    }
    for (int i = 0; i < RayPacket::width; ++i) highlights[i] = power_vanishes(cosine[i], exponent) ? 0 : power[i];
}

}  // namespace

// Places on a light with extent, for the faces of a packet.
LightSampleBatch PacketPaths::light_samples(FacePacket& faces) {
    LightSampleBatch samples = middle_of_light;
    for (int i = 0; i < faces.count; ++i) {
        const SamplePair pair = sample_pair(faces.key[i], dimension_pair::first_light + faces.light_samples[i]++);
        samples.u[i] = pair.u, samples.v[i] = pair.v;
    }
    return samples;
}

// Tracer::Implementation::aim for all lanes.
void PacketPaths::aim(const Light& light, FacePacket& faces, AimedLights& aimed) {
    IlluminationBatch& light_at = aimed.illumination;
    light.toward_batch(faces.points, light.has_extent() ? light_samples(faces) : middle_of_light, width, &light_at);

    Lanes cosine, along_mirrored;
    const AimedLanes lanes = find_angles(faces, light_at, cosine, along_mirrored);
    const unsigned lit = lanes.lit & faces.lanes();
    if ((lanes.shining & lit) != 0)
        find_highlights(along_mirrored, faces.shininess, lit, aimed.highlight);
    else
        aimed.highlight.v.fill(0);
    for (int i = 0; i < width; ++i) {
        const double rest = cosine[i] - aimed.highlight[i];
        aimed.diffuse[i] = rest > 0 ? rest : 0;
    }
    for (unsigned rest = faces.transparent; rest != 0; rest &= rest - 1) {
        const int i = std::countr_zero(rest);
        if (!(faces.opacity[i] > 0)) aimed.diffuse[i] = 0;
    }
    // Without a highlight all that is lit shows, unless it is clear.
    unsigned shows = lit;
    if ((lanes.shining & lit) != 0 || faces.transparent != 0)
        shows &= positive_lanes(aimed.highlight) | positive_lanes(aimed.diffuse);
    const unsigned lit_through = faces.transparent & ~faces.sheets;
    aimed.arrives = shows & (lanes.faced | lit_through);
    tracer_.statistics.shadow_rays_skipped += static_cast<std::uint64_t>(faces.count - std::popcount(aimed.arrives));
}

// Shadow rays to a light for all lanes.
void PacketPaths::aim_shadow_rays(const FacePacket& __restrict faces, const AimedLights& __restrict aimed,
                                  AimedShadows& __restrict shadows) {
    const IlluminationBatch& light = aimed.illumination;
    VectorLanes directions;
    for (int i = 0; i < width; ++i) directions.set(i, light.direction(i));
    faces.depart(directions, shadows.rays);
    for (int i = 0; i < width; ++i) {
        const bool is_sent = (aimed.arrives & bit_of(i)) != 0;
        const double distance = end_before_light(faces.points.point(i), light.distance[i]);
        shadows.distances[i] = is_sent ? distance : -1;
    }
}

// Of a packet that the light may reach. Rays of one that is nearly full go at once; the others wait for company.
void PacketPaths::send_shadow_rays(FacePacket& faces, const AimedLights& aimed) {
    constexpr int nearly_full = width / 2;
    if (are_clear(faces, aimed)) {
        tracer_.statistics.shadow_rays_spared += static_cast<std::uint64_t>(std::popcount(aimed.arrives));
        light_faces_of(aimed, aimed.arrives, faces);
        return;
    }
    aim_shadow_rays(faces, aimed, aimed_shadows_);
    if (std::popcount(aimed.arrives) < nearly_full) {
        for (unsigned rest = aimed.arrives; rest != 0; rest &= rest - 1) {
            waiting_.add(aimed_shadows_, aimed, faces, std::countr_zero(rest));
            if (waiting_.rays.is_full()) cast_waiting_shadows();
        }
        return;
    }
    const PacketThroughWorld::Shadows met = find_shadows(aimed_shadows_.rays, aimed_shadows_.distances);
    light_faces_of(aimed, aimed.arrives & ~(met.blocked | met.asked), faces);
    for (unsigned rest = aimed.arrives & met.asked & ~met.blocked; rest != 0; rest &= rest - 1) {
        if (dimmed_.rays.is_full()) cast_dimmed_shadows();
        dimmed_.add(aimed_shadows_, aimed, faces, std::countr_zero(rest));
    }
}

// Whether nothing lies between faces and a light for certain: of all that the ways to it come near, if anything, they leave the
// solid that they start on.
bool PacketPaths::are_clear(const FacePacket& faces, const AimedLights& aimed) const {
    if (!before_light_ || !before_light_->are_known || !faces.depart_alike) return false;
    std::int64_t inward = 0;
    for (int i = 0; i < width; ++i) {
        inward |= dot(aimed.illumination.direction(i), faces.outward[i]) < 0 ? bit_of(i) : 0;
    }
    const unsigned inward_sent = static_cast<unsigned>(inward) & aimed.arrives;
    if (inward_sent != 0 && inward_sent != aimed.arrives) return false;
    Departure departure = faces.departure[0];
    departure.inward = inward_sent != 0;
    return packet_.are_clear(departure, *before_light_);
}

PacketThroughWorld::Shadows PacketPaths::find_shadows(const RayPacket& rays, const Lanes& distances) {
    for (const double distance : distances.v) tracer_.statistics.shadow_rays += distance >= 0 ? 1 : 0;
    if (world_.features.transparency) return packet_.shadows(rays, distances, before_light_);
    return {packet_.blocked(rays, distances, before_light_), 0};
}

void PacketPaths::Shadows::add(const AimedShadows& shadows, const AimedLights& lights, FacePacket& to, int from) {
    const int ray = rays.count;
    rays.add(shadows.rays.ray(from));
    distances[ray] = shadows.distances[from], to_light[ray] = lights.illumination.distance[from];
    radiance.set(ray, lights.radiance(from));
    diffuse[ray] = lights.diffuse[from], highlight[ray] = lights.highlight[from];
    faces[static_cast<std::size_t>(ray)] = &to, lane[static_cast<std::size_t>(ray)] = from;
}

void PacketPaths::Shadows::take(const Shadows& other, int from) {
    const int ray = rays.count;
    rays.add(other.rays.ray(from));
    distances[ray] = other.distances[from], to_light[ray] = other.to_light[from];
    radiance.set(ray, other.radiance[from]);
    diffuse[ray] = other.diffuse[from], highlight[ray] = other.highlight[from];
    faces[static_cast<std::size_t>(ray)] = other.faces[static_cast<std::size_t>(from)];
    lane[static_cast<std::size_t>(ray)] = other.lane[static_cast<std::size_t>(from)];
}

void PacketPaths::cast_waiting_shadows() {
    RayPacket& rays = waiting_.rays;
    if (rays.count == 0) return;
    rays.fill_up();
    for (int i = rays.count; i < width; ++i) waiting_.distances[i] = -1;
    const PacketThroughWorld::Shadows met = find_shadows(rays, waiting_.distances);
    for (unsigned rest = rays.lanes() & ~met.blocked; rest != 0; rest &= rest - 1) {
        const int lane = std::countr_zero(rest);
        if ((met.asked >> lane & 1) == 0) {
            light_face(waiting_, lane, Colour::white());
            continue;
        }
        if (dimmed_.rays.is_full()) cast_dimmed_shadows();
        dimmed_.take(waiting_, lane);
    }
    rays.clear();
}

// light_face() for lanes that nothing dims.
void PacketPaths::light_faces_of(const AimedLights& __restrict aimed, unsigned lanes, FacePacket& __restrict faces) {
    const IlluminationBatch& light = aimed.illumination;
    Lanes is_lit;
    for (int i = 0; i < width; ++i) is_lit[i] = (lanes & bit_of(i)) != 0 ? 1 : 0;
    for (int i = 0; i < width; ++i) {
        const bool lit = is_lit[i] != 0;
        const double diffuse = aimed.diffuse[i], highlight = aimed.highlight[i];
        faces.diffuse.r[i] += lit ? diffuse * light.r[i] : 0, faces.highlight.r[i] += lit ? highlight * light.r[i] : 0;
        faces.diffuse.g[i] += lit ? diffuse * light.g[i] : 0, faces.highlight.g[i] += lit ? highlight * light.g[i] : 0;
        faces.diffuse.b[i] += lit ? diffuse * light.b[i] : 0, faces.highlight.b[i] += lit ? highlight * light.b[i] : 0;
    }
}

void PacketPaths::light_face(const Shadows& shadows, int ray, const Colour& passed) {
    const Colour arrives = shadows.radiance[ray] * passed;
    FacePacket& faces = *shadows.faces[static_cast<std::size_t>(ray)];
    const int lane = shadows.lane[static_cast<std::size_t>(ray)];
    faces.diffuse.add(lane, shadows.diffuse[ray] * arrives);
    faces.highlight.add(lane, shadows.highlight[ray] * arrives);
}

// ---- colours ---------------------------------------------------------------------------------------------------------

namespace {

template <bool some_transparent, class Faces>
[[gnu::noinline]] void find_colours(const Faces& __restrict faces, ColourLanes& __restrict shown) {
    const std::int64_t transparent = faces.transparent;
    for (int i = 0; i < PacketPaths::width; ++i) {
        const Colour highlight = faces.highlight[i];
        const Colour local = faces.colour[i] * (faces.ambient[i] + faces.diffuse[i]) + highlight;
        const double rest = 1 - faces.reflection[i], opacity = faces.opacity[i];
        const Colour opaque = rest * local, clear = rest * (opacity * local + (1 - opacity) * highlight);
        const bool is_clear = both(some_transparent, (transparent & bit_of(i)) != 0);
        shown.r[i] = is_clear ? clear.r : opaque.r;
        shown.g[i] = is_clear ? clear.g : opaque.g;
        shown.b[i] = is_clear ? clear.b : opaque.b;
    }
}

}  // namespace

// Without what mirrored and refracted rays bring.
void PacketPaths::show_colours(const FacePacket& faces, ColourLanes& shown) {
    if (faces.transparent == 0)
        find_colours<false>(faces, shown);
    else
        find_colours<true>(faces, shown);
}

// Local colours, and the mirrored rays of the next wave.
void PacketPaths::finish_colours(std::size_t depth) {
    Wave& wave = *waves_[depth];
    if (world_.features.reflection && waves_.size() <= depth + 1) waves_.push_back(std::make_unique<Wave>());
    if (waves_.size() > depth + 1) waves_[depth + 1]->clear();
    for (std::size_t p = 0; p < face_packets_; ++p) {
        FacePacket& faces = *faces_[p];
        ColourLanes shown;
        show_colours(faces, shown);
        for (int i = 0; i < faces.count; ++i) wave.colours[faces.ray[i]] = shown[i];
        if (world_.features.reflection) mirror_rays(faces, wave, *waves_[depth + 1]);
    }
}

// Tracer::Implementation::turned_out for all lanes: seldom one is turned.
void PacketPaths::turn_mirrored_out(FacePacket& faces) {
    std::int64_t below = 0;
    for (int i = 0; i < width; ++i) below |= dot(faces.mirrored[i], faces.geometric[i]) < 0 ? bit_of(i) : 0;
    for (auto rest = static_cast<unsigned>(below); rest != 0; rest &= rest - 1) {
        const int i = std::countr_zero(rest);
        faces.mirrored.set(i, Tracer::Implementation::turned_out(faces.mirrored[i], Normal(faces.geometric[i])));
    }
}

void PacketPaths::mirror_rays(FacePacket& faces, Wave& wave, Wave& next) {
    const unsigned mirroring = positive_lanes(faces.reflection) & faces.lanes();
    if (mirroring == 0) return;
    tracer_.statistics.mirrored_rays += static_cast<std::uint64_t>(std::popcount(mirroring));
    turn_mirrored_out(faces);
    RayPacket rays;
    faces.depart(faces.mirrored, rays);
    for (unsigned rest = mirroring; rest != 0; rest &= rest - 1) {
        const int lane = std::countr_zero(rest), sender = faces.ray[lane];
        const double reflection = faces.reflection[lane];
        const Path& path = wave.paths[sender];
        const Path onward{path.weight * reflection, path.depth + 1, faces.travelled[lane], 2 * path.branch, path.faces + 1};
        if (onward.ends(tracer_.settings)) {
            wave.colours[sender] += reflection * world_.background;
            continue;
        }
        next.sender[next.count] = sender, next.reflection[next.count] = reflection;
        next.paths[next.count] = onward;
        next.own_rays[next.count / width].add(rays, lane);
        ++next.count;
    }
}

}  // namespace lapidary
