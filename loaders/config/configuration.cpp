// SPDX-License-Identifier: MIT
#include "loaders/config/configuration.h"

#include <fmt/format.h>

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <system_error>

#include "kernel/registry/library.h"
#include "loaders/config/yaml/reader.h"

namespace lapidary {

namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t largest_file = 1 << 20;

// The whole of a regular file; nothing, with a message, where it cannot be had.
std::optional<std::string> read_text(const fs::path& file, Messages& messages) {
    const auto fail = [&](const std::string& reason) -> std::optional<std::string> {
        messages.error({}, fmt::format("cannot read the configuration '{}': {}", file.string(), reason));
        return std::nullopt;
    };
    std::error_code error;
    if (!fs::is_regular_file(file, error)) return fail("it is not a file; remove it or put a file there");
    if (fs::file_size(file, error) > largest_file) return fail("it is larger than a megabyte");
    std::ifstream stream(file, std::ios::binary);
    std::string text((std::istreambuf_iterator<char>(stream)), std::istreambuf_iterator<char>());
    if (!stream.is_open() || stream.bad()) return fail("permission denied, or the disk failed");
    return text;
}

}  // namespace

std::vector<fs::path> Configurations::include_path() const {
    std::vector<fs::path> path = user.include_path;
    path.insert(path.end(), project.include_path.begin(), project.include_path.end());
    return path;
}

fs::path user_configuration_file() {
    const char* const configuration = std::getenv("XDG_CONFIG_HOME");
    if (configuration && *configuration == '/') return fs::path(configuration) / "lapidary" / "config.yaml";
    const char* const home = std::getenv("HOME");
    return home && *home ? fs::path(home) / ".config" / "lapidary" / "config.yaml" : fs::path();
}

fs::path project_configuration_file() { return "lapidary.yaml"; }

Configuration load_configuration(const fs::path& file, Sources& sources, Messages& messages) {
    Configuration configuration;
    std::error_code error;
    if (file.empty() || !fs::exists(file, error)) return configuration;
    std::optional<std::string> text = read_text(file, messages);
    if (!text) return configuration;
    const SourceFile& source = sources.add(file.string(), std::move(*text));
    try {
        const auto read = reinterpret_cast<ReadYamlConfiguration*>(open_module("yaml_configuration", yaml_configuration_symbol));
        read(source, configuration, messages);
    } catch (const std::runtime_error& failure) {
        messages.error({&source, 0, 0}, failure.what());
    }
    return configuration;
}

Configurations load_configurations(Sources& sources, Messages& messages) {
    return {load_configuration(user_configuration_file(), sources, messages),
            load_configuration(project_configuration_file(), sources, messages)};
}

}  // namespace lapidary
