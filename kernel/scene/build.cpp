// SPDX-License-Identifier: MIT
//
// The top level of a scene. Everything is read, so that all errors are found, also what a later block replaces.
#include "kernel/scene/build.h"

#include <fmt/format.h>

#include <filesystem>
#include <system_error>

#include "kernel/math/standard_arithmetic.h"
#include "kernel/scene/build_context.h"
#include "kernel/scene/light_blocks.h"
#include "kernel/scene/material_blocks.h"
#include "kernel/scene/object_blocks.h"
#include "kernel/scene/properties.h"
#include "kernel/scene/settings_blocks.h"
#include "kernel/scene/transform_blocks.h"

namespace lapidary {

namespace {

// Properties that stand at the top level.
struct TopLevel {
    Colour background;

    static void describe(Schema<TopLevel>& schema) {
        schema.summary("The scene.");
        schema.add("background", &TopLevel::background).at_least(0).help("What is seen where nothing is.");
    }
};

const Schema<TopLevel>& top_level_schema() {
    static const Schema<TopLevel> schema;
    return schema;
}

const Block* as_block(const Item& item) {
    const auto* block = std::get_if<std::unique_ptr<Block>>(&item);
    return block ? block->get() : nullptr;
}

class SceneBuilder {
public:
    SceneBuilder(const Document& document, Registry& registry, const std::string& title, Messages& messages)
        : document_(document),
          registry_(registry),
          messages_(messages),
          context_{messages, document.constants, NameTable(document, messages), Vocabulary(registry, messages)},
          top_level_reader_(top_level_schema(), &top_level_, "scene", context_) {
        scene_->title = title;
        scene_->sources = document.sources;
    }

    std::shared_ptr<const Scene> build() {
        read_plugin_folders();
        find_rendered_objects();
        for (const Item& item : document_.items) {
            if (const auto* property = std::get_if<Property>(&item))
                read_property(*property);
            else if (const auto* reference = std::get_if<Reference>(&item))
                messages_.error(reference->place,
                                fmt::format("'{}' cannot stand at the top level; place it in `objects {{ }}` or `lights {{ }}`",
                                            reference->name));
            else
                read_block(*as_block(item));
        }
        finish();
        return messages_.has_errors() ? nullptr : scene_;
    }

private:
    // `plugins "dir";` counts before anything else is looked up, wherever it stands.
    void read_plugin_folders() {
        for (const Item& item : document_.items) {
            const auto* property = std::get_if<Property>(&item);
            if (!property || property->keyword != "plugins") continue;
            if (property->values.size() != 1 || property->values.front().kind != Value::Kind::text)
                messages_.error(property->place, "'plugins' takes one folder in double quotes: plugins \"folder\";");
            else
                insert_plugin_folder(property->values.front(), property->place);
        }
    }

    void insert_plugin_folder(const Value& value, const Place& place) {
        std::filesystem::path folder = value.text;
        if (folder.is_relative() && place.file) folder = std::filesystem::path(place.file->name).parent_path() / folder;
        std::error_code ignored;
        if (std::filesystem::is_directory(folder, ignored)) {
            registry_.insert_scene_folder(folder);
            scene_->plugin_folders.push_back(std::filesystem::absolute(folder, ignored).lexically_normal());
        } else {
            messages_.error(value.place,
                            fmt::format("there is no plugin folder '{}'; a relative one is looked for beside the scene file",
                                        folder.string()));
        }
    }

    void find_rendered_objects() {
        for (const Item& item : document_.items)
            if (const Block* block = as_block(item); block && block->keyword == "objects") rendered_ = block;
    }

    void read_property(const Property& property) {
        if (property.keyword == "plugins" || top_level_reader_.read(property)) return;
        auto known = top_level_reader_.known();
        known.emplace_back("plugins");
        context_.vocabulary.report_property(property, "scene", known);
    }

