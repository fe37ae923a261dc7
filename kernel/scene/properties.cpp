// SPDX-License-Identifier: MIT
#include "kernel/scene/properties.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <numbers>

namespace lapidary {

namespace {

Value::Kind kind_of(Shape shape) {
    switch (shape) {
        case Shape::text:
            return Value::Kind::text;
        case Shape::word:
            return Value::Kind::word;
        default:
            return Value::Kind::number;
    }
}

std::string_view noun_of(Shape shape) {
    switch (shape) {
        case Shape::text:
            return "text in double quotes";
        case Shape::word:
            return "words without quotes";
        default:
            return "numbers";
    }
}

std::string describe_value(const Value& value) {
    switch (value.kind) {
        case Value::Kind::text:
            return fmt::format("the text \"{}\"", value.text);
        case Value::Kind::word:
            return fmt::format("the word '{}'", value.text);
        default:
            return fmt::format("the number {}", value.number);
    }
}

bool is_zero(const std::vector<Value>& values) {
    return std::ranges::all_of(values, [](const Value& value) { return value.number == 0; });
}

}  // namespace

std::string takes(const std::string& keyword, const std::string& signature, int least, int most, std::size_t given) {
    std::string count = fmt::format("{}", least);
    if (most != least)
        count = most == std::numeric_limits<int>::max() ? count + " or more" : fmt::format("{} to {}", least, most);
    const bool one = least == 1 && most == 1;
    return fmt::format("'{0}' takes {1} value{2}, not {3}: {0}{4};", keyword, count, one ? "" : "s", given, signature);
}

std::string list_of(const std::vector<std::string>& words) {
    std::string list;
    for (std::size_t i = 0; i < words.size(); ++i) {
        if (i > 0) list += i + 1 == words.size() ? " and " : ", ";
        list += words[i];
    }
    return list;
}

void warn_of_degrees(const Value& value, Messages& messages) {
    if (!value.angle && std::fabs(value.number) > 2 * std::numbers::pi * (1 + 1e-12))
        messages.warning(value.place, fmt::format("{} radians? 90deg is written 90deg", value.number));
}

void PropertyReader::error(const Place& place, std::string text) {
    failed_ = true;
    messages_.error(place, std::move(text));
}

std::string constant_meant(const Value& value, const BuildContext& context) {
    if (value.kind != Value::Kind::word || !context.messages.wants_errors()) return {};
    const std::string suggestion = did_you_mean(value.text, context.constants);
    return suggestion.empty() ? suggestion : fmt::format(" ({})", suggestion.substr(2));
}

bool PropertyReader::check_value(const PropertySchema& schema, const Value& value, Shape shape) {
    const bool names_constant = value.kind == Value::Kind::number && !value.text.empty();
    if (shape == Shape::word && names_constant) {
        Value word = value;
        word.kind = Value::Kind::word;
        return check_value(schema, word, shape);
    }
    if (value.kind != kind_of(shape)) {
        error(value.place, fmt::format("'{0}' takes {1}, not {2}{3}: {0}{4};", schema.name, noun_of(shape), describe_value(value),
                                       constant_meant(value, context_), schema.signature()));
    } else if (value.kind == Value::Kind::number && !std::isfinite(value.number)) {
        error(value.place, fmt::format("'{}' takes finite numbers, not {}", schema.name, value.number));
    } else if (shape == Shape::integer && value.number != std::nearbyint(value.number)) {
        error(value.place, fmt::format("'{}' takes a whole number, not {}", schema.name, value.number));
    } else if (shape != Shape::number && !schema.words.empty() &&
               std::ranges::find(schema.words, value.text) == schema.words.end()) {
        error(value.place, fmt::format("'{}' knows the words {}, not '{}'{}", schema.name, list_of(schema.words), value.text,
                                       did_you_mean(value.text, schema.words)));
    } else {
        return true;
    }
    return false;
}

bool PropertyReader::check(const PropertySchema& schema, const Property& property) {
    const auto& values = property.values;
    if (static_cast<int>(values.size()) < schema.least_values || static_cast<int>(values.size()) > schema.most_values) {
        error(property.place, takes(schema.name, schema.signature(), schema.least_values, schema.most_values, values.size()));
        return false;
    }
    for (std::size_t i = 0; i < values.size(); ++i)
        if (!check_value(schema, values[i], schema.shape_at(i))) return false;
    return true;
}

void PropertyReader::assign(const PropertySchema& schema, const Property& property) {
    const bool bounded = std::isfinite(schema.range.low) || std::isfinite(schema.range.high);
    if (schema.direction && !bounded && is_zero(property.values)) {
        messages_.warning(property.place, fmt::format("'{}' of length zero has no direction; the default is used", schema.name));
        return;
    }
    // An integer must fit the int that it fills, whatever its declared range.
    Range range = schema.range;
    if (schema.shape == Shape::integer) {
        range.low = std::max(range.low, -2147483648.0);
        range.high = std::min(range.high, 2147483647.0);
    }
    const auto inside = [&](const Value& value) { return value.kind != Value::Kind::number || range.contains(value.number); };
    if (schema.unit == Unit::angle)
        for (const Value& value : property.values) warn_of_degrees(value, messages_);
    if (std::ranges::all_of(property.values, inside)) return schema.assign(target_, property.values);

    std::vector<Value> clamped = property.values;
    for (Value& value : clamped) {
        if (inside(value)) continue;
        const double nearest = range.clamp(value.number);
        messages_.warning(value.place, fmt::format("'{}' takes numbers {}; {} was clamped to {}", schema.name, range.describe(),
                                                   value.number, nearest));
        value.number = nearest;
    }
    schema.assign(target_, clamped);
}

bool PropertyReader::read(const Property& property) {
    const PropertySchema* schema = schema_.find(property.keyword);
    if (!schema) return false;
    if (!schema->repeats && place_of(schema->name))
        messages_.warning(property.place, fmt::format("'{}' stands here a second time; the last one counts", schema->name));
    given_.push_back({schema, &property});
    if (!check(*schema, property)) return true;
    try {
        assign(*schema, property);
    } catch (const std::exception& exception) {
        error(property.place, fmt::format("'{}' does not take this '{}': {}", owner_, schema->name, exception.what()));
    } catch (...) {
        error(property.place, fmt::format("'{}' does not take this '{}'", owner_, schema->name));
    }
    return true;
}

bool PropertyReader::report_block(const Block& block) {
    const PropertySchema* schema = schema_.find(block.keyword);
    if (schema) error(block.place, fmt::format("'{0}' is written with parentheses: {0}{1};", schema->name, schema->signature()));
    return schema != nullptr;
}

bool PropertyReader::finish(const Place& place) {
    if (failed_) return false;
    for (const Requirement& requirement : schema_.requirements()) {
        bool holds = false;
        try {
            holds = requirement.holds(target_);
        } catch (...) {
            holds = false;
        }
        if (!holds) error(place, fmt::format("'{}': {}", owner_, requirement.sentence));
    }
    if (!failed_) derive(place);
    return !failed_;
}

void PropertyReader::derive(const Place& place) {
    try {
        schema_.derive(target_);
    } catch (const std::exception& exception) {
        error(place, fmt::format("'{}' does not take these properties together: {}", owner_, exception.what()));
    } catch (...) {
        error(place, fmt::format("'{}' does not take these properties together", owner_));
    }
}

const Place* PropertyReader::place_of(std::string_view keyword) const {
    for (const GivenProperty& given : given_)
        if (given.schema->name == keyword) return &given.property->place;
    return nullptr;
}

std::vector<std::string> PropertyReader::known() const {
    std::vector<std::string> names;
    for (const PropertySchema& property : schema_.properties()) names.push_back(property.name);
    return names;
}

}  // namespace lapidary
