// SPDX-License-Identifier: MIT
//
// What all files of one scene share while they are read: constants, bounds, and the chain of includes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <unordered_set>
#include <vector>

#include "kernel/report/messages.h"
#include "kernel/scene/document.h"
#include "loaders/scene/constants.h"
#include "loaders/scene/load.h"

namespace lapidary::scene_language {

// Something that multiplies text: a loop or an include that is being carried out.
struct Multiplier {
    std::string what;       // "the loop over 'i'"
    std::string_view name;  // of a loop's counter
    Place place;
    std::uint64_t rounds = 1;
    double counter = 0;  // of a loop, in this round
};

struct Loading {
    const LoadOptions& options;
    Messages& messages;
    Sources& sources;
    Constants constants{};
    std::unordered_set<std::string_view> block_names{};

    std::vector<Multiplier> multipliers{};               // outermost first
    std::uint64_t produced = 0;                          // items made by multipliers
    bool stopped = false;                                // the bound on items was passed
    int later_rounds = 0;                                // enclosing loops that are past their first round
    int depth = 0;                                       // blocks, loops and includes around the present place
    std::vector<std::filesystem::path> include_chain{};  // identities of the files that are being read
    std::map<std::pair<const SourceFile*, std::uint64_t>, const SourceFile*> included{};  // by the place of the include

    // Warnings of a loop's body are the same in every round; the first one tells them.
    void warning(const Place& place, std::string text);
    // What goes wrong only in a later round says in which.
    void error(const Place& place, std::string text);

    // Constants of this scope that nothing used. An included file may be a library, of which nobody needs everything.
    void warn_unused_since(std::size_t scope);

    // Counts what a loop or an include makes; beyond the bound it reports and stops the reading. What a file holds
    // outside of them is bounded by its own length.
    void charge(std::uint64_t items);
    // Stops at once where this many items are certain to come.
    void foresee(std::uint64_t items);

private:
    void stop();
};

}  // namespace lapidary::scene_language
