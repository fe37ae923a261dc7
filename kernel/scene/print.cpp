// SPDX-License-Identifier: MIT
#include "kernel/scene/print.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <memory>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

#include "kernel/registry/registry.h"
#include "kernel/scene/plain_material.h"
#include "kernel/scene/settings_blocks.h"
#include "kernel/scene/settings_schemas.h"
#include "kernel/scene/transform_blocks.h"
#include "kernel/scene/vocabulary.h"

namespace lapidary {

namespace {

// Text in the making, indented by the blocks that are open.
class Writer {
public:
    void line(std::string_view text) { text_.append(4 * static_cast<std::size_t>(depth_), ' ').append(text).append("\n"); }
    void open(std::string_view keyword, std::string_view name = {}) {
        line(name.empty() ? fmt::format("{} {{", keyword) : fmt::format("{} {} {{", keyword, name));
        ++depth_;
    }
    void close() {
        --depth_;
        if (text_.ends_with("{\n"))
            text_.replace(text_.size() - 1, 1, "}\n");
        else
            line("}");
    }
    std::string take() { return std::move(text_); }

private:
    std::string text_;
    int depth_ = 0;
};

std::string value_text(const Value& value, Unit unit) {
    switch (value.kind) {
        case Value::Kind::text:
            return '"' + value.text + '"';
        case Value::Kind::word:
            return value.text;
        case Value::Kind::number:
            break;
    }
    return fmt::format("{}{}", value.number, unit == Unit::angle ? "rad" : "");
}

std::string values_text(const std::vector<Value>& values, Unit unit) {
    std::string text;
    for (const Value& value : values) text += (text.empty() ? "" : ", ") + value_text(value, unit);
    return text;
}

bool are_same(const Value& a, const Value& b) {
    return a.kind == b.kind && std::bit_cast<std::uint64_t>(a.number) == std::bit_cast<std::uint64_t>(b.number) &&
           a.text == b.text;
}

using Lines = std::vector<std::vector<Value>>;

bool are_same(const Lines& a, const Lines& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const auto& x, const auto& y) {
        return std::equal(x.begin(), x.end(), y.begin(), y.end(), [](const Value& v, const Value& w) { return are_same(v, w); });
    });
}

void write_property(const PropertySchema& property, const void* object, Writer& writer) {
    for (const auto& values : property.read(object))
        writer.line(fmt::format("{}({});", property.name, values_text(values, property.unit)));
}

void write_properties(const SchemaBase& schema, const void* object, Writer& writer) {
    for (const PropertySchema& property : schema.properties()) write_property(property, object, writer);
}

// Only what differs from a newly made object.
void write_changed_properties(const SchemaBase& schema, const void* object, const void* fresh, Writer& writer) {
    for (const PropertySchema& property : schema.properties())
        if (!are_same(property.read(object), property.read(fresh))) write_property(property, object, writer);
}

std::string factor_text(const TransformFactor& factor) {
    const FactorForm& form = form_of(factor.kind);
    std::string values;
    for (int i = 0; i < form.count; ++i)
        values +=
            fmt::format("{}{}{}", i > 0 ? ", " : "", factor.values[static_cast<std::size_t>(i)], i == form.angle ? "rad" : "");
    const std::string text = fmt::format("{}({});", form.keyword, values);
    return factor.inverted ? fmt::format("inverse {{ {} }}", text) : text;
}

void write_factors(const std::vector<TransformFactor>& factors, Writer& writer) {
    if (factors.empty()) return;
    writer.open("transform");
    for (const TransformFactor& factor : factors) writer.line(factor_text(factor));
    writer.close();
}

const std::vector<SceneNodePtr>& parts_of(const SceneNode& node) { return node.operands; }
const std::vector<SceneMaterialPtr>& parts_of(const SceneMaterial& material) { return material.children; }

// Plain matter has no block that could carry a name.
bool can_have_name(const SceneNode&) { return true; }
bool can_have_name(const SceneMaterial& material) { return material.texture || !material.children.empty(); }

// Names that are taken, and new ones.
class NameSource {
public:
    void take(const std::string& name) { taken_.insert(name); }
    bool is_taken(const std::string& name) const { return taken_.contains(name); }
    std::string make(std::string_view stem) {
        std::string name;
        do name = fmt::format("{}_{}", stem, ++count_);
        while (!taken_.insert(name).second);
        return name;
    }

private:
    std::unordered_set<std::string> taken_;
    int count_ = 0;
};

