// SPDX-License-Identifier: MIT
#include "apps/lapidary/displays.h"

#include <algorithm>
#include <cstdlib>

namespace lapidary {

namespace {

constexpr const char* window = "window";
constexpr const char* terminal = "terminal";

bool is_set(const char* variable) {
    const char* const value = std::getenv(variable);
    return value && *value;
}

bool has_display() { return is_set("DISPLAY") || is_set("WAYLAND_DISPLAY"); }

PictureFile* find(std::vector<PictureFile>& pictures, const char* keyword) {
    const auto found = std::ranges::find_if(pictures, [&](const PictureFile& p) { return p.plugin->keyword() == keyword; });
    return found == pictures.end() ? nullptr : &*found;
}

// Null, with a warning, where there is no such output.
PictureFile* add(std::vector<PictureFile>& pictures, Registry& registry, const char* keyword, Messages& messages) {
    if (PictureFile* const there = find(pictures, keyword)) return there;
    std::string reason;
    const Plugin* const plugin = registry.find(PluginKind::output, keyword, reason);
    if (plugin) return &pictures.emplace_back(PictureFile{plugin->create_output(), plugin, {}});
    if (reason.empty()) reason = std::string("there is no output '") + keyword + "'";
    messages.warning({}, reason + "; the picture is rendered without being shown");
    return nullptr;
}

void set_word(const PictureFile& picture, const char* property, const char* word) {
    if (const PropertySchema* const schema = picture.plugin->schema().find(property))
        schema->assign(dynamic_cast<void*>(picture.output.get()), {word_value(word)});
}

}  // namespace

void choose_displays(std::vector<PictureFile>& pictures, Registry& registry, const DisplayChoice& choice, Messages& messages) {
    const bool asked_for = !choice.no_window && (choice.full_screen || find(pictures, window));
    if (choice.no_window || !has_display())
        std::erase_if(pictures, [](const PictureFile& picture) { return picture.plugin->keyword() == window; });
    else if (const PictureFile* const shown = add(pictures, registry, window, messages); shown && choice.full_screen)
        set_word(*shown, "full_screen", "yes");
    if (asked_for && !has_display())
        messages.warning(
            {}, "there is no display (neither DISPLAY nor WAYLAND_DISPLAY is set); the picture is rendered without window");
    if (choice.terminal) add(pictures, registry, terminal, messages);
}

}  // namespace lapidary
