// SPDX-License-Identifier: MIT
//
// Anchors the vtable of Light in the kernel.
#include "kernel/interfaces/light.h"

namespace lapidary {

Light::~Light() = default;

}  // namespace lapidary
