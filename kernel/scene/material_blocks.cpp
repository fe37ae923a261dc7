// SPDX-License-Identifier: MIT
#include "kernel/scene/material_blocks.h"

#include <fmt/format.h>

#include <algorithm>
#include <exception>

#include "kernel/render/placed_material.h"
#include "kernel/scene/plain_material.h"
#include "kernel/scene/properties.h"
#include "kernel/scene/transform_blocks.h"

namespace lapidary {

namespace {

// Textures ask their children by recursion while rendering; this keeps the stack of a rendering thread bounded.
constexpr int greatest_texture_depth = 1000;

// `value(0.3);` or `colour(1, 0, 0);` in the place of a child.
struct ConstantChild {
    std::optional<double> value;
    std::optional<Colour> colour;

    static void describe(Schema<ConstantChild>& schema) {
        schema.summary("A constant in the place of a texture.");
        schema.add("value", &ConstantChild::value).help("A grey of this value.");
        schema.add("colour", &ConstantChild::colour).help("A colour.");
    }
};

const Schema<ConstantChild>& constant_schema() {
    static const Schema<ConstantChild> schema;
    return schema;
}

bool is_too_deep(int depth, const Place& place, BuildContext& context) {
    if (depth <= greatest_texture_depth) return false;
    context.messages.error(place, fmt::format("textures are nested more than {} deep; use fewer levels", greatest_texture_depth));
    return true;
}

// The child with a transform or a name of its own.
SceneMaterialPtr wrap(SceneMaterialPtr child, const TransformFactors& factors, const std::string& name, const Place& place,
                      BuildContext& context) {
    if (!child || is_too_deep(child->depth + 1, place, context)) return nullptr;
    auto wrapped = std::make_shared<SceneMaterial>();
    wrapped->material = child->material;
    if (!factors.empty()) {
        const auto transform = compose(factors, place, context);
        if (!transform) return nullptr;
        wrapped->material = std::make_shared<PlacedMaterial>(child->material, *transform);
    }
    wrapped->plugin = child->plugin;
    wrapped->name = name;
    wrapped->place = place;
    wrapped->factors = factors;
    wrapped->depth = child->depth + 1;
    wrapped->children.push_back(std::move(child));
    return wrapped;
}

// The textures and transforms that stand in a block or branch.
struct TextureItems {
    std::vector<SceneMaterialPtr> children;
    TransformFactors factors;
    bool failed = false;
};

// Reads a block or reference that stands for a child or a transform.
class TextureItemReader {
public:
    explicit TextureItemReader(BuildContext& context) : context_(context) {}

    void read(const Block& block, TextureItems& items) {
        if (block.keyword == "transform") {
            if (!read_transform_block(block, items.factors, false, context_)) items.failed = true;
        } else if (block.keyword == "material") {
            add(build_material_block(block, false, context_), items);
        } else if (const Plugin* plugin = context_.vocabulary.find(PluginKind::material, block.keyword)) {
            add(build_texture(block, *plugin, false, context_), items);
        } else {
            items.failed = true;
            context_.vocabulary.report_block(block, {PluginKind::material}, {"transform", "material"});
        }
    }

    void read(const Reference& reference, TextureItems& items) {
        const NamedThing* thing = context_.names.use(reference);
        if (!thing) {
            items.failed = true;
        } else if (thing->kind == NameKind::material) {
            add(thing->get<SceneMaterialPtr>(), items);
        } else if (thing->kind == NameKind::transform) {
            const auto factors = thing->get<TransformFactors>();
            items.factors.insert(items.factors.end(), factors.begin(), factors.end());
        } else {
            items.failed = true;
            context_.messages.error(reference.place, fmt::format("'{}' is {}", reference.name, home_of(thing->kind)));
        }
    }

private:
    static void add(SceneMaterialPtr child, TextureItems& items) {
        if (child)
            items.children.push_back(std::move(child));
        else
            items.failed = true;
    }

