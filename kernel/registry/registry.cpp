// SPDX-License-Identifier: MIT
#include "kernel/registry/registry.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cctype>
#include <exception>
#include <stdexcept>
#include <system_error>

#include "kernel/registry/library.h"
#include "kernel/registry/search_path.h"

namespace lapidary {

namespace {

namespace fs = std::filesystem;

constexpr PluginKind all_kinds[] = {PluginKind::object, PluginKind::material, PluginKind::light, PluginKind::output};
constexpr const char* descriptor_symbol = "lapidary_plugin";
constexpr const char* library_suffix = ".so";

// What a keyword of the scene language may be; nothing else is looked for on the disk.
bool is_keyword(std::string_view stem) {
    return !stem.empty() && std::ranges::all_of(stem, [](unsigned char c) { return std::isalnum(c) || c == '_'; });
}

// Where a folder of the search path has libraries of one kind: first those for the kernel's own instruction set.
std::array<fs::path, 2> library_folders(const fs::path& folder, PluginKind kind) {
    return {folder / kernel_level() / folder_of(kind), folder / folder_of(kind)};
}

// The stems and files of one kind in one folder, sorted; nothing where the folder cannot be read.
std::map<std::string, fs::path> plugin_files(const fs::path& folder, PluginKind kind) {
    std::map<std::string, fs::path> files;
    for (const fs::path& libraries : library_folders(folder, kind)) {
        std::error_code error;
        fs::directory_iterator entry(libraries, error);
        for (; !error && entry != fs::directory_iterator(); entry.increment(error)) {
            const fs::path& file = entry->path();
            if (file.extension() == library_suffix && is_keyword(file.stem().string())) files.emplace(file.stem().string(), file);
        }
    }
    return files;
}

// Why a library does not fit this program; nothing where it does. Reads plain data only, in an order in which each
// field is known to mean what it says once those before it have been found right.
std::string misfit(const PluginDescriptor& descriptor, PluginKind kind) {
    if (descriptor.magic != plugin_magic)
        return fmt::format("its '{}' is not a plugin descriptor of Lapidary", descriptor_symbol);
    if (descriptor.interface_version != plugin_interface_version)
        return fmt::format("it was built for version {} of the plugin interface, this program has version {}; build it again",
                           descriptor.interface_version, plugin_interface_version);
    if (!descriptor.abi_tag || std::string_view(descriptor.abi_tag) != plugin_abi_tag.text)
        return fmt::format(
            "it was built for the binary interface '{}', this program has '{}'; build it again with the same "
            "standard library and SDK",
            descriptor.abi_tag ? descriptor.abi_tag : "", plugin_abi_tag.text);
    if (descriptor.kind > PluginKind::output || !descriptor.schema || !descriptor.create)
        return "its plugin descriptor is incomplete";
    if (descriptor.kind != kind)
        return fmt::format("it is a plugin of kind '{}', not '{}'; move it to the folder {}/", name_of(descriptor.kind),
                           name_of(kind), folder_of(descriptor.kind));
    return {};
}

// The words of whatever is being thrown; called from within a catch block.
std::string words_of_current_exception() {
    try {
        throw;
    } catch (const std::exception& e) {
        return e.what();
    } catch (...) {
        return "an exception of unknown type";
    }
}

// Opens, checks and describes a plugin. Throws std::runtime_error with the reason for a refusal.
std::unique_ptr<const Plugin> open_plugin(PluginKind kind, const std::string& keyword, const fs::path& file) {
    const auto& descriptor = *static_cast<const PluginDescriptor*>(open_symbol(file, descriptor_symbol));
    if (std::string reason = misfit(descriptor, kind); !reason.empty()) throw std::runtime_error(reason);
    try {
        return std::make_unique<const Plugin>(kind, keyword, file, descriptor);
    } catch (...) {
        throw std::runtime_error(fmt::format("its description failed: {}", words_of_current_exception()));
    }
}

PluginListing list_file(PluginKind kind, const std::string& keyword, const fs::path& file) {
    PluginListing listing;
    listing.kind = kind;
    listing.keyword = keyword;
    listing.file = file;
    try {
        listing.summary = open_plugin(kind, keyword, file)->schema().summary();
        listing.usable = true;
    } catch (const std::runtime_error& refusal) {
        listing.reason = refusal.what();
    }
    return listing;
}

template <class Interface>
std::unique_ptr<Interface> create(const Plugin& plugin, const PluginDescriptor& descriptor, PluginKind kind) {
    if (plugin.kind() != kind)
        throw std::logic_error(
            fmt::format("the plugin '{}' is of kind {}, asked for {}", plugin.keyword(), name_of(plugin.kind()), name_of(kind)));
    try {
        std::unique_ptr<Interface> made(static_cast<Interface*>(descriptor.create()));
        plugin.schema().derive(dynamic_cast<void*>(made.get()));
        return made;
    } catch (...) {
        throw std::runtime_error(fmt::format("the plugin '{}' ({}) cannot make its {}: {}", plugin.keyword(),
                                             plugin.file().string(), name_of(kind), words_of_current_exception()));
    }
}

}  // namespace

std::string_view folder_of(PluginKind kind) {
    switch (kind) {
        case PluginKind::object:
            return "objects";
        case PluginKind::material:
            return "materials";
        case PluginKind::light:
            return "lights";
        case PluginKind::output:
            return "outputs";
    }
    return "";
}

std::string_view name_of(PluginKind kind) {
    switch (kind) {
        case PluginKind::object:
            return "object";
        case PluginKind::material:
            return "material";
        case PluginKind::light:
            return "light";
        case PluginKind::output:
            return "output";
    }
    return "";
}

Plugin::Plugin(PluginKind kind, std::string keyword, std::filesystem::path file, const PluginDescriptor& descriptor)
    : kind_(kind), keyword_(std::move(keyword)), file_(std::move(file)), descriptor_(descriptor), schema_(descriptor.schema()) {}

std::unique_ptr<Object> Plugin::create_object() const { return create<Object>(*this, descriptor_, PluginKind::object); }
std::unique_ptr<Material> Plugin::create_material() const { return create<Material>(*this, descriptor_, PluginKind::material); }
std::unique_ptr<Light> Plugin::create_light() const { return create<Light>(*this, descriptor_, PluginKind::light); }
std::unique_ptr<Output> Plugin::create_output() const { return create<Output>(*this, descriptor_, PluginKind::output); }

// A file that was found for a keyword: opened once, by whoever asks first, while others may open other files.
struct Registry::Slot {
    explicit Slot(fs::path found) : file(std::move(found)) {}

