// SPDX-License-Identifier: MIT
//
// What packets of rays want to know of the solids of a World with transparent matter: of what the inside of each is made, and
// what it does to shadows.
#pragma once

#include "kernel/prepare/world.h"

namespace lapidary {

// Fills in the solids' fits_lanes, owner, medium, priority and shadow. The World is otherwise complete.
void note_transparency(World& world);

}  // namespace lapidary
