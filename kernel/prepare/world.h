// SPDX-License-Identifier: MIT
//
// What the renderer needs of a scene, and nothing more: transforms accumulated to the leaves, coincident surfaces
// recognised, bounds, hierarchy, and the set of features that occur.
#pragma once

#include <memory>

#include "kernel/export.h"
#include "kernel/report/messages.h"
#include "kernel/scene/scene.h"

namespace lapidary {

class LAPIDARY_API World;

// Never fails: what cannot be used (an empty operand, a sheet that subtracts) is left out with a warning.
LAPIDARY_API std::shared_ptr<const World> prepare_world(const Scene& scene, Messages& messages);

}  // namespace lapidary
