// SPDX-License-Identifier: MIT
//
// What the words after the program's name mean. Nothing is loaded or opened here.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "apps/lapidary/commands.h"
#include "kernel/interfaces/output.h"

namespace lapidary {

// The command line cannot be understood: a sentence with a remedy.
struct UsageError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

// A file cannot be written: a sentence with path, cause and remedy.
struct OutputError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

// How a scene is found, read and changed; common to all commands that take one.
struct SceneOptions {
    std::filesystem::path file;
    std::vector<std::filesystem::path> plugin_path, include_path;
    std::vector<std::string> settings;  // block.property=value, later ones win
    std::uint64_t max_items = 10'000'000;
};

struct RenderArguments {
    SceneOptions scene;

    std::optional<std::filesystem::path> name;  // -o
    std::vector<std::string> formats;           // -b, -t
    bool parse_only = false, log = false, no_warnings = false, verbose = false;
    bool full_screen = false, no_window = false, preview = false, hold = false, watch = false;
    bool one_by_one = false;
    std::uint32_t sequence = 0;

    std::optional<int> threads;  // 0: as many as the machine has; nothing: as the configuration says
    std::optional<PixelRegion> region;
    std::optional<int> samples;
    std::optional<double> error;
    std::optional<std::chrono::duration<double>> time;
};

struct CheckArguments {
    SceneOptions scene;
    bool json = false, no_warnings = false;
};

struct PluginsArguments {
    std::vector<std::filesystem::path> plugin_path;
};

struct HelpArguments {
    std::vector<std::filesystem::path> plugin_path;
    std::string topic;  // empty: what there is
};

struct CompareArguments {
    std::filesystem::path first, second, difference;
    double tolerance = 0;        // of a channel's value
    double share = 0;            // of the pixels that may lie beyond the tolerance, 0 to 1
    bool limits_pixels = false;  // one of the two was given
    std::optional<double> rmse;
};

struct ConvergeArguments {
    SceneOptions scene;
    std::filesystem::path name;  // of table and chart, without extension; empty: after the scene
    std::vector<double> errors{0.03, 0.02, 0.01, 0.005, 0.002, 0.001};
    bool sized = false;  // by --resolution
    int reference_samples = 4096;
    std::optional<int> threads;
};

// Nothing: help or the version was asked for, and is written. All throw UsageError.
std::optional<RenderArguments> parse_render(const Words& words);
std::optional<CheckArguments> parse_check(const Words& words);
std::optional<PluginsArguments> parse_plugins(const Words& words);
std::optional<HelpArguments> parse_help(const Words& words);
std::optional<CompareArguments> parse_compare(const Words& words);
std::optional<ConvergeArguments> parse_converge(const Words& words);

}  // namespace lapidary
