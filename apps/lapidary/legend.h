// SPDX-License-Identifier: MIT
//
// What objects and materials are called, for who points at them in the picture.
#pragma once

#include <memory>

#include "kernel/interfaces/output.h"

namespace lapidary {

class World;

// By the names that the user gave; else by keyword and place: "sphere on line 7", "bricks on line 3 of wall.inc".
std::shared_ptr<const Legend> legend_of(const World& world);

}  // namespace lapidary
