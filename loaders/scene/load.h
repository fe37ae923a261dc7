// SPDX-License-Identifier: MIT
//
// Reads a file of the scene language into a Document. Never throws and never stops at the first error.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "kernel/report/messages.h"
#include "kernel/scene/document.h"

namespace lapidary {

struct LoadOptions {
    std::vector<std::filesystem::path> include_path;  // searched after the including file's folder
    std::uint64_t max_items = 10'000'000;             // what `repeat` and `include` may produce
};

Document load_scene_file(const std::filesystem::path& file, const LoadOptions& options, Messages& messages);
// The same from memory; includes are looked up relative to `name`.
Document load_scene_text(std::string name, std::string text, const LoadOptions& options, Messages& messages);

}  // namespace lapidary