    BuildContext& context_;
};

class TextureBuilder {
public:
    TextureBuilder(const Block& block, const Plugin& plugin, BuildContext& context)
        : block_(block), plugin_(plugin), context_(context) {}

    SceneMaterialPtr build() {
        const NestingGuard guard(context_, block_);
        if (guard.too_deep()) return nullptr;
        try {
            return make();
        } catch (const std::exception& exception) {
            context_.messages.error(block_.place, exception.what());
            return nullptr;
        }
    }

private:
    SceneMaterialPtr make() {
        const std::shared_ptr<Material> texture = plugin_.create_material();
        void* target = dynamic_cast<void*>(texture.get());
        PropertyReader reader(plugin_.schema(), target, block_.keyword, context_);
        auto scene_material = std::make_shared<SceneMaterial>();

        bool failed = false;
        for (std::size_t i = 0; i < block_.branches.size(); ++i) {
            TextureItems items;
            read_items(block_.branches[i].items, reader, items);
            failed = failed || items.failed;
            place_branch(items, i, *scene_material);
        }
        // Children first: requirements may speak of them.
        const bool filled = !failed && fill_slots(scene_material->children, target);
        if (!reader.finish(block_.place) || !filled) return nullptr;
        for (const SceneMaterialPtr& child : scene_material->children)
            scene_material->depth = std::max(scene_material->depth, child->depth + 1);
        if (is_too_deep(scene_material->depth, block_.place, context_)) return nullptr;

        const auto transform = compose(scene_material->factors, block_.place, context_);
        if (!transform) return nullptr;
        scene_material->texture = texture;
        scene_material->material = texture;
        if (!scene_material->factors.empty()) scene_material->material = std::make_shared<PlacedMaterial>(texture, *transform);
        scene_material->plugin = &plugin_;
        scene_material->name = block_.name;
        scene_material->place = block_.place;
        return scene_material;
    }

    void read_items(const Items& written, PropertyReader& reader, TextureItems& items) {
        TextureItemReader child_reader(context_);
        for (const Item& item : written) {
            if (const auto* property = std::get_if<Property>(&item))
                read_property(*property, reader, items);
            else if (const auto* reference = std::get_if<Reference>(&item))
                child_reader.read(*reference, items);
            else if (const Block& inner = *std::get<std::unique_ptr<Block>>(item); !reader.report_block(inner))
                child_reader.read(inner, items);
        }
    }

    void read_property(const Property& property, PropertyReader& reader, TextureItems& items) {
        if (reader.read(property)) return;
        if (!plugin_.schema().children().empty() && constant_schema().find(property.keyword))
            return read_constant(property, items);
        items.failed = true;
        context_.vocabulary.report_property(property, block_.keyword, reader.known());
    }

    void read_constant(const Property& property, TextureItems& items) {
        ConstantChild constant;
        PropertyReader reader(constant_schema(), &constant, block_.keyword, context_);
        reader.read(property);
        if (reader.failed()) {
            items.failed = true;
            return;
        }
        const Colour colour = constant.colour ? *constant.colour : Colour::grey(constant.value.value_or(0));
        items.children.push_back(plain_material(colour, Matter().shininess, property.place, context_));
    }

    // A transform acts on all of a texture that is written as one block, and on one branch where there are several.
    void place_branch(TextureItems& items, std::size_t branch, SceneMaterial& scene_material) {
        const bool whole = block_.branches.size() == 1;
        if (whole) scene_material.factors = items.factors;
        const Place& place = block_.branches[branch].place;
        for (SceneMaterialPtr& child : items.children) {
            if (!whole && !items.factors.empty()) child = wrap(std::move(child), items.factors, {}, place, context_);
            if (child) scene_material.children.push_back(std::move(child));
        }
    }

