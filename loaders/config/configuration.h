// SPDX-License-Identifier: MIT
//
// Defaults that users and projects keep in files, so that they need not stand on every command line:
//
//     # ~/.config/lapidary/config.yaml ($XDG_CONFIG_HOME is honoured), and lapidary.yaml in the working folder
//     plugin_path: [~/lapidary/plugins, plugins]   # a folder or a list; relative to this file
//     include_path: scenes/parts
//     threads: 4                                   # 0: as many as the machine has
//
// The reader of YAML is a module of its own, opened only when one of the two files exists.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "kernel/report/messages.h"
#include "kernel/report/place.h"

namespace lapidary {

// What one file says.
struct Configuration {
    std::vector<std::filesystem::path> plugin_path;   // absolute
    std::vector<std::filesystem::path> include_path;  // absolute
    std::optional<int> threads;
};

struct Configurations {
    Configuration user, project;

    // The project knows better than the user's habits; nothing where neither says.
    std::optional<int> threads() const { return project.threads ? project.threads : user.threads; }
    // The user's folders, then the project's.
    std::vector<std::filesystem::path> include_path() const;
};

// Where the user's file is looked for; empty where there is no home.
std::filesystem::path user_configuration_file();
// Where the project's file is looked for.
std::filesystem::path project_configuration_file();

// Reads both files; one that does not exist says nothing.
Configurations load_configurations(Sources& sources, Messages& messages);
// Reads one file. Never throws.
Configuration load_configuration(const std::filesystem::path& file, Sources& sources, Messages& messages);

}  // namespace lapidary
