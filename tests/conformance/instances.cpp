// SPDX-License-Identifier: MIT
#include "conformance/instances.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "kernel/interfaces/light.h"
#include "kernel/interfaces/object.h"
#include "support/catch.h"

namespace lapidary::test {

double Random::magnitude(double low_exponent, double high_exponent) { return std::pow(10, uniform(low_exponent, high_exponent)); }

Vector Random::direction() {
    for (;;) {
        const Vector v{uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)};
        const double square = dot(v, v);
        if (square > 0.01 && square < 1) return normalize(v);
    }
}

Registry& registry() {
    static Registry plugins({LAPIDARY_PLUGIN_FOLDER});
    return plugins;
}

const Plugin& plugin(PluginKind kind, const std::string& keyword) {
    std::string reason;
    const Plugin* found = registry().find(kind, keyword, reason);
    INFO(keyword << ": " << reason);
    REQUIRE(found);
    return *found;
}

namespace {

double random_number(const Range& range, Random& random) {
    const bool bounded_below = std::isfinite(range.low), bounded_above = std::isfinite(range.high);
    double value = random.magnitude(-2, 2);
    if (bounded_below && bounded_above)
        value = random.uniform(range.low, range.high);
    else if (bounded_below)
        value += range.low;
    else if (bounded_above)
        value = range.high - value;
    else
        value *= random.uniform(0, 1) < 0.5 ? 1 : -1;
    return range.clamp(value);
}

}  // namespace

std::vector<Value> random_values(const PropertySchema& property, Random& random) {
    std::vector<Value> values;
    for (int i = 0; i < property.least_values; ++i) {
        switch (property.shape_at(values.size())) {
            case Shape::number:
                values.push_back(number_value(random_number(property.range, random)));
                break;
            case Shape::integer:
                values.push_back(number_value(property.range.clamp(std::round(random_number(property.range, random)))));
                break;
            case Shape::colour:
                values.push_back(number_value(random.uniform(0, 1)));
                break;
            case Shape::word:
                if (property.words.empty()) return {};
                values.push_back(word_value(property.words[random.below(static_cast<int>(property.words.size()))]));
                break;
            case Shape::text:
                return {};
        }
    }
    return values;
}

void randomize(void* object, const SchemaBase& schema, Random& random) {
    for (int attempt = 0; attempt < 1000; ++attempt) {
        for (const PropertySchema& property : schema.properties()) {
            // An optional property is present in every second instance.
            if (property.optional && random.below(2) == 0) continue;
            const std::vector<Value> values = random_values(property, random);
            if (!values.empty()) property.assign(object, values);
        }
        const auto& requirements = schema.requirements();
        if (!std::all_of(requirements.begin(), requirements.end(), [&](const Requirement& r) { return r.holds(object); }))
            continue;
        schema.derive(object);
        return;
    }
    FAIL("no values were found that meet the schema's requirements");
}

std::unique_ptr<Object> random_object(const Plugin& plugin, Random& random) {
    auto object = plugin.create_object();
    randomize(dynamic_cast<void*>(object.get()), plugin.schema(), random);
    return object;
}

std::unique_ptr<Light> random_light(const Plugin& plugin, Random& random) {
    auto light = plugin.create_light();
    randomize(dynamic_cast<void*>(light.get()), plugin.schema(), random);
    return light;
}

namespace {

// Of a kind without children, where nothing may nest.
MaterialPtr random_child(Random& random, int depth) {
    const auto keywords = registry().keywords(PluginKind::material);
    for (;;) {
        const auto chosen = static_cast<std::size_t>(random.below(static_cast<int>(keywords.size())));
        const Plugin& child = plugin(PluginKind::material, keywords[chosen]);
        if (depth > 0 || child.schema().children().empty()) return random_material(child, random, depth);
    }
}

}  // namespace

MaterialPtr random_material(const Plugin& plugin, Random& random, int depth) {
    std::shared_ptr<Material> material = plugin.create_material();
    void* target = dynamic_cast<void*>(material.get());
    for (const ChildSchema& slot : plugin.schema().children()) {
        if (slot.optional && random.below(2) == 0) continue;
        for (int i = 0; i < (slot.repeats ? 2 : 1); ++i) slot.assign(target, random_child(random, depth - 1));
    }
    const PropertySchema* relief = plugin.schema().find("relief");
    if (relief && random.below(3) == 0) relief->assign(target, {text_value("noise"), number_value(random.magnitude(-1, 1))});
    randomize(target, plugin.schema(), random);
    return material;
}

std::string describe(const void* object, const SchemaBase& schema) {
    std::ostringstream text;
    text.precision(17);
    for (const PropertySchema& property : schema.properties())
        for (const auto& line : property.read(object)) {
            text << property.name << '(';
            for (std::size_t i = 0; i < line.size(); ++i) {
                text << (i ? ", " : "");
                if (line[i].kind == Value::Kind::number)
                    text << line[i].number;
                else
                    text << line[i].text;
            }
            text << "); ";
        }
    return text.str();
}

}  // namespace lapidary::test
