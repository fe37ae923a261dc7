// SPDX-License-Identifier: MIT
//
// Finds, checks, opens and keeps the plugins that scenes name. The folder is the kind, the file's stem is the keyword;
// a library is opened when its keyword is first asked for, and stays open until exit.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "kernel/export.h"
#include "kernel/registry/plugin.h"

namespace lapidary {

class Object;
class Light;
class Output;

LAPIDARY_API std::string_view folder_of(PluginKind kind);  // "objects", "materials", "lights", "outputs"
LAPIDARY_API std::string_view name_of(PluginKind kind);    // "object", "material", "light", "output"

// A plugin that was opened and fits.
class LAPIDARY_API Plugin {
public:
    Plugin(PluginKind kind, std::string keyword, std::filesystem::path file, const PluginDescriptor& descriptor);

    PluginKind kind() const { return kind_; }
    const std::string& keyword() const { return keyword_; }
    const std::filesystem::path& file() const { return file_; }
    const SchemaBase& schema() const { return schema_; }

    // New, default-constructed. Throws std::runtime_error that names the plugin where its constructor throws.
    std::unique_ptr<Object> create_object() const;
    std::unique_ptr<Material> create_material() const;
    std::unique_ptr<Light> create_light() const;
    std::unique_ptr<Output> create_output() const;

private:
    PluginKind kind_;
    std::string keyword_;
    std::filesystem::path file_;
    const PluginDescriptor& descriptor_;
    const SchemaBase& schema_;
};

// One line of `lapidary plugins`.
struct PluginListing {
    PluginKind kind;
    std::string keyword;
    std::filesystem::path file;
    bool usable = false;
    bool hidden = false;  // another file of this kind and stem comes first on the path
    std::string reason;   // why it was refused
    std::string summary;  // of its schema
};

class LAPIDARY_API Registry {
public:
    // Folders in the order in which they are searched; each may hold objects/, materials/, lights/, outputs/. The first
    // few may come from the command line, before those of the scene.
    explicit Registry(std::vector<std::filesystem::path> search_path, std::size_t command_line_folders = 0);
    ~Registry();

    std::vector<std::filesystem::path> search_path() const;
    // Puts a folder behind those of --plugin-path and before the rest (`plugins "dir";` in a scene). What was opened
    // before stays what it is.
    void insert_scene_folder(const std::filesystem::path& folder);

    // Opens the plugin at first use. Null where there is none; `reason` then says why a file that is there was refused
    // (with its path), and stays empty where no file has this stem. Thread-safe.
    const Plugin* find(PluginKind kind, std::string_view keyword, std::string& reason);

    // The stems of all files of a kind, sorted, without opening any.
    std::vector<std::string> keywords(PluginKind kind) const;
    // Every file of every folder, opened and checked.
    std::vector<PluginListing> list() const;
    // The plugins opened so far.
    std::vector<const Plugin*> opened() const;

private:
    struct Slot;
    // The file that a keyword stands for, remembered; null where there is none.
    Slot* slot(PluginKind kind, std::string_view keyword);

    mutable std::mutex mutex_;
    std::vector<std::filesystem::path> search_path_;
    const std::size_t command_line_folders_;
    std::size_t scene_folders_ = 0;
    std::map<std::pair<PluginKind, std::string>, std::unique_ptr<Slot>> slots_;
};

}  // namespace lapidary
