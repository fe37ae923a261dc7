// SPDX-License-Identifier: MIT
//
// What is known about a render, and how it is told: a line for everybody, statistics for -v, and the log of -l.
//
// The log is itself a scene that gives the same picture: the scene as it was understood, after a comment with
// everything else.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/lapidary/commands.h"
#include "apps/lapidary/stages.h"
#include "kernel/registry/library.h"
#include "kernel/render/render.h"
#include "kernel/report/messages.h"
#include "kernel/scene/scene.h"

namespace lapidary {

class Plugin;
class World;

struct RenderRecord {
    Words words;                                  // the command line
    std::vector<std::string> files;               // read
    std::vector<const Plugin*> plugins;           // opened
    std::size_t plugins_passed_over = 0;          // that are there and were not opened
    Modules modules;                              // of the program
    std::shared_ptr<const Scene> scene;           // as rendered, with the command line's wishes; null where it has errors
    std::shared_ptr<const World> world;           // null where it did not come so far
    std::optional<PixelRegion> region;            // where not all was asked for
    std::optional<RenderReport> report;           // nothing where it did not come so far
    std::optional<double> stopped_after;          // seconds from the wish to the end of the work; nothing: no such wish
    std::vector<std::filesystem::path> pictures;  // written
    Stages stages;
};

// "640x480, 1.2 s; 99.8 % of the pixels within the error", for the end of a render.
std::string summary(const RenderRecord& record);
// What the scene became, what was counted, and how long each stage took, a line each.
std::vector<std::string> statistics(const RenderRecord& record);
std::string log_text(const RenderRecord& record, const std::vector<Message>& messages);

}  // namespace lapidary
