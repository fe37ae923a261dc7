// SPDX-License-Identifier: MIT
//
// From the words of the command line to a scene: the registry with its search path, the scene file, the settings laid
// over it.
#pragma once

#include <memory>
#include <vector>

#include "apps/lapidary/command_line.h"
#include "kernel/registry/registry.h"
#include "kernel/report/messages.h"
#include "kernel/scene/document.h"
#include "kernel/scene/scene.h"
#include "loaders/config/configuration.h"

namespace lapidary {

// For a command without a scene: a registry that searches the given folders first, then those of the environment, the
// configuration files and the installation. What is wrong with them is told on standard error.
std::unique_ptr<Registry> open_registry(const std::vector<std::filesystem::path>& plugin_path, Messages& messages);

// What the places of messages and scenes point into lives as long as this.
class Session {
public:
    Session(const SceneOptions& options, Messages& messages);

    Registry& registry() { return *registry_; }
    const Configurations& configurations() const { return configurations_; }

    // Reads the file and lays the settings over it. Errors are in the messages.
    void load();
    // The names of the files that were read.
    std::vector<std::string> files() const;
    // Null where anything so far had errors.
    std::shared_ptr<const Scene> build();

private:
    const SceneOptions& options_;
    Messages& messages_;
    Sources configuration_sources_;
    Configurations configurations_;
    std::unique_ptr<Registry> registry_;
    Document document_;
    std::vector<std::shared_ptr<Sources>> setting_sources_;
};

}  // namespace lapidary
