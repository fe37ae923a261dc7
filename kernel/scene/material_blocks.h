// SPDX-License-Identifier: MIT
//
// Materials: `material { … }`, texture trees, and constants in the place of textures.
#pragma once

#include "kernel/scene/build_context.h"

namespace lapidary {

// A `material` block. Null where there were errors.
SceneMaterialPtr build_material_block(const Block& block, bool needs_use, BuildContext& context);

// A block whose keyword is a material plugin's.
SceneMaterialPtr build_texture(const Block& block, const Plugin& plugin, bool needs_use, BuildContext& context);

// The plain matter that `colour` and `shininess` in an object stand for. What is painted alike, one after the other, is of one.
SceneMaterialPtr plain_material(const Colour& colour, double shininess, const Place& place, BuildContext& context);

}  // namespace lapidary
