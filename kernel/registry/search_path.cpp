// SPDX-License-Identifier: MIT
#include "kernel/registry/search_path.h"

#include <dlfcn.h>

#include <algorithm>
#include <cstdlib>
#include <system_error>

namespace lapidary {

namespace {

namespace fs = std::filesystem;

// The folder of the running program; empty where the system does not tell.
fs::path program_folder() {
    std::error_code error;
    return fs::read_symlink("/proc/self/exe", error).parent_path();
}

// Both lead to the same folder in an installation. The program's comes first: it may run with another kernel.
std::vector<fs::path> installed_plugin_folders() {
    std::vector<fs::path> folders;
    if (const fs::path program = program_folder(); !program.empty())
        folders.push_back(program.parent_path() / "lib" / "lapidary" / "plugins");
    if (const fs::path kernel = kernel_folder(); !kernel.empty()) folders.push_back(kernel / "lapidary" / "plugins");
    return folders;
}

// One spelling for one folder: absolute, links followed as far as they exist, no slash at the end.
fs::path absolute_folder(const fs::path& folder) {
    std::error_code error;
    fs::path absolute = fs::weakly_canonical(folder, error);
    if (error) absolute = fs::absolute(folder, error).lexically_normal();
    return absolute.has_filename() ? absolute : absolute.parent_path();
}

// The folder that the dynamic loader has taken this library from.
fs::path folder_of_this_library() {
    Dl_info library;
    if (dladdr(reinterpret_cast<const void*>(&folder_of_this_library), &library) == 0 || !library.dli_fname) return {};
    return absolute_folder(library.dli_fname).parent_path();
}

// Whether it is lib/glibc-hwcaps/LEVEL, where the loader looks first on a machine of that level.
bool is_of_level(const fs::path& folder) { return folder.parent_path().filename() == "glibc-hwcaps"; }

}  // namespace

std::vector<fs::path> split_path_list(std::string_view list) {
    std::vector<fs::path> folders;
    while (!list.empty()) {
        const std::string_view part = list.substr(0, list.find(':'));
        if (!part.empty()) folders.emplace_back(part);
        list.remove_prefix(std::min(part.size() + 1, list.size()));
    }
    return folders;
}

fs::path kernel_folder() {
    const fs::path folder = folder_of_this_library();
    return is_of_level(folder) ? folder.parent_path().parent_path() : folder;
}

std::string kernel_level() {
    const fs::path folder = folder_of_this_library();
    return is_of_level(folder) ? folder.filename().string() : LAPIDARY_FIRST_LEVEL;
}

SearchPath plugin_search_path(const SearchPathSources& sources) {
    SearchPath path;
    const auto append = [&path](const std::vector<fs::path>& folders) {
        for (const fs::path& folder : folders) {
            fs::path absolute = absolute_folder(folder);
            if (std::ranges::find(path.folders, absolute) == path.folders.end()) path.folders.push_back(std::move(absolute));
        }
    };
    append(sources.command_line);
    path.command_line_folders = path.folders.size();
    if (const char* list = std::getenv("LAPIDARY_PLUGIN_PATH")) append(split_path_list(list));
    append(sources.user_configuration);
    append(sources.project_configuration);
    append(installed_plugin_folders());
    return path;
}

}  // namespace lapidary
