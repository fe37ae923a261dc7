// SPDX-License-Identifier: MIT
#include "apps/lapidary/session.h"

#include <fmt/format.h>

#include <cstdio>
#include <system_error>

#include "apps/lapidary/settings.h"
#include "kernel/registry/search_path.h"
#include "kernel/scene/build.h"
#include "loaders/scene/load.h"

namespace lapidary {

namespace {

std::unique_ptr<Registry> make_registry(const std::vector<std::filesystem::path>& plugin_path,
                                        const Configurations& configurations, Messages& messages) {
    for (const std::filesystem::path& folder : plugin_path) {
        std::error_code error;
        if (!std::filesystem::is_directory(folder, error))
            messages.warning({}, fmt::format("--plugin-path: there is no folder '{}'; it is passed over", folder.string()));
    }
    SearchPath path = plugin_search_path({plugin_path, configurations.user.plugin_path, configurations.project.plugin_path});
    return std::make_unique<Registry>(std::move(path.folders), path.command_line_folders);
}

}  // namespace

std::unique_ptr<Registry> open_registry(const std::vector<std::filesystem::path>& plugin_path, Messages& messages) {
    Sources sources;
    auto registry = make_registry(plugin_path, load_configurations(sources, messages), messages);
    for (const Message& message : messages.all()) fmt::print(stderr, "{}", message.format());
    return registry;
}

Session::Session(const SceneOptions& options, Messages& messages)
    : options_(options),
      messages_(messages),
      configurations_(load_configurations(configuration_sources_, messages)),
      registry_(make_registry(options.plugin_path, configurations_, messages)) {}

void Session::load() {
    LoadOptions load{options_.include_path, options_.max_items};
    for (auto& folder : configurations_.include_path()) load.include_path.push_back(std::move(folder));
    document_ = load_scene_file(options_.file, load, messages_);
    for (const std::string& setting : options_.settings) setting_sources_.push_back(apply_setting(setting, document_, messages_));
}

std::vector<std::string> Session::files() const {
    std::vector<std::string> names;
    for (const Sources* sources : {&configuration_sources_, static_cast<const Sources*>(document_.sources.get())})
        for (const SourceFile& file : sources->files()) names.push_back(file.name);
    return names;
}

std::shared_ptr<const Scene> Session::build() {
    if (document_.sources->files().empty()) return nullptr;  // nothing could be read; that is all there is to say
    auto scene = build_scene(document_, *registry_, options_.file.stem().string(), messages_);
    return messages_.has_errors() ? nullptr : scene;
}

}  // namespace lapidary
