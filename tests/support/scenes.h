// SPDX-License-Identifier: MIT
//
// Scenes from text, for tests: loaded and built with the plugins of the build tree.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "kernel/registry/registry.h"
#include "kernel/scene/build.h"
#include "loaders/scene/load.h"

namespace lapidary::test {

// What came of a scene's text. It owns the registry, which the scene's plugins belong to.
struct BuiltScene {
    std::unique_ptr<Registry> registry;
    Messages messages;
    std::shared_ptr<const Scene> scene;  // null where there were errors

    // "file:line:column: error: text" of every message, with the plugin folder written as <plugins>.
    std::vector<std::string> headlines() const {
        std::vector<std::string> lines;
        for (const Message& message : messages.all()) {
            std::string line = message.headline();
            const std::string folder = LAPIDARY_PLUGIN_FOLDER;
            for (std::size_t at; (at = line.find(folder)) != std::string::npos;) line.replace(at, folder.size(), "<plugins>");
            lines.push_back(std::move(line));
        }
        return lines;
    }
};

inline std::unique_ptr<BuiltScene> build(std::string text,
                                         std::vector<std::filesystem::path> plugin_path = {LAPIDARY_PLUGIN_FOLDER}) {
    auto built = std::make_unique<BuiltScene>();
    built->registry = std::make_unique<Registry>(std::move(plugin_path));
    const Document document = load_scene_text("s", std::move(text), {}, built->messages);
    built->scene = build_scene(document, *built->registry, "s", built->messages);
    return built;
}

// The same of a scene's file.
inline std::unique_ptr<BuiltScene> build_file(const std::filesystem::path& file) {
    auto built = std::make_unique<BuiltScene>();
    built->registry = std::make_unique<Registry>(std::vector<std::filesystem::path>{LAPIDARY_PLUGIN_FOLDER});
    const Document document = load_scene_file(file, {}, built->messages);
    built->scene = build_scene(document, *built->registry, file.stem(), built->messages);
    return built;
}

}  // namespace lapidary::test
