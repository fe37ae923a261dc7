// SPDX-License-Identifier: MIT
//
// Objects and CSG operations.
#pragma once

#include "kernel/scene/build_context.h"

namespace lapidary {

// A CSG operation. Null where there were errors.
SceneNodePtr build_operation(const Block& block, Operation operation, bool needs_use, BuildContext& context);

// A block whose keyword is an object plugin's.
SceneNodePtr build_leaf(const Block& block, const Plugin& plugin, bool needs_use, BuildContext& context);

// The `objects` block: a union. Its direct items only define their names where the block is not the one rendered.
SceneNodePtr build_objects(const Block& block, bool is_rendered, BuildContext& context);

}  // namespace lapidary
