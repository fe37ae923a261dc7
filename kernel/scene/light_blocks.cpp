// SPDX-License-Identifier: MIT
#include "kernel/scene/light_blocks.h"

#include <fmt/format.h>

#include <exception>

#include "kernel/scene/properties.h"
#include "kernel/scene/transform_blocks.h"

namespace lapidary {

namespace {

class LightReader {
public:
    LightReader(const Block& block, const Plugin& plugin, BuildContext& context)
        : block_(block), plugin_(plugin), context_(context) {}

    LightPrototypePtr read() {
        refuse_branches(block_, context_);
        const std::shared_ptr<Light> light = plugin_.create_light();
        PropertyReader properties(plugin_.schema(), dynamic_cast<void*>(light.get()), block_.keyword, context_);
        auto prototype = std::make_shared<LightPrototype>();
        for (const Item& item : block_.branches.front().items) {
            if (const auto* property = std::get_if<Property>(&item))
                read_property(*property, properties);
            else if (const auto* reference = std::get_if<Reference>(&item))
                read_reference(*reference, prototype->factors);
            else
                read_block(*std::get<std::unique_ptr<Block>>(item), properties, prototype->factors);
        }
        if (!properties.finish(block_.place) || failed_) return nullptr;
        prototype->light = light;
        prototype->plugin = &plugin_;
        prototype->name = block_.name;
        prototype->place = block_.place;
        return prototype;
    }

private:
    void read_property(const Property& property, PropertyReader& properties) {
        if (properties.read(property)) return;
        failed_ = true;
        context_.vocabulary.report_property(property, block_.keyword, properties.known());
    }

    void read_reference(const Reference& reference, TransformFactors& factors) {
        const NamedThing* thing = context_.names.use(reference);
        if (thing && thing->kind == NameKind::transform) {
            const auto named = thing->get<TransformFactors>();
            factors.insert(factors.end(), named.begin(), named.end());
            return;
        }
        failed_ = true;
        if (thing) context_.messages.error(reference.place, fmt::format("'{}' is {}", reference.name, home_of(thing->kind)));
    }

    void read_block(const Block& block, PropertyReader& properties, TransformFactors& factors) {
        if (block.keyword == "transform") {
            if (!read_transform_block(block, factors, false, context_)) failed_ = true;
            return;
        }
        failed_ = true;
        if (!properties.report_block(block)) context_.vocabulary.report_block(block, {}, {"transform"});
    }

    const Block& block_;
    const Plugin& plugin_;
    BuildContext& context_;
    bool failed_ = false;
};

// A named light may stand in several places: each gets a light of its own, with the values of the prototype.
std::shared_ptr<Light> copy_of(const LightPrototype& prototype) {
    std::shared_ptr<Light> copy = prototype.plugin->create_light();
    void* target = dynamic_cast<void*>(copy.get());
    const void* source = dynamic_cast<const void*>(prototype.light.get());
    for (const PropertySchema& property : prototype.plugin->schema().properties())
        for (const std::vector<Value>& values : property.read(source)) property.assign(target, values);
    return copy;
}

// The light with the transforms of its block and of the one around it applied to its points and directions.
void place_light(const LightPrototype& prototype, const TransformFactors& outer, std::vector<SceneLight>& lights,
                 BuildContext& context) {
    TransformFactors factors = prototype.factors;
    factors.insert(factors.end(), outer.begin(), outer.end());
    const auto transform = compose(factors, prototype.place, context);
    if (!transform) return;
    try {
        const std::shared_ptr<Light> light = copy_of(prototype);
        const Transform to_world(*transform);
        const SchemaBase& schema = prototype.plugin->schema();
        void* target = dynamic_cast<void*>(light.get());
        if (!factors.empty())
            for (const PropertySchema& property : schema.properties())
                if (property.place) property.place(target, to_world);
        schema.derive(target);
        lights.push_back({light, prototype.plugin, prototype.name, prototype.place});
    } catch (const std::exception& exception) {
        context.messages.error(prototype.place, exception.what());
    }
}

// What stands in a `lights` block.
class LightsReader {
public:
    explicit LightsReader(BuildContext& context) : context_(context) {}

    void read(const Block& block, std::vector<SceneLight>& lights) {
        for (const Item& item : block.branches.front().items) {
            if (const auto* property = std::get_if<Property>(&item))
                context_.vocabulary.report_property(*property, block.keyword, {});
            else if (const auto* reference = std::get_if<Reference>(&item))
                read_reference(*reference);
            else
                read_block(*std::get<std::unique_ptr<Block>>(item));
        }
        for (const LightPrototypePtr& prototype : prototypes_) place_light(*prototype, factors_, lights, context_);
    }

private:
    void read_reference(const Reference& reference) {
        const NamedThing* thing = context_.names.use(reference);
        if (!thing) return;
        if (thing->kind == NameKind::light) {
            add(thing->get<LightPrototypePtr>());
        } else if (thing->kind == NameKind::transform) {
            const auto named = thing->get<TransformFactors>();
            factors_.insert(factors_.end(), named.begin(), named.end());
        } else {
            context_.messages.error(reference.place, fmt::format("'{}' is {}", reference.name, home_of(thing->kind)));
        }
    }

    void read_block(const Block& block) {
        if (block.keyword == "transform")
            read_transform_block(block, factors_, false, context_);
        else if (const Plugin* plugin = context_.vocabulary.find(PluginKind::light, block.keyword))
            add(build_light(block, *plugin, false, context_));
        else
            context_.vocabulary.report_block(block, {PluginKind::light}, {"transform"});
    }

    void add(LightPrototypePtr prototype) {
        if (prototype) prototypes_.push_back(std::move(prototype));
    }

    BuildContext& context_;
    std::vector<LightPrototypePtr> prototypes_;
    TransformFactors factors_;
};

}  // namespace

LightPrototypePtr build_light(const Block& block, const Plugin& plugin, bool needs_use, BuildContext& context) {
    NamedThing* name = context.names.reserve(block, NameKind::light, needs_use);
    LightPrototypePtr prototype;
    try {
        prototype = LightReader(block, plugin, context).read();
    } catch (const std::exception& exception) {
        context.messages.error(block.place, exception.what());
    }
    if (name) {
        name->under_way = false;
        if (prototype) name->value = prototype;
    }
    return prototype;
}

void build_lights(const Block& block, std::vector<SceneLight>& lights, BuildContext& context) {
    refuse_name(block, context);
    refuse_branches(block, context);
    LightsReader(context).read(block, lights);
}

}  // namespace lapidary
