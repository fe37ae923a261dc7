// SPDX-License-Identifier: MIT
#include "apps/lapidary/legend.h"

#include <fmt/format.h>

#include "kernel/prepare/world.h"
#include "kernel/registry/registry.h"

namespace lapidary {

namespace {

std::string describe(const Plugin* plugin, const char* otherwise, const Place& place) {
    std::string text = plugin ? std::string(plugin->keyword()) : otherwise;
    if (place.line > 0) text += fmt::format(" on line {}", place.line);
    const bool is_included = place.file && place.file->included_at.file;
    return is_included ? text + " of " + place.file->name : text;
}

std::string describe(const World& world, const Leaf& leaf) {
    const std::string* const name = world.name_of(leaf);
    return name ? *name : describe(leaf.source->plugin, "object", leaf.source->place);
}

std::string describe(const MaterialInstance& instance) {
    const SceneMaterial* material = instance.source;
    if (!material) return "none";
    // A block that only places another one is called like that.
    while (material->name.empty() && !material->texture && material->children.size() == 1)
        material = material->children.front().get();
    return material->name.empty() ? describe(material->plugin, "material", material->place) : material->name;
}

void enter(std::vector<std::string>& names, std::int32_t number, std::string name) {
    const auto index = static_cast<std::size_t>(number);
    if (index >= names.size()) names.resize(index + 1);
    names[index] = std::move(name);
}

}  // namespace

std::shared_ptr<const Legend> legend_of(const World& world) {
    auto legend = std::make_shared<Legend>();
    legend->objects = legend->materials = {"nothing"};
    for (const Leaf& leaf : world.leaves) enter(legend->objects, leaf.number, describe(world, leaf));
    for (const MaterialInstance& instance : world.materials) enter(legend->materials, instance.number, describe(instance));
    return legend;
}

}  // namespace lapidary
