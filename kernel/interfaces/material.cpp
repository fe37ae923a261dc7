// SPDX-License-Identifier: MIT
//
// Anchors the vtable of Material in the kernel; by default matter changes abruptly nowhere.
#include "kernel/interfaces/material.h"

namespace lapidary {

Material::~Material() = default;

Crossing Material::next_boundary(const MaterialLine&, double, double) const { return {}; }

std::uint64_t Material::region(const Point&) const { return 0; }

double Material::clearance(const Point&) const { return infinity; }

}  // namespace lapidary