// Which nodes of a forest are written as definitions of their own: those that are used more than once, and some of a
// tree that is deeper than blocks should be nested. Walks with a stack of its own, whatever the depth.
template <class Node>
class Definitions {
public:
    explicit Definitions(NameSource& names) : names_(names) {}

    void add(const Node* root) {
        std::vector<Visit> stack;
        enter(root, stack);
        while (!stack.empty()) {
            Visit& top = stack.back();
            if (top.next < parts_of(*top.node).size()) {
                const Node* part = parts_of(*top.node)[top.next++].get();
                enter(part, stack);
            } else {
                leave(*top.node);
                stack.pop_back();
            }
        }
    }

    // To be called after the last add().
    void choose(std::string_view stem) {
        for (const Node* node : finished_) {
            Entry& entry = entries_[node];
            int height = 0;
            for (const auto& part : parts_of(*node)) height = std::max(height, entries_[part.get()].height + 1);
            entry.height = height;
            if (!can_have_name(*node) || (entry.uses < 2 && height < greatest_height)) continue;
            entry.height = 0;
            entry.name = node->name.empty() ? names_.make(stem) : node->name;
            chosen_.push_back(node);
        }
    }

    // Parts before what is made of them.
    const std::vector<const Node*>& chosen() const { return chosen_; }
    // The name to refer to; empty: written in place.
    const std::string& name_of(const Node& node) const { return entries_.at(&node).name; }
    // Every node, parts first.
    const std::vector<const Node*>& all() const { return finished_; }

private:
    static constexpr int greatest_height = 50;

    struct Visit {
        const Node* node;
        std::size_t next = 0;
    };
    struct Entry {
        int uses = 0;
        int height = 0;  // levels below that are written in place
        std::string name;
    };

    void enter(const Node* node, std::vector<Visit>& stack) {
        if (entries_[node].uses++ == 0) stack.push_back({node});
    }

    void leave(const Node& node) {
        if (!node.name.empty()) names_.take(node.name);
        finished_.push_back(&node);
    }

    NameSource& names_;
    std::unordered_map<const Node*, Entry> entries_;
    std::vector<const Node*> finished_, chosen_;
};

// A new object of each plugin, to tell what was changed.
class Specimens {
public:
    template <class Interface>
    const void* fresh(const Plugin& plugin, std::unique_ptr<Interface> (Plugin::*create)() const) {
        auto& specimen = specimens_[&plugin];
        if (!specimen.address) {
            const std::shared_ptr<Interface> made = (plugin.*create)();
            specimen = {dynamic_cast<const void*>(made.get()), made};
        }
        return specimen.address;
    }

private:
    struct Specimen {
        const void* address = nullptr;
        std::shared_ptr<const void> owner;
    };
    std::unordered_map<const Plugin*, Specimen> specimens_;
};

class ScenePrinter {
public:
    explicit ScenePrinter(const Scene& scene) : scene_(scene) {}

    std::string print() {
        for (const SceneLight& light : scene_.lights)
            if (!light.name.empty()) names_.take(light.name);
        nodes_.add(scene_.root.get());
        for (const SceneNode* node : nodes_.all())
            if (node->material) materials_.add(node->material.get());
        materials_.choose("material");
        nodes_.choose("object");

        write_settings();
        write_lights();
        for (const SceneMaterial* material : materials_.chosen()) write_material(*material, materials_.name_of(*material));
        for (const SceneNode* node : nodes_.chosen()) write_node(*node, nodes_.name_of(*node));
        writer_.open("objects");
        write_contents(*scene_.root);
        writer_.close();
        return writer_.take();
    }

private:
    void write_settings() {
        for (const auto& folder : scene_.plugin_folders) writer_.line(fmt::format("plugins \"{}\";", folder.string()));
        write_camera();
        write_output();
        writer_.open("render");
        RenderBlock render;
        static_cast<RenderSettings&>(render) = scene_.render;
        write_properties(render_schema(), &render, writer_);
        writer_.close();
        const Colour& background = scene_.background;
        writer_.line(fmt::format("background({}, {}, {});", background.r, background.g, background.b));
    }

    // The screen's centre stands for whatever it was calculated from.
    void write_camera() {
        CameraBlock camera;
        static_cast<Camera&>(camera) = scene_.camera;
        ScreenBlock screen;
        screen.location = camera.screen_centre;
        if (camera.screen_width) screen.size = Extent{*camera.screen_width, camera.screen_height};
        writer_.open("camera");
        write_properties(camera_schema(), &camera, writer_);
        writer_.open("screen");
        write_properties(screen_schema(), &screen, writer_);
        writer_.close();
        writer_.close();
    }

