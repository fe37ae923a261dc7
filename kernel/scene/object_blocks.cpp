// SPDX-License-Identifier: MIT
#include "kernel/scene/object_blocks.h"

#include <fmt/format.h>

#include <exception>
#include <utility>

#include "kernel/scene/material_blocks.h"
#include "kernel/scene/properties.h"
#include "kernel/scene/transform_blocks.h"

namespace lapidary {

namespace {

// What every object and CSG operation takes.
struct CommonProperties {
    std::optional<Colour> colour;
    std::optional<double> shininess;
    std::optional<double> priority;

    static void describe(Schema<CommonProperties>& schema) {
        schema.summary("What every object and CSG operation takes.");
        schema.add("colour", &CommonProperties::colour).between(0, 1).help("Diffuse colour; short for a plain material.");
        schema.add("shininess", &CommonProperties::shininess).at_least(0).help("Exponent of the highlight.");
        schema.add("priority", &CommonProperties::priority).help("Where solids overlap, the medium is of the highest.");
    }
};

const Schema<CommonProperties>& common_schema() {
    static const Schema<CommonProperties> schema;
    return schema;
}

// What the items of a block, or of a branch of one, amount to.
struct Contents {
    CommonProperties common;
    std::vector<SceneNodePtr> operands;
    TransformFactors factors;
    SceneMaterialPtr material;
    std::optional<Place> material_place;
    bool failed = false;

    bool is_decorated() const { return !factors.empty() || material || common.colour || common.shininess || common.priority; }
};

class ContentsReader {
public:
    // An operation, or a branch of one: holds objects. `operands_need_use`: objects inside only define their names.
    ContentsReader(std::string_view owner, bool operands_need_use, Contents& contents, BuildContext& context)
        : owner_(owner),
          operands_need_use_(operands_need_use),
          contents_(contents),
          context_(context),
          common_(common_schema(), &contents.common, owner, context) {}

    // A leaf: holds no objects, but properties of its own.
    ContentsReader(std::string_view owner, PropertyReader& leaf, Contents& contents, BuildContext& context)
        : ContentsReader(owner, false, contents, context) {
        leaf_ = &leaf;
    }

    void read(const Items& items) {
        for (const Item& item : items) {
            if (const auto* property = std::get_if<Property>(&item))
                read_property(*property);
            else if (const auto* reference = std::get_if<Reference>(&item))
                read_reference(*reference);
            else
                read_block(*std::get<std::unique_ptr<Block>>(item));
        }
        if (common_.failed()) contents_.failed = true;
        resolve_material();
    }

private:
    void read_property(const Property& property) {
        if (leaf_ && leaf_->read(property)) return;
        if (common_.read(property)) return;
        contents_.failed = true;
        std::vector<std::string> known = leaf_ ? leaf_->known() : std::vector<std::string>();
        for (std::string& name : common_.known()) known.push_back(std::move(name));
        context_.vocabulary.report_property(property, owner_, known);
    }

    void read_reference(const Reference& reference) {
        const NamedThing* thing = context_.names.use(reference);
        if (!thing) {
            contents_.failed = true;
            return;
        }
        switch (thing->kind) {
            case NameKind::object:
                if (leaf_) return refuse_operand(reference.place, reference.name);
                return add_operand(thing->get<SceneNodePtr>());
            case NameKind::material:
                return set_material(thing->get<SceneMaterialPtr>(), reference.place);
            case NameKind::transform: {
                const auto factors = thing->get<TransformFactors>();
                contents_.factors.insert(contents_.factors.end(), factors.begin(), factors.end());
                return;
            }
            case NameKind::light:
                contents_.failed = true;
                context_.messages.error(reference.place, fmt::format("'{}' is {}", reference.name, home_of(thing->kind)));
                return;
        }
    }

