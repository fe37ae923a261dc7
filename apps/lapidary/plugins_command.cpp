// SPDX-License-Identifier: MIT
//
// lapidary plugins: what was found where, and what was refused and why.
#include <fmt/format.h>

#include <cstdio>

#include "apps/lapidary/command_line.h"
#include "apps/lapidary/session.h"

namespace lapidary {

namespace {

std::string describe(const PluginListing& listing) {
    if (!listing.usable) return "refused: " + listing.reason;
    if (listing.hidden) return "hidden by another file of this name";
    return listing.summary;
}

}  // namespace

ExitCode plugins_command(const Words& words) {
    const auto arguments = parse_plugins(words);
    if (!arguments) return ExitCode::success;
    Messages messages;
    const auto registry = open_registry(arguments->plugin_path, messages);

    fmt::print("Searched, first match wins:\n");
    for (const auto& folder : registry->search_path()) fmt::print("  {}\n", folder.string());
    if (registry->search_path().empty()) fmt::print("  no folder; name one with --plugin-path\n");
    std::optional<PluginKind> kind;
    for (const PluginListing& listing : registry->list()) {
        if (kind != listing.kind) fmt::print("\n{}\n", folder_of(listing.kind));
        kind = listing.kind;
        fmt::print("  {:<14} {}\n  {:<14} {}\n", listing.keyword, describe(listing), "", listing.file.string());
    }
    return messages.has_errors() ? ExitCode::failure : ExitCode::success;
}

}  // namespace lapidary
