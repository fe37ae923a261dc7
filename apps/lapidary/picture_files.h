// SPDX-License-Identifier: MIT
//
// Which writers make which files of a picture.
//
// The formats are those of the command line (-b, -t), else the one that the extension of -o names, else the writers in
// the scene, else the one that the extension of the scene's name(…) names, else png. Where the scene has a writer of a
// format, its properties hold. A file is called by -o, else by the scene's name(…), else by the scene file; an extension
// of a known format makes room for the writer's own. Relative names start at the working folder.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "kernel/interfaces/output.h"
#include "kernel/registry/registry.h"
#include "kernel/report/messages.h"
#include "kernel/scene/scene.h"

namespace lapidary {

struct PictureFile {
    std::shared_ptr<Output> output;
    const Plugin* plugin = nullptr;
    std::filesystem::path path;  // empty for an output without a file
};

struct OutputChoice {
    std::filesystem::path name;        // -o; empty: not given
    std::vector<std::string> formats;  // -b, -t
};

// What cannot be is an error in the messages.
std::vector<PictureFile> choose_pictures(const Scene& scene, Registry& registry, const OutputChoice& choice, Messages& messages);

}  // namespace lapidary
