// SPDX-License-Identifier: MIT
//
// Where plugins are looked for, first match wins:
//
//     1. the folders of --plugin-path, in the order given
//     2. `plugins "folder";` in the scene (the registry inserts these)
//     3. LAPIDARY_PLUGIN_PATH, separated by colons
//     4. `plugin_path:` of the user's configuration, then of the project's
//     5. the installed folder beside the program, and the one beside the kernel's library
//
// The dynamic loader's own LD_LIBRARY_PATH plays no part.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "kernel/export.h"

namespace lapidary {

struct SearchPathSources {
    std::vector<std::filesystem::path> command_line;
    std::vector<std::filesystem::path> user_configuration;
    std::vector<std::filesystem::path> project_configuration;
};

struct SearchPath {
    std::vector<std::filesystem::path> folders;  // absolute, without repetitions
    std::size_t command_line_folders = 0;        // how many of them, at the front, come from the command line
};

// All of the above but the scene's. Folders that do not exist stay in it.
LAPIDARY_API SearchPath plugin_search_path(const SearchPathSources& sources);

// "a:b/c" -> a, b/c; empty parts are left out.
LAPIDARY_API std::vector<std::filesystem::path> split_path_list(std::string_view list);

// The folder of the kernel's own shared library; where it was taken from lib/glibc-hwcaps/LEVEL, lib.
LAPIDARY_API std::filesystem::path kernel_folder();

// The instruction set that the kernel was built for, "x86-64-v3": the dynamic loader has chosen the best that is there and that
// the machine has.
LAPIDARY_API std::string kernel_level();

}  // namespace lapidary
