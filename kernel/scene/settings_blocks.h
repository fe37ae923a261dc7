// SPDX-License-Identifier: MIT
//
// The blocks and properties that describe no object: camera, output, render, background.
#pragma once

#include "kernel/scene/build_context.h"

namespace lapidary {

Camera build_camera(const Block& block, BuildContext& context);
OutputSettings build_output(const Block& block, BuildContext& context);
RenderSettings build_render(const Block& block, BuildContext& context);

// What the schemas of these blocks say, for checking, help and printing.
LAPIDARY_API const SchemaBase& camera_schema();
LAPIDARY_API const SchemaBase& screen_schema();
LAPIDARY_API const SchemaBase& output_schema();
LAPIDARY_API const SchemaBase& render_schema();

}  // namespace lapidary