    void write_output() {
        const OutputSettings& output = scene_.output;
        writer_.open("output");
        writer_.line(fmt::format("resolution({}, {});", output.width, output.height));
        if (!output.name.empty()) writer_.line(fmt::format("name(\"{}\");", output.name));
        if (output.encoding) writer_.line(fmt::format("encoding({});", *output.encoding));
        for (const SceneOutput& destination : output.writers) {
            writer_.open(destination.plugin->keyword());
            write_properties(destination.plugin->schema(), dynamic_cast<const void*>(destination.output.get()), writer_);
            writer_.close();
        }
        writer_.close();
    }

    // The lights stand in the world already. A name that stands for several can be written only once.
    void write_lights() {
        std::unordered_set<std::string> written;
        writer_.open("lights");
        for (const SceneLight& light : scene_.lights) {
            const bool named = !light.name.empty() && written.insert(light.name).second;
            writer_.open(light.plugin->keyword(), named ? light.name : "");
            write_changed_properties(light.plugin->schema(), dynamic_cast<const void*>(light.light.get()),
                                     specimens_.fresh(*light.plugin, &Plugin::create_light), writer_);
            writer_.close();
        }
        writer_.close();
    }

    void write_material(const SceneMaterial& material, std::string_view name) {
        writer_.open(material.texture ? std::string_view(material.plugin->keyword()) : "material", name);
        if (material.texture)
            write_changed_properties(material.plugin->schema(), dynamic_cast<const void*>(material.texture.get()),
                                     specimens_.fresh(*material.plugin, &Plugin::create_material), writer_);
        for (const SceneMaterialPtr& child : material.children) write_child(*child, material);
        write_factors(material.factors, writer_);
        writer_.close();
    }

    void write_child(const SceneMaterial& child, const SceneMaterial& parent) {
        if (!can_have_name(child))
            write_constant(child, parent);
        else if (const std::string& name = materials_.name_of(child); !name.empty())
            writer_.line(name + ";");
        else
            write_material(child, child.name);
    }

    // `value(v);` or `colour(r, g, b);`, whichever the parent has no property of.
    void write_constant(const SceneMaterial& constant, const SceneMaterial& parent) {
        const Colour& colour = static_cast<const PlainMaterial&>(*constant.material).matter().colour;
        const bool has_value = parent.plugin->schema().find("value") != nullptr;
        if (colour == Colour::grey(colour.r) && !has_value)
            writer_.line(fmt::format("value({});", colour.r));
        else
            writer_.line(fmt::format("colour({}, {}, {});", colour.r, colour.g, colour.b));
    }

    void write_material_of(const SceneNode& node) {
        const SceneMaterial& material = *node.material;
        const bool is_named = can_have_name(material) && !materials_.name_of(material).empty();
        if (can_have_name(material) && !material.texture && !is_named) {
            write_material(material, material.name);
        } else if (can_have_name(material)) {
            writer_.open("material");
            write_child(material, material);
            writer_.close();
        } else {
            const Matter& matter = static_cast<const PlainMaterial&>(*material.material).matter();
            writer_.line(fmt::format("colour({}, {}, {});", matter.colour.r, matter.colour.g, matter.colour.b));
            writer_.line(fmt::format("shininess({});", matter.shininess));
        }
    }

    void write_node(const SceneNode& node, std::string_view name) {
        const bool is_leaf = node.operation == Operation::leaf;
        writer_.open(is_leaf ? std::string_view(node.plugin->keyword()) : keyword_of(node.operation), name);
        write_contents(node);
        writer_.close();
    }

    void write_contents(const SceneNode& node) {
        if (node.operation == Operation::leaf)
            write_changed_properties(node.plugin->schema(), dynamic_cast<const void*>(node.object.get()),
                                     specimens_.fresh(*node.plugin, &Plugin::create_object), writer_);
        for (const SceneNodePtr& operand : node.operands) {
            if (const std::string& name = nodes_.name_of(*operand); !name.empty())
                writer_.line(name + ";");
            else
                write_node(*operand, operand->name);
        }
        if (node.material) write_material_of(node);
        if (node.priority) writer_.line(fmt::format("priority({});", *node.priority));
        write_factors(node.factors, writer_);
    }

    const Scene& scene_;
    Writer writer_;
    NameSource names_;
    Definitions<SceneMaterial> materials_{names_};
    Definitions<SceneNode> nodes_{names_};
    Specimens specimens_;
};

}  // namespace

std::string print_scene(const Scene& scene) { return ScenePrinter(scene).print(); }

}  // namespace lapidary
