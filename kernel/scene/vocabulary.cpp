// SPDX-License-Identifier: MIT
#include "kernel/scene/vocabulary.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "kernel/scene/properties.h"
#include "kernel/scene/transform_blocks.h"

namespace lapidary {

namespace {

struct OperationKeyword {
    std::string_view keyword;
    Operation operation;
};
constexpr OperationKeyword operation_keywords[] = {{"union", Operation::union_},
                                                   {"merge", Operation::merge},
                                                   {"subtraction", Operation::subtraction},
                                                   {"difference", Operation::subtraction},
                                                   {"intersection", Operation::intersection},
                                                   {"symdiff", Operation::symdiff}};

struct Home {
    std::string_view keyword, home;
};
constexpr Home block_homes[] = {
    {"objects", "stands at the top level"},
    {"lights", "stands at the top level"},
    {"camera", "stands at the top level"},
    {"output", "stands at the top level"},
    {"render", "stands at the top level"},
    {"screen", "stands in `camera { }`"},
    {"transform", "stands in objects, CSG operations, materials, textures, lights and at the top level"},
    {"inverse", "stands in `transform { }`"},
    {"material", "stands in objects, CSG operations and at the top level"},
};

constexpr PluginKind plugin_kinds[] = {PluginKind::object, PluginKind::material, PluginKind::light, PluginKind::output};

std::string_view home_of_plugin(PluginKind kind) {
    switch (kind) {
        case PluginKind::object:
            return home_of(NameKind::object);
        case PluginKind::material:
            return home_of(NameKind::material);
        case PluginKind::light:
            return home_of(NameKind::light);
        case PluginKind::output:
            return "an output; outputs stand in `output { }`";
    }
    return {};
}

}  // namespace

std::string_view home_of(NameKind kind) {
    switch (kind) {
        case NameKind::object:
            return "an object; objects stand in `objects { }` and in CSG operations";
        case NameKind::material:
            return "a material; materials stand in objects, CSG operations and textures";
        case NameKind::light:
            return "a light; lights stand in `lights { }`";
        case NameKind::transform:
            return "a transform; transforms stand in objects, CSG operations, materials, textures and lights";
    }
    return {};
}

std::optional<Operation> operation_of(std::string_view keyword) {
    for (const auto& entry : operation_keywords)
        if (entry.keyword == keyword) return entry.operation;
    return std::nullopt;
}

std::string_view keyword_of(Operation operation) {
    for (const auto& entry : operation_keywords)
        if (entry.operation == operation) return entry.keyword;
    return "union";
}

Vocabulary::Entry& Vocabulary::look_up(PluginKind kind, const std::string& keyword) {
    auto& entries = entries_[static_cast<std::size_t>(kind)];
    const auto [entry, is_new] = entries.try_emplace(keyword);
    if (is_new) entry->second.plugin = registry_.find(kind, keyword, entry->second.reason);
    return entry->second;
}

const Plugin* Vocabulary::find(PluginKind kind, const std::string& keyword) { return look_up(kind, keyword).plugin; }

const std::vector<std::string>& Vocabulary::keywords(PluginKind kind) {
    auto& list = keywords_[static_cast<std::size_t>(kind)];
    if (!list) list = registry_.keywords(kind);
    return *list;
}

std::string Vocabulary::home_of(const std::string& keyword) {
    for (const Home& entry : block_homes)
        if (entry.keyword == keyword) return fmt::format("'{}' {}", keyword, entry.home);
    if (operation_of(keyword))
        return fmt::format("'{}' is a CSG operation; operations stand in `objects {{ }}` and in one another", keyword);
    for (const PluginKind kind : plugin_kinds)
        if (std::ranges::find(keywords(kind), keyword) != keywords(kind).end())
            return fmt::format("'{}' is {}", keyword, home_of_plugin(kind));
    return {};
}

std::string Vocabulary::searched_folders(const std::vector<PluginKind>& kinds) const {
    std::string folders;
    for (const auto& folder : registry_.search_path())
        for (const PluginKind kind : kinds) folders += (folders.empty() ? "" : ", ") + (folder / folder_of(kind)).string();
    return folders.empty() ? "no plugin folder is known; name one with --plugin-path" : "searched: " + folders;
}

void Vocabulary::report_block(const Block& block, const std::vector<PluginKind>& wanted, std::vector<std::string> language) {
    const std::string& keyword = block.keyword;
    if (!messages_.wants_errors()) return messages_.error(block.place, {});
    for (const PluginKind kind : wanted)
        if (Entry& entry = look_up(kind, keyword); !entry.reason.empty()) {
            // Once is enough, however many blocks there are of it.
            if (!std::exchange(entry.reported, true))
                messages_.error(block.place, fmt::format("the {} '{}' cannot be used: {}", name_of(kind), keyword, entry.reason));
            return;
        }
    if (const std::string home = home_of(keyword); !home.empty()) {
        messages_.error(block.place, home);
        return;
    }
    for (const PluginKind kind : wanted) {
        const auto& of_kind = this->keywords(kind);
        language.insert(language.end(), of_kind.begin(), of_kind.end());
    }
    std::string text = fmt::format("unknown keyword '{}'{}", keyword, did_you_mean(keyword, language));
    if (!wanted.empty()) text += fmt::format(" ({})", searched_folders(wanted));
    messages_.error(block.place, std::move(text));
}

void Vocabulary::report_property(const Property& property, std::string_view owner, const std::vector<std::string>& known) {
    const std::string& keyword = property.keyword;
    if (!messages_.wants_errors()) return messages_.error(property.place, {});
    // A block that was written with parentheses.
    if (!home_of(keyword).empty()) {
        messages_.error(property.place, fmt::format("'{0}' is a block: it is written {0} {{ … }}", keyword));
        return;
    }
    if (is_transform_factor(keyword)) {
        messages_.error(property.place, fmt::format("'{}' stands in `transform {{ }}`", keyword));
        return;
    }
    std::string text = fmt::format("'{}' has no property '{}'", owner, keyword);
    const std::string suggestion = did_you_mean(keyword, known);
    if (!suggestion.empty())
        text += suggestion;
    else if (known.empty())
        text += "; it takes none";
    else
        text += fmt::format("; it takes {}", list_of(known));
    messages_.error(property.place, std::move(text));
}

}  // namespace lapidary
