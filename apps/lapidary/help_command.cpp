// SPDX-License-Identifier: MIT
//
// lapidary help: what the schema of a plugin knows, and what else the language has.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

#include "apps/lapidary/command_line.h"
#include "apps/lapidary/session.h"
#include "kernel/registry/help.h"
#include "kernel/scene/settings_blocks.h"

namespace lapidary {

namespace {

constexpr PluginKind kinds[] = {PluginKind::object, PluginKind::material, PluginKind::light, PluginKind::output};

// What the language itself has, beside the plugins.
struct LanguageKeyword {
    std::string_view keyword;
    std::string_view explanation;
    const SchemaBase& (*schema)() = nullptr;  // of a block with properties; it explains itself
};

constexpr LanguageKeyword language[] = {
    {"camera", "", camera_schema},
    {"screen", "", screen_schema},
    {"output", "", output_schema},
    {"render", "", render_schema},
    {"objects", "objects { … }: what is rendered: objects and CSG operations. The last such block counts.\n"},
    {"lights", "lights { … }: what shines. Such blocks add up.\n"},
    {"background", "background(r,g,b);: what rays that meet nothing return; black unless given.\n"},
    {"union", "union { … } with { … }: all points of either. The faces inside it still exist.\n"},
    {"merge", "merge { … } with { … }: all points of either, without faces inside.\n"},
    {"subtraction", "subtraction { … } with { … }: the points of the first that are not in the others. Also: difference.\n"},
    {"difference", "difference: another word for subtraction.\n"},
    {"intersection", "intersection { … } with { … }: the points that are in all.\n"},
    {"symdiff", "symdiff { … } with { … }: the points that are in an odd number of them.\n"},
    {"transform",
     "transform { … }: moves everything in the block it stands in, in the order written.\n"
     "  translate(x,y,z)  scale(x,y,z)  scale(s)  rotx(a)  roty(a)  rotz(a)  rotate(ax,ay,az, a)\n"
     "  shear(xy,xz,yx,yz,zx,zy)  matrix(m11 … m43)  inverse { … }\n"},
    {"material", "material { … }: the texture tree that an object or a CSG operation is made of.\n"},
    {"priority", "priority(n);: which of overlapping operands a point is made of: the highest, then the leftmost.\n"},
    {"include", "include \"file\": reads another file in place.\n"},
    {"let", "let name = expression;: names a number.\n"},
    {"repeat", "repeat i (first, last) { … }: repeats what it holds with i counting up by one.\n"},
    {"plugins", "plugins \"dir\";: a folder of plugins, relative to the scene.\n"},
};

void print_keywords(const Registry& registry) {
    fmt::print("lapidary help KEYWORD explains one of these.\n\nlanguage:");
    for (const LanguageKeyword& word : language) fmt::print(" {}", word.keyword);
    for (const PluginKind kind : kinds) {
        fmt::print("\n{}:", folder_of(kind));
        for (const std::string& keyword : registry.keywords(kind)) fmt::print(" {}", keyword);
    }
    fmt::print("\n");
}

std::vector<std::string> all_keywords(const Registry& registry) {
    std::vector<std::string> keywords;
    for (const LanguageKeyword& word : language) keywords.emplace_back(word.keyword);
    for (const PluginKind kind : kinds)
        for (const std::string& keyword : registry.keywords(kind)) keywords.push_back(keyword);
    return keywords;
}

// False: nothing of that name.
bool explain(Registry& registry, const std::string& topic) {
    bool found = false;
    const auto print = [&](std::string_view text) {
        fmt::print("{}{}", found ? "\n" : "", text);
        found = true;
    };
    for (const LanguageKeyword& word : language)
        if (word.keyword == topic) print(word.schema ? help_text(word.schema(), topic) : std::string(word.explanation));
    for (const PluginKind kind : kinds) {
        std::string reason;
        if (const Plugin* const plugin = registry.find(kind, topic, reason))
            print(help_text(*plugin));
        else if (!reason.empty())
            print(reason + "\n");
    }
    return found;
}

}  // namespace

ExitCode help_command(const Words& words) {
    const auto arguments = parse_help(words);
    if (!arguments) return ExitCode::success;
    Messages messages;
    const auto registry = open_registry(arguments->plugin_path, messages);
    if (arguments->topic.empty()) {
        print_keywords(*registry);
    } else if (!explain(*registry, arguments->topic)) {
        throw UsageError(fmt::format("there is no keyword '{}'{}; lapidary help lists them", arguments->topic,
                                     did_you_mean(arguments->topic, all_keywords(*registry))));
    }
    return ExitCode::success;
}

}  // namespace lapidary
