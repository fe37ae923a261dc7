// SPDX-License-Identifier: MIT
//
// Anchors the vtable of Output in the kernel; an output need not prepare anything nor watch the tiles.
#include "kernel/interfaces/output.h"

namespace lapidary {

Output::~Output() = default;

void Output::begin(const FrameInfo&) {}

void Output::prepare() {}

void Output::tile(const Frame&, const PixelRegion&) {}

}  // namespace lapidary
