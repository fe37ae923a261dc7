// SPDX-License-Identifier: MIT
//
// What keywords mean and where they may stand: the language's own and those of the plugins. Every message about a
// keyword that does not fit is made here.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "kernel/registry/registry.h"
#include "kernel/report/messages.h"
#include "kernel/scene/document.h"
#include "kernel/scene/names.h"

namespace lapidary {

// The operation that a keyword stands for: union, merge, subtraction (also: difference), intersection, symdiff.
std::optional<Operation> operation_of(std::string_view keyword);
// The keyword that is printed for an operation; not for leaves.
std::string_view keyword_of(Operation operation);

class Vocabulary {
public:
    Vocabulary(Registry& registry, Messages& messages) : registry_(registry), messages_(messages) {}

    // The plugin of a keyword, opened at first use. Null where there is none that can be used; nothing is reported.
    const Plugin* find(PluginKind kind, const std::string& keyword);

    // A block whose keyword cannot stand where it stands: one that was refused, one that belongs elsewhere, or one that
    // nobody knows. `wanted` are the kinds of plugins that may stand there, `language` its own words that may.
    void report_block(const Block& block, const std::vector<PluginKind>& wanted, std::vector<std::string> language);
    // A property that the block `owner` does not have; `known` are those it has.
    void report_property(const Property& property, std::string_view owner, const std::vector<std::string>& known);

private:
    struct Entry {
        const Plugin* plugin = nullptr;
        std::string reason;     // why it was refused
        bool reported = false;  // the user knows
    };
    Entry& look_up(PluginKind kind, const std::string& keyword);
    const std::vector<std::string>& keywords(PluginKind kind);
    // "a light; lights stand in `lights { }`", or nothing for an unknown keyword.
    std::string home_of(const std::string& keyword);
    std::string searched_folders(const std::vector<PluginKind>& kinds) const;

    Registry& registry_;
    Messages& messages_;
    std::array<std::unordered_map<std::string, Entry>, 4> entries_;    // by kind
    std::array<std::optional<std::vector<std::string>>, 4> keywords_;  // by kind, listed when first wanted
};

// "an object; objects stand in `objects { }` and in CSG operations"
std::string_view home_of(NameKind kind);

}  // namespace lapidary
