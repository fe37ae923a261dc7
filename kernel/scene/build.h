// SPDX-License-Identifier: MIT
//
// Document -> Scene: keywords are looked up in the registry, properties checked against schemas, names resolved.
#pragma once

#include <memory>

#include "kernel/export.h"
#include "kernel/report/messages.h"
#include "kernel/scene/document.h"
#include "kernel/scene/scene.h"

namespace lapidary {

class Registry;

// Null where there were errors; all of them are in `messages`. `title` names the picture where the scene does not.
LAPIDARY_API std::shared_ptr<const Scene> build_scene(const Document& document, Registry& registry, const std::string& title,
                                                      Messages& messages);

}  // namespace lapidary
