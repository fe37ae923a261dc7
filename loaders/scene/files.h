// SPDX-License-Identifier: MIT
//
// Finds and reads the files that make up a scene.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lapidary::scene_language {

// Either the text of a file, without a byte order mark, or why it could not be read.
struct FileText {
    std::string text;
    std::string failure;  // "cannot read …", empty where all went well
};

std::string without_byte_order_mark(std::string text);
FileText read_file(const std::filesystem::path& file);

struct FoundFile {
    std::filesystem::path file;                // empty: found nowhere
    std::vector<std::filesystem::path> tried;  // in this order
};

// The name as it stands, where it is absolute; else in the folder of the including file, then along the path.
FoundFile find_include(std::string_view name, const std::filesystem::path& including_file,
                       const std::vector<std::filesystem::path>& include_path);

// Names of the files beside those that were tried, for suggestions.
std::vector<std::string> neighbours(const std::vector<std::filesystem::path>& tried);

// Two names of one file give the same identity.
std::filesystem::path identity_of(const std::filesystem::path& file);

}  // namespace lapidary::scene_language
