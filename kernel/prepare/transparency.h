// SPDX-License-Identifier: MIT
//
// What packets of rays want to know of the solids of a World with transparent matter: of what the inside of each is made, and
// what it does to shadows.
#pragma once

#include "kernel/prepare/world.h"

namespace lapidary {

// Fills in the World's insides, and fits_lanes and shadow of its solids. The World is otherwise complete.
void note_transparency(World& world);

}  // namespace lapidary