    bool fill_slots(const std::vector<SceneMaterialPtr>& children, void* target) {
        const auto& slots = plugin_.schema().children();
        const bool any_number = !slots.empty() && slots.back().repeats;
        const std::size_t most = slots.size() - (any_number ? 1 : 0);
        std::size_t least = 0;
        for (std::size_t i = 0; i < most; ++i)
            if (!slots[i].optional) least = i + 1;
        if (any_number && !slots.back().optional) least = slots.size();
        if (children.size() < least || (children.size() > most && !any_number)) {
            report_child_count(children.size(), least, most, any_number);
            return false;
        }
        for (std::size_t i = 0; i < children.size(); ++i)
            slots[std::min(i, slots.size() - 1)].assign(target, children[i]->material);
        return true;
    }

    void report_child_count(std::size_t given, std::size_t least, std::size_t most, bool any_number) {
        if (most == 0 && !any_number) {
            context_.messages.error(block_.place, fmt::format("'{}' takes no textures inside, not {}", block_.keyword, given));
            return;
        }
        std::vector<std::string> names;
        for (const ChildSchema& slot : plugin_.schema().children()) names.push_back(slot.name);
        std::string count = std::to_string(least);
        if (any_number)
            count += " or more";
        else if (least != most)
            count += " to " + std::to_string(most);
        context_.messages.error(
            block_.place, fmt::format("'{}' takes {} texture{} ({}), not {}; a constant is written value(v); or colour(r, g, b);",
                                      block_.keyword, count, most == 1 && !any_number ? "" : "s", list_of(names), given));
    }

    const Block& block_;
    const Plugin& plugin_;
    BuildContext& context_;
};

// Where a definition ends, the name gets its meaning.
SceneMaterialPtr finish_definition(NamedThing* name, SceneMaterialPtr material) {
    if (name) {
        name->under_way = false;
        if (material) name->value = material;
    }
    return material;
}

SceneMaterialPtr read_material_block(const Block& block, BuildContext& context) {
    const NestingGuard guard(context, block);
    if (guard.too_deep()) return nullptr;
    refuse_branches(block, context);
    TextureItems items;
    TextureItemReader reader(context);
    for (const Item& item : block.branches.front().items) {
        if (const auto* property = std::get_if<Property>(&item)) {
            items.failed = true;
            context.messages.error(
                property->place,
                fmt::format("'{}' cannot stand directly in a material; write it inside a texture block", property->keyword));
        } else if (const auto* reference = std::get_if<Reference>(&item)) {
            reader.read(*reference, items);
        } else {
            reader.read(*std::get<std::unique_ptr<Block>>(item), items);
        }
    }
    if (items.failed) return nullptr;
    if (items.children.size() != 1) {
        context.messages.error(block.place, fmt::format("a material holds one texture block, not {}", items.children.size()));
        return nullptr;
    }
    if (block.name.empty() && items.factors.empty()) return items.children.front();
    return wrap(items.children.front(), items.factors, block.name, block.place, context);
}

}  // namespace

SceneMaterialPtr build_material_block(const Block& block, bool needs_use, BuildContext& context) {
    NamedThing* name = context.names.reserve(block, NameKind::material, needs_use);
    return finish_definition(name, read_material_block(block, context));
}

SceneMaterialPtr build_texture(const Block& block, const Plugin& plugin, bool needs_use, BuildContext& context) {
    NamedThing* name = context.names.reserve(block, NameKind::material, needs_use);
    return finish_definition(name, TextureBuilder(block, plugin, context).build());
}

SceneMaterialPtr plain_material(const Colour& colour, double shininess, const Place& place, BuildContext& context) {
    if (context.plain_matter) {
        const Matter& last = static_cast<const PlainMaterial&>(*context.plain_matter->material).matter();
        if (last.colour == colour && last.shininess == shininess) return context.plain_matter;
    }
    auto plain = std::make_shared<SceneMaterial>();
    plain->material = std::make_shared<PlainMaterial>(colour, shininess);
    plain->place = place;
    context.plain_matter = plain;
    return plain;
}

}  // namespace lapidary
