// SPDX-License-Identifier: MIT
//
// Scene -> text of the scene language, for the log. The text is itself a scene that builds to the same Scene, bit for
// bit: numbers are written with as many digits as it takes, angles in radians, and what is shared is written once, at
// the top, and then referred to by its name.
#pragma once

#include <string>

#include "kernel/export.h"
#include "kernel/scene/scene.h"

namespace lapidary {

LAPIDARY_API std::string print_scene(const Scene& scene);

}  // namespace lapidary
