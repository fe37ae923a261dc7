// SPDX-License-Identifier: MIT
//
// Anchors the vtable of Material in the kernel; by default matter changes abruptly nowhere. Counts what textures leave out.
#include "kernel/interfaces/material.h"

namespace lapidary {

namespace {

thread_local std::uint64_t octaves_faded = 0;

}  // namespace

Material::~Material() = default;

Crossing Material::next_boundary(const MaterialLine&, double, double) const { return {}; }

std::uint64_t Material::region(const Point&) const { return 0; }

double Material::clearance(const Point&) const { return infinity; }

void count_faded_octaves(int octaves) { octaves_faded += static_cast<std::uint64_t>(octaves); }

std::uint64_t octaves_faded_by_thread() { return octaves_faded; }

}  // namespace lapidary
