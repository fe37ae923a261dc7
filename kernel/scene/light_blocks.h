// SPDX-License-Identifier: MIT
//
// Lights and `lights { … }`.
#pragma once

#include "kernel/scene/build_context.h"

namespace lapidary {

// A block whose keyword is a light plugin's, not yet placed. Null where there were errors.
LightPrototypePtr build_light(const Block& block, const Plugin& plugin, bool needs_use, BuildContext& context);

// A `lights` block: its lights, placed in the world, are added to `lights`.
void build_lights(const Block& block, std::vector<SceneLight>& lights, BuildContext& context);

}  // namespace lapidary
