// SPDX-License-Identifier: MIT
//
// Textures of the built plugin folder, made and filled as a scene would fill them.
#pragma once

#include <initializer_list>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "kernel/registry/registry.h"

namespace lapidary::test {

inline Registry& built_plugins() {
    static Registry registry({LAPIDARY_PLUGIN_FOLDER});
    return registry;
}

struct TextureProperty {
    std::string name;
    std::vector<Value> values;
};

inline TextureProperty number(const std::string& name, std::initializer_list<double> numbers) {
    TextureProperty property{name, {}};
    for (double n : numbers) property.values.push_back(number_value(n));
    return property;
}
inline TextureProperty word(const std::string& name, const std::string& word) { return {name, {word_value(word)}}; }

inline MaterialPtr texture(const std::string& keyword, const std::vector<TextureProperty>& properties = {},
                           const std::vector<MaterialPtr>& children = {}) {
    std::string reason;
    const Plugin* plugin = built_plugins().find(PluginKind::material, keyword, reason);
    if (!plugin) throw std::runtime_error("no texture '" + keyword + "': " + reason);
    std::shared_ptr<Material> made = plugin->create_material();
    void* target = dynamic_cast<void*>(made.get());
    for (const TextureProperty& property : properties) plugin->schema().find(property.name)->assign(target, property.values);
    const auto& slots = plugin->schema().children();
    for (std::size_t i = 0; i < children.size(); ++i) slots.at(std::min(i, slots.size() - 1)).assign(target, children[i]);
    for (const Requirement& requirement : plugin->schema().requirements())
        if (!requirement.holds(target)) throw std::runtime_error(keyword + ": " + requirement.sentence);
    plugin->schema().derive(target);
    return made;
}

// Matter that is told from others by its colour.
inline MaterialPtr marked(double mark) { return texture("solid", {number("colour", {mark, 0, 0})}); }
inline double mark_at(const Material& material, const Point& point) { return material.evaluate({point, 0}).colour.r; }

}  // namespace lapidary::test
