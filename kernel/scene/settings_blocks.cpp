// SPDX-License-Identifier: MIT
#include "kernel/scene/settings_blocks.h"

#include <fmt/format.h>

#include <exception>
#include <numbers>

#include "kernel/scene/properties.h"

namespace lapidary {

// Width and height, as one value of two numbers.
struct Extent {
    double width = 0, height = 0;
};

template <>
struct MemberTraits<Extent> {
    static constexpr Shape shape = Shape::number;
    static constexpr int count = 2;
    static Extent from(const Value* v) { return {v[0].number, v[1].number}; }
    static void to(const Extent& m, std::vector<Value>& out) {
        out.push_back(number_value(m.width));
        out.push_back(number_value(m.height));
    }
};

namespace {

struct ScreenBlock {
    std::optional<Point> location;
    std::optional<Extent> size;

    static void describe(Schema<ScreenBlock>& schema) {
        schema.summary("The window that the picture is seen through.");
        schema.add("location", &ScreenBlock::location).unit(Unit::length).help("Its centre in the world.");
        schema.add("size", &ScreenBlock::size).unit(Unit::length).above(0).arguments("w, h").help("Its width and height.");
    }
};

struct CameraBlock : Camera {
    std::optional<Point> look_at;

    static void describe(Schema<CameraBlock>& schema) {
        schema.summary("Where the picture is seen from.");
        schema.add("projection", &CameraBlock::projection, {"perspective", "orthographic"})
            .help("Rays from a point, or parallel ones.");
        schema.add("location", &CameraBlock::location).unit(Unit::length).help("Where the camera stands.");
        schema.add("look_at", &CameraBlock::look_at).unit(Unit::length).help("A point in the middle of the picture.");
        schema.add("up", &CameraBlock::up).help("The direction that is up in the picture.");
        schema.add("angle", &CameraBlock::angle)
            .unit(Unit::angle)
            .above(0)
            .below(std::numbers::pi)
            .help("Horizontal field of view, instead of the screen's size.");
        schema.add("focus", &CameraBlock::focus).unit(Unit::length).above(0).help("Distance of the plane that is sharp.");
        schema.add("aperture", &CameraBlock::aperture).unit(Unit::length).at_least(0).help("Lens diameter; 0 is a pinhole.");
        schema.add("points", &CameraBlock::points)
            .between(0, greatest_count)
            .help("Lens points calculated beforehand; 0: a new one for every ray.");
        schema.add("rays", &CameraBlock::rays)
            .between(1, greatest_count)
            .help("Rays a pixel; without it, as many as the error asks for.");
    }

    static constexpr double greatest_count = 1 << 20;
};

struct OutputBlock : OutputSettings {
    static constexpr int greatest_side = 65536;
    static constexpr double greatest_area = 1 << 28;  // pixels; 3 GB of colour

    static void describe(Schema<OutputBlock>& schema) {
        schema.summary("The picture's size and the files or windows that it goes to.");
        schema.add("resolution", &OutputBlock::width, &OutputBlock::height)
            .between(1, greatest_side)
            .arguments("w, h")
            .help("Width and height in pixels.");
        schema.add("name", &OutputBlock::name).help("The file; without extension, the writers add theirs.");
        schema.add("encoding", &OutputBlock::encoding_word, {"srgb", "linear"}).help("How 8- and 16-bit writers encode light.");
        schema.require("the picture must have at most 268 million pixels", [](const OutputBlock& output) {
            return static_cast<double>(output.width) * output.height <= greatest_area;
        });
    }