    void read_block(const Block& block) {
        if (block.keyword == "objects") {
            read_objects(block);
        } else if (block.keyword == "lights") {
            build_lights(block, scene_->lights, context_);
        } else if (block.keyword == "camera") {
            note_repetition(block, camera_);
            scene_->camera = build_camera(block, context_);
        } else if (block.keyword == "output") {
            note_repetition(block, output_);
            scene_->output = build_output(block, context_);
        } else if (block.keyword == "render") {
            note_repetition(block, render_);
            scene_->render = build_render(block, context_);
        } else {
            read_definition(block);
        }
    }

    void read_objects(const Block& block) {
        const bool is_rendered = &block == rendered_;
        const std::size_t names_before = context_.names.size();
        SceneNodePtr node = build_objects(block, is_rendered, context_);
        if (is_rendered)
            scene_->root = std::move(node);
        else if (context_.names.size() == names_before)
            messages_.warning(block.place,
                              "a later `objects` block is the one rendered, and this one defines no name: it has no effect");
    }

    void note_repetition(const Block& block, const Block*& last) {
        if (last)
            messages_.warning(block.place, fmt::format("'{}' stands here a second time (before at {}); the last one counts",
                                                       block.keyword, describe(last->place)));
        last = &block;
    }

    // A named block at the top level defines its name without placing anything.
    void read_definition(const Block& block) {
        const auto operation = operation_of(block.keyword);
        Vocabulary& vocabulary = context_.vocabulary;
        const auto plugin = [&](PluginKind kind) { return operation ? nullptr : vocabulary.find(kind, block.keyword); };
        if (block.keyword == "transform") {
            TransformFactors factors;
            read_transform_block(block, factors, true, context_);
        } else if (block.keyword == "material") {
            build_material_block(block, true, context_);
        } else if (operation) {
            build_operation(block, *operation, true, context_);
        } else if (const Plugin* object = plugin(PluginKind::object)) {
            build_leaf(block, *object, true, context_);
        } else if (const Plugin* texture = plugin(PluginKind::material)) {
            build_texture(block, *texture, true, context_);
        } else if (const Plugin* light = plugin(PluginKind::light)) {
            build_light(block, *light, true, context_);
        } else {
            return report_unknown_block(block);
        }
        if (block.name.empty())
            messages_.error(block.place,
                            fmt::format("'{}' without a name has no effect at the top level; name it, or place it in a block",
                                        block.keyword));
    }

    void report_unknown_block(const Block& block) {
        const std::vector<PluginKind> kinds{PluginKind::object, PluginKind::material, PluginKind::light};
        std::vector<std::string> keywords{"camera", "objects", "lights", "output", "render", "transform", "material"};
        for (const auto keyword : {"union", "merge", "subtraction", "difference", "intersection", "symdiff"})
            keywords.emplace_back(keyword);
        context_.vocabulary.report_block(block, kinds, std::move(keywords));
    }

    void finish() {
        scene_->background = top_level_.background;
        const Place whole_scene{document_.sources && !document_.sources->files().empty() ? &document_.sources->files().front()
                                                                                         : nullptr};
        // What stands in a block with errors was not read to its end: no complaints about what it may have used.
        if (messages_.has_errors()) return;
        if (!rendered_) {
            messages_.warning(whole_scene, "no `objects` block: the picture shows the background only");
            auto nothing = std::make_shared<SceneNode>();
            nothing->operation = Operation::union_;
            scene_->root = std::move(nothing);
        }
        context_.names.report_unused();
        if (scene_->lights.empty()) messages_.warning(whole_scene, "no light: only what reflects the background will show");
    }

    const Document& document_;
    Registry& registry_;
    Messages& messages_;
    BuildContext context_;
    TopLevel top_level_;
    PropertyReader top_level_reader_;
    std::shared_ptr<Scene> scene_ = std::make_shared<Scene>();
    const Block* rendered_ = nullptr;                                        // the last `objects` block
    const Block *camera_ = nullptr, *output_ = nullptr, *render_ = nullptr;  // the last ones so far
};

}  // namespace

std::shared_ptr<const Scene> build_scene(const Document& document, Registry& registry, const std::string& title,
                                         Messages& messages) {
    const StandardArithmetic standard;
    return SceneBuilder(document, registry, title, messages).build();
}

}  // namespace lapidary
