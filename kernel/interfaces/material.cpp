// SPDX-License-Identifier: MIT
//
// Anchors the vtable of Material in the kernel; by default matter changes abruptly nowhere. Counts what textures leave out.
#include "kernel/interfaces/material.h"

#include <bit>

namespace lapidary {

namespace {

thread_local std::uint64_t octaves_faded = 0;

// The same matter in these lanes.
void fill(const Matter& from, unsigned lanes, MatterBatch& __restrict to) {
    const std::int64_t asked = lanes;
    for (int lane = 0; lane < batch_size; ++lane) {
        const bool is_asked = (asked & bit_of(lane)) != 0;
        const Matter old = to.matter(lane);
        const auto choose = [is_asked](double now, double before) { return is_asked ? now : before; };
        to.r[lane] = choose(from.colour.r, old.colour.r);
        to.g[lane] = choose(from.colour.g, old.colour.g);
        to.b[lane] = choose(from.colour.b, old.colour.b);
        to.reflection[lane] = choose(from.reflection, old.reflection);
        to.refraction[lane] = choose(from.refraction, old.refraction);
        to.shininess[lane] = choose(from.shininess, old.shininess);
        to.opacity[lane] = choose(from.opacity, old.opacity);
        to.depth[lane] = choose(from.depth, old.depth);
        to.set_relief(lane, {choose(from.relief.x, old.relief.x), choose(from.relief.y, old.relief.y),
                             choose(from.relief.z, old.relief.z)});
    }
}

}  // namespace

Material::~Material() = default;

void Material::evaluate_batch(const SiteBatch& sites, unsigned lanes, MatterBatch& matter) const {
    if (is_uniform()) {
        fill(evaluate(sites.site(std::countr_zero(lanes))), lanes, matter);
        return;
    }
    for_each_lane(lanes, [&](int lane) { matter.set(lane, evaluate(sites.site(lane))); });
}

Crossing Material::next_boundary(const MaterialLine&, double, double) const { return {}; }

std::uint64_t Material::region(const Point&) const { return 0; }

double Material::clearance(const Point&) const { return infinity; }

void count_faded_octaves(int octaves) { octaves_faded += static_cast<std::uint64_t>(octaves); }

std::uint64_t octaves_faded_by_thread() { return octaves_faded; }

}  // namespace lapidary