    void read_block(const Block& block) {
        if (block.keyword == "transform") {
            if (!read_transform_block(block, contents_.factors, false, context_)) contents_.failed = true;
        } else if (block.keyword == "material") {
            set_material(build_material_block(block, false, context_), block.place);
        } else if (const auto operation = operation_of(block.keyword)) {
            if (leaf_) return refuse_operand(block.place, block.keyword);
            add_operand(build_operation(block, *operation, operands_need_use_, context_));
        } else if (const Plugin* object = context_.vocabulary.find(PluginKind::object, block.keyword)) {
            if (leaf_) return refuse_operand(block.place, block.keyword);
            add_operand(build_leaf(block, *object, operands_need_use_, context_));
        } else if (const Plugin* texture = context_.vocabulary.find(PluginKind::material, block.keyword)) {
            set_material(build_texture(block, *texture, false, context_), block.place);
        } else {
            report_unknown_block(block);
        }
    }

    void report_unknown_block(const Block& block) {
        contents_.failed = true;
        if (report_property_as_block(block)) return;
        std::vector<std::string> keywords{"transform", "material"};
        if (leaf_) return context_.vocabulary.report_block(block, {PluginKind::material}, std::move(keywords));
        for (const auto operation : {"union", "merge", "subtraction", "difference", "intersection", "symdiff"})
            keywords.emplace_back(operation);
        context_.vocabulary.report_block(block, {PluginKind::object}, std::move(keywords));
    }

    // `radius { }` where `radius( );` is meant.
    bool report_property_as_block(const Block& block) {
        return (leaf_ && leaf_->report_block(block)) || common_.report_block(block);
    }

    void refuse_operand(const Place& place, const std::string& what) {
        contents_.failed = true;
        context_.messages.error(
            place,
            fmt::format("'{}' cannot stand in '{}', which holds no objects; CSG operations do: union {{ … }}", what, owner_));
    }

    void add_operand(SceneNodePtr operand) {
        if (operand)
            contents_.operands.push_back(std::move(operand));
        else
            contents_.failed = true;
    }

    void set_material(SceneMaterialPtr material, const Place& place) {
        if (contents_.material_place) context_.messages.warning(place, "a second material stands here; the last one counts");
        contents_.material_place = place;
        contents_.material = std::move(material);
        if (!contents_.material) contents_.failed = true;
    }

    // `colour` and `shininess` are short for a plain material, unless there is another.
    void resolve_material() {
        CommonProperties& common = contents_.common;
        if (!common.colour && !common.shininess) return;
        if (contents_.material_place) {
            for (const auto keyword : {"colour", "shininess"})
                if (const Place* place = common_.place_of(keyword))
                    context_.messages.warning(
                        *place, fmt::format("'{}' has no effect beside a material; write it inside the material", keyword));
        } else {
            const Place* place = common_.place_of(common.colour ? "colour" : "shininess");
            const Matter plain;
            contents_.material = plain_material(common.colour.value_or(plain.colour), common.shininess.value_or(plain.shininess),
                                                *place, context_);
        }
        common.colour.reset();
        common.shininess.reset();
    }

    std::string_view owner_;
    bool operands_need_use_ = false;
    Contents& contents_;
    BuildContext& context_;
    PropertyReader common_;
    PropertyReader* leaf_ = nullptr;
};

// Gives the node what stands in its block. Null where the transforms cannot be composed.
std::shared_ptr<SceneNode> decorate(std::shared_ptr<SceneNode> node, Contents& contents, const Place& place,
                                    BuildContext& context) {
    node->place = place;
    if (!contents.factors.empty()) {
        const auto transform = compose(contents.factors, place, context);
        if (!transform) return nullptr;
        node->transform = *transform;
    }
    node->factors = std::move(contents.factors);
    node->material = std::move(contents.material);
    node->priority = contents.common.priority;
    return node;
}

std::shared_ptr<SceneNode> make_operation(Operation operation, Contents& contents, const Place& place, BuildContext& context) {
    auto node = std::make_shared<SceneNode>();
    node->operation = operation;
    node->operands = std::move(contents.operands);
    return decorate(std::move(node), contents, place, context);
}

class OperationBuilder {
public:
    OperationBuilder(const Block& block, Operation operation, bool operands_need_use, BuildContext& context)
        : block_(block), operation_(operation), operands_need_use_(operands_need_use), context_(context) {}

