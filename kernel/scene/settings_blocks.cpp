// SPDX-License-Identifier: MIT
#include "kernel/scene/settings_blocks.h"

#include <fmt/format.h>

#include <exception>

#include "kernel/scene/properties.h"
#include "kernel/scene/settings_schemas.h"

namespace lapidary {

namespace {

template <class Block>
const Schema<Block>& schema_of() {
    static const Schema<Block> schema;
    return schema;
}

// Reads the properties of a block; `on_block` takes the blocks inside.
template <class OnBlock>
void read_settings(const Block& block, PropertyReader& reader, BuildContext& context, OnBlock on_block) {
    refuse_name(block, context);
    refuse_branches(block, context);
    for (const Item& item : block.branches.front().items) {
        if (const auto* property = std::get_if<Property>(&item)) {
            if (!reader.read(*property)) context.vocabulary.report_property(*property, block.keyword, reader.known());
        } else if (const auto* reference = std::get_if<Reference>(&item)) {
            context.messages.error(reference->place, fmt::format("a '{}' block takes no names; '{}' cannot stand here",
                                                                 block.keyword, reference->name));
        } else if (const Block& inner = *std::get<std::unique_ptr<Block>>(item); !reader.report_block(inner)) {
            on_block(inner);
        }
    }
    reader.finish(block.place);
}

class CameraReader {
public:
    explicit CameraReader(BuildContext& context) : context_(context) {}

    Camera read(const Block& block) {
        PropertyReader properties(camera_schema(), &camera_, block.keyword, context_);
        read_settings(block, properties, context_, [&](const Block& inner) { read_inner_block(inner); });
        refuse_conflicts(properties);
        place_screen(properties);
        return camera_;
    }

private:
    void read_inner_block(const Block& block) {
        if (block.keyword == "screen") return read_screen(block);
        if (block.keyword == "transform")
            context_.messages.error(block.place, "'camera' takes no transform; give its location and look_at instead");
        else
            context_.vocabulary.report_block(block, {}, {"screen"});
    }

    void read_screen(const Block& block) {
        if (has_screen_) context_.messages.warning(block.place, "'screen' stands here a second time; the last one counts");
        has_screen_ = true;
        screen_ = {};
        PropertyReader properties(screen_schema(), &screen_, block.keyword, context_);
        read_settings(block, properties, context_, [&](const Block& inner) { context_.vocabulary.report_block(inner, {}, {}); });
        if (const Place* place = properties.place_of("location")) screen_location_ = *place;
    }

    // Two properties that say the same in different ways.
    void refuse_conflicts(const PropertyReader& properties) {
        if (screen_.location && camera_.look_at)
            context_.messages.error(*properties.place_of("look_at"),
                                    "'look_at' and the screen's location exclude each other; leave out one");
        if (screen_.size && camera_.angle)
            context_.messages.error(*properties.place_of("angle"),
                                    "'angle' and the screen's size exclude each other; leave out one");
        if (camera_.angle && camera_.projection == Camera::Projection::orthographic)
            context_.messages.error(*properties.place_of("angle"),
                                    "'angle' has no meaning for parallel rays; give the screen's size instead");
    }

    void place_screen(const PropertyReader& properties) {
        if (screen_.size) {
            camera_.screen_width = screen_.size->width;
            camera_.screen_height = screen_.size->height;
            camera_.screen_height_given = true;
        }
        camera_.screen_centre = camera_.location + Vector{0, 0, 1};
        if (camera_.look_at) {
            const Vector view = normalize(*camera_.look_at - camera_.location);
            if (view == Vector{})
                context_.messages.warning(*properties.place_of("look_at"),
                                          "'look_at' is the camera's location: the view runs along +z");
            else
                camera_.screen_centre = camera_.location + view;
        } else if (screen_.location) {
            if (*screen_.location == camera_.location)
                context_.messages.warning(screen_location_,
                                          "the screen's centre is the camera's location: the view runs along +z");
            else
                camera_.screen_centre = *screen_.location;
        }
        if (camera_.screen_centre == camera_.location)
            context_.messages.error(*properties.place_of("location"),
                                    "the camera is so far from the origin that the screen, one unit away, rounds to the same "
                                    "place; move the scene nearer");
    }

    BuildContext& context_;
    CameraBlock camera_;
    ScreenBlock screen_;
    bool has_screen_ = false;
    Place screen_location_;
};

class OutputReader {
public:
    explicit OutputReader(BuildContext& context) : context_(context) {}

    OutputSettings read(const Block& block) {
        PropertyReader properties(output_schema(), &output_, block.keyword, context_);
        read_settings(block, properties, context_, [&](const Block& inner) { writers_.push_back(&inner); });
        if (properties.place_of("encoding"))
            output_.encoding = output_.encoding_word == OutputBlock::Encoding::linear ? "linear" : "srgb";
        for (const Block* writer : writers_) read_writer(*writer);
        return output_;
    }

private:
    void read_writer(const Block& block) {
        const Plugin* plugin = context_.vocabulary.find(PluginKind::output, block.keyword);
        if (!plugin) return context_.vocabulary.report_block(block, {PluginKind::output}, {});
        try {
            const std::shared_ptr<Output> writer = plugin->create_output();
            void* target = dynamic_cast<void*>(writer.get());
            inherit_encoding(*plugin, target);
            PropertyReader properties(plugin->schema(), target, block.keyword, context_);
            read_settings(block, properties, context_,
                          [&](const Block& inner) { context_.vocabulary.report_block(inner, {}, {}); });
            output_.writers.push_back({writer, plugin, block.place});
        } catch (const std::exception& exception) {
            context_.messages.error(block.place, exception.what());
        }
    }

    // The block's encoding is the default of every writer that has one.
    void inherit_encoding(const Plugin& plugin, void* writer) {
        const PropertySchema* encoding = plugin.schema().find("encoding");
        if (encoding && output_.encoding) encoding->assign(writer, {word_value(*output_.encoding)});
    }

    BuildContext& context_;
    OutputBlock output_;
    std::vector<const Block*> writers_;
};

}  // namespace

const SchemaBase& camera_schema() { return schema_of<CameraBlock>(); }
const SchemaBase& screen_schema() { return schema_of<ScreenBlock>(); }
const SchemaBase& output_schema() { return schema_of<OutputBlock>(); }
const SchemaBase& render_schema() { return schema_of<RenderBlock>(); }

Camera build_camera(const Block& block, BuildContext& context) { return CameraReader(context).read(block); }

OutputSettings build_output(const Block& block, BuildContext& context) { return OutputReader(context).read(block); }

RenderSettings build_render(const Block& block, BuildContext& context) {
    RenderBlock render;
    PropertyReader properties(render_schema(), &render, block.keyword, context);
    read_settings(block, properties, context, [&](const Block& inner) { context.vocabulary.report_block(inner, {}, {}); });
    return render;
}

}  // namespace lapidary