    enum class Encoding { srgb, linear };
    Encoding encoding_word = Encoding::srgb;
};

struct RenderBlock : RenderSettings {
    static void describe(Schema<RenderBlock>& schema) {
        schema.summary("How far the calculation goes.");
        schema.add("depth", &RenderBlock::depth).between(0, 1000).help("Reflections and refractions that a path may have.");
        schema.add("cutoff", &RenderBlock::cutoff).between(0, 1).help("Weight in the pixel below which a path ends.");
        schema.add("error", &RenderBlock::error).above(0).at_most(1).help("Estimated error of a pixel that is good enough.");
    }
};

template <class Block>
const Schema<Block>& schema_of() {
    static const Schema<Block> schema;
    return schema;
}

// Reads the properties of a block; `on_block` takes the blocks inside and says whether it knows them.
template <class OnBlock>
void read_settings(const Block& block, PropertyReader& reader, BuildContext& context, OnBlock on_block) {
    refuse_name(block, context);
    refuse_branches(block, context);
    for (const Item& item : block.branches.front()) {
        if (const auto* property = std::get_if<Property>(&item)) {
            if (!reader.read(*property)) context.vocabulary.report_property(*property, block.keyword, reader.known());
        } else if (const auto* reference = std::get_if<Reference>(&item)) {
            context.messages.error(reference->place, fmt::format("a '{}' block takes no names; '{}' cannot stand here",
                                                                 block.keyword, reference->name));
        } else {
            on_block(*std::get<std::unique_ptr<Block>>(item));
        }
    }
    reader.finish(block.place);
}

bool report_property_as_block(const Block& block, const SchemaBase& schema, BuildContext& context) {
    const PropertySchema* property = schema.find(block.keyword);
    if (property)
        context.messages.error(block.place,
                               fmt::format("'{0}' is written with parentheses: {0}{1};", block.keyword, property->signature()));
    return property != nullptr;
}

class CameraReader {
public:
    explicit CameraReader(BuildContext& context) : context_(context) {}

    Camera read(const Block& block) {
        PropertyReader properties(camera_schema(), &camera_, block.keyword, context_.messages);
        read_settings(block, properties, context_, [&](const Block& inner) { read_inner_block(inner); });
        refuse_conflicts(properties);
        place_screen(properties);
        return camera_;
    }

private:
    void read_inner_block(const Block& block) {
        if (block.keyword == "screen") return read_screen(block);
        if (report_property_as_block(block, camera_schema(), context_)) return;
        if (block.keyword == "transform")
            context_.messages.error(block.place, "'camera' takes no transform; give its location and look_at instead");
        else
            context_.vocabulary.report_block(block, {}, {"screen"});
    }

    void read_screen(const Block& block) {
        if (has_screen_) context_.messages.warning(block.place, "'screen' stands here a second time; the last one counts");
        has_screen_ = true;
        screen_ = {};
        PropertyReader properties(screen_schema(), &screen_, block.keyword, context_.messages);
        read_settings(block, properties, context_, [&](const Block& inner) {
            if (!report_property_as_block(inner, screen_schema(), context_)) context_.vocabulary.report_block(inner, {}, {});
        });
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
                context_.messages.warning(properties.place_of("location") ? *properties.place_of("location") : Place{},
                                          "the screen's centre is the camera's location: the view runs along +z");
            else
                camera_.screen_centre = *screen_.location;
        }
    }

    BuildContext& context_;
    CameraBlock camera_;
    ScreenBlock screen_;
    bool has_screen_ = false;
};

class OutputReader {
public:
    explicit OutputReader(BuildContext& context) : context_(context) {}

    OutputSettings read(const Block& block) {
        PropertyReader properties(output_schema(), &output_, block.keyword, context_.messages);
        read_settings(block, properties, context_, [&](const Block& inner) {
            if (!report_property_as_block(inner, output_schema(), context_)) writers_.push_back(&inner);
        });
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
            PropertyReader properties(plugin->schema(), target, block.keyword, context_.messages);
            read_settings(block, properties, context_, [&](const Block& inner) {
                if (!report_property_as_block(inner, plugin->schema(), context_)) context_.vocabulary.report_block(inner, {}, {});
            });
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
    PropertyReader properties(render_schema(), &render, block.keyword, context.messages);
    read_settings(block, properties, context, [&](const Block& inner) {
        if (!report_property_as_block(inner, render_schema(), context)) context.vocabulary.report_block(inner, {}, {});
    });
    return render;
}

}  // namespace lapidary
