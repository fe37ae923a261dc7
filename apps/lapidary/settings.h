// SPDX-License-Identifier: MIT
//
// `--set block.property=value`: a change to the scene as it was read, before anything is looked up. The value is
// written as between the parentheses of the property: camera.location=0,1,-5, camera.screen.size=2,1.5,
// background=0,0,0.2, ball.radius=2 for a block named ball.
#pragma once

#include <memory>
#include <string>

#include "kernel/report/messages.h"
#include "kernel/scene/document.h"

namespace lapidary {

// Replaces the property wherever it is written in the block, or adds it; a block that is not there is added at the top
// level. Messages about it are placed in the setting itself. Returns what those places point into.
std::shared_ptr<Sources> apply_setting(const std::string& setting, Document& document, Messages& messages);

}  // namespace lapidary