    fs::path file;
    std::once_flag once;
    std::unique_ptr<const Plugin> plugin;  // null: refused
    std::string reason;
    std::atomic<bool> ready = false;
};

Registry::Registry(std::vector<std::filesystem::path> search_path, std::size_t command_line_folders)
    : search_path_(std::move(search_path)), command_line_folders_(std::min(command_line_folders, search_path_.size())) {}

Registry::~Registry() = default;

std::vector<fs::path> Registry::search_path() const {
    const std::lock_guard lock(mutex_);
    return search_path_;
}

void Registry::insert_scene_folder(const std::filesystem::path& folder) {
    const std::lock_guard lock(mutex_);
    const auto first = search_path_.begin() + static_cast<std::ptrdiff_t>(command_line_folders_);
    const auto behind = first + static_cast<std::ptrdiff_t>(scene_folders_);
    if (std::find(first, behind, folder) != behind) return;
    search_path_.insert(behind, folder);
    ++scene_folders_;
}

Registry::Slot* Registry::slot(PluginKind kind, std::string_view keyword) {
    const std::lock_guard lock(mutex_);
    auto key = std::pair(kind, std::string(keyword));
    if (const auto known = slots_.find(key); known != slots_.end()) return known->second.get();
    const std::string name = key.second + library_suffix;
    for (const fs::path& folder : search_path_)
        for (const fs::path& libraries : library_folders(folder, kind)) {
            fs::path file = libraries / name;
            std::error_code error;
            if (!fs::exists(file, error)) continue;
            return slots_.emplace(std::move(key), std::make_unique<Slot>(std::move(file))).first->second.get();
        }
    return nullptr;
}

const Plugin* Registry::find(PluginKind kind, std::string_view keyword, std::string& reason) {
    reason.clear();
    if (!is_keyword(keyword)) return nullptr;
    Slot* const found = slot(kind, keyword);
    if (!found) return nullptr;
    std::call_once(found->once, [&] {
        try {
            found->plugin = open_plugin(kind, std::string(keyword), found->file);
        } catch (const std::runtime_error& refusal) {
            found->reason = fmt::format("the plugin '{}' was refused: {}", found->file.string(), refusal.what());
        }
        found->ready = true;
    });
    reason = found->reason;
    return found->plugin.get();
}

std::vector<std::string> Registry::keywords(PluginKind kind) const {
    std::vector<std::string> names;
    for (const fs::path& folder : search_path())
        for (const auto& [keyword, file] : plugin_files(folder, kind)) names.push_back(keyword);
    std::ranges::sort(names);
    names.erase(std::unique(names.begin(), names.end()), names.end());
    return names;
}

std::vector<PluginListing> Registry::list() const {
    std::vector<PluginListing> listings;
    const std::vector<fs::path> folders = search_path();
    for (const PluginKind kind : all_kinds) {
        std::map<std::string, std::vector<fs::path>> files;  // of each keyword, the one that counts first
        for (const fs::path& folder : folders)
            for (const auto& [keyword, file] : plugin_files(folder, kind)) files[keyword].push_back(file);
        for (const auto& [keyword, candidates] : files)
            for (const fs::path& file : candidates) {
                listings.push_back(list_file(kind, keyword, file));
                listings.back().hidden = file != candidates.front();
            }
    }
    return listings;
}

std::vector<const Plugin*> Registry::opened() const {
    const std::lock_guard lock(mutex_);
    std::vector<const Plugin*> plugins;
    for (const auto& [key, slot] : slots_)
        if (slot->ready && slot->plugin) plugins.push_back(slot->plugin.get());
    return plugins;
}

}  // namespace lapidary