    std::shared_ptr<SceneNode> build() {
        const NestingGuard guard(context_, block_);
        if (guard.too_deep()) return nullptr;
        return block_.branches.size() == 1 ? build_group() : build_branches();
    }

private:
    // One block: its items are the operands.
    std::shared_ptr<SceneNode> build_group() {
        Contents contents = read(block_.branches.front().items);
        if (contents.failed) return nullptr;
        if (contents.operands.empty())
            context_.messages.warning(block_.place,
                                      fmt::format("this '{}' holds no objects: it is the empty set", block_.keyword));
        return make_operation(operation_, contents, block_.place, context_);
    }

    // `a with b with c`: the branches are the operands, (a op b) op c.
    std::shared_ptr<SceneNode> build_branches() {
        Contents all;
        for (const Branch& branch : block_.branches) {
            if (SceneNodePtr operand = build_branch(branch))
                all.operands.push_back(std::move(operand));
            else
                all.failed = true;
        }
        return all.failed ? nullptr : make_operation(operation_, all, block_.place, context_);
    }

    // The union of what a branch holds. What stands alone in a branch stands for itself.
    SceneNodePtr build_branch(const Branch& branch) {
        Contents contents = read(branch.items);
        if (contents.failed) return nullptr;
        if (contents.operands.empty())
            context_.messages.warning(branch.place,
                                      fmt::format("this branch of '{}' holds no objects: it is the empty set", block_.keyword));
        if (contents.operands.size() == 1 && !contents.is_decorated()) return contents.operands.front();
        return make_operation(Operation::union_, contents, branch.place, context_);
    }

    Contents read(const Items& items) {
        Contents contents;
        ContentsReader(block_.keyword, operands_need_use_, contents, context_).read(items);
        return contents;
    }

    const Block& block_;
    Operation operation_;
    bool operands_need_use_;
    BuildContext& context_;
};

std::shared_ptr<SceneNode> read_leaf(const Block& block, const Plugin& plugin, BuildContext& context) {
    const NestingGuard guard(context, block);
    if (guard.too_deep()) return nullptr;
    refuse_branches(block, context);
    const std::shared_ptr<Object> object = plugin.create_object();
    PropertyReader properties(plugin.schema(), dynamic_cast<void*>(object.get()), block.keyword, context);
    Contents contents;
    ContentsReader(block.keyword, properties, contents, context).read(block.branches.front().items);
    if (!properties.finish(block.place) || contents.failed) return nullptr;

    auto node = std::make_shared<SceneNode>();
    node->object = context.objects.share(object, plugin, properties.take_given());
    node->plugin = &plugin;
    return decorate(std::move(node), contents, block.place, context);
}

SceneNodePtr finish_definition(NamedThing* name, std::shared_ptr<SceneNode> node) {
    if (!name) return node;
    name->under_way = false;
    if (node) {
        node->name = name->name;
        name->value = SceneNodePtr(node);
    }
    return node;
}

}  // namespace

SceneNodePtr build_operation(const Block& block, Operation operation, bool needs_use, BuildContext& context) {
    NamedThing* name = context.names.reserve(block, NameKind::object, needs_use);
    return finish_definition(name, OperationBuilder(block, operation, false, context).build());
}

SceneNodePtr build_leaf(const Block& block, const Plugin& plugin, bool needs_use, BuildContext& context) {
    NamedThing* name = context.names.reserve(block, NameKind::object, needs_use);
    std::shared_ptr<SceneNode> leaf;
    try {
        leaf = read_leaf(block, plugin, context);
    } catch (const std::exception& exception) {
        context.messages.error(block.place, exception.what());
    }
    return finish_definition(name, std::move(leaf));
}

SceneNodePtr build_objects(const Block& block, bool is_rendered, BuildContext& context) {
    refuse_name(block, context);
    refuse_branches(block, context);
    return OperationBuilder(block, Operation::union_, !is_rendered, context).build();
}

}  // namespace lapidary
