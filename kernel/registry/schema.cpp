// SPDX-License-Identifier: MIT
//
// What a schema tells the user: signatures, ranges and defaults in the words of the scene language.
#include "kernel/registry/schema.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lapidary {

namespace {

// 20deg rather than 0.3490658503988659, where the angle is a round number of degrees.
std::string angle_text(double radians) {
    const double degrees = radians * 180 / std::numbers::pi;
    const double rounded = std::round(degrees * 1e6) / 1e6;
    const bool round = std::fabs(degrees - rounded) <= 1e-13 * std::fabs(degrees);
    return radians != 0 && round ? fmt::format("{}deg", rounded) : fmt::format("{}", radians);
}

std::string number_text(double number, Unit unit) { return unit == Unit::angle ? angle_text(number) : fmt::format("{}", number); }

std::string value_text(const Value& value, Unit unit) {
    switch (value.kind) {
        case Value::Kind::number:
            return number_text(value.number, unit);
        case Value::Kind::text:
            return '"' + value.text + '"';
        case Value::Kind::word:
            return value.text;
    }
    return {};
}

std::string values_text(const std::vector<Value>& values, Unit unit) {
    std::string text;
    for (const Value& value : values) text += (text.empty() ? "" : ", ") + value_text(value, unit);
    return values.size() == 1 ? text : '(' + text + ')';
}

// The names of `count` numbers: the property's initial for one, x y z for a triple, a b c … otherwise.
std::string number_names(const PropertySchema& property) {
    const int count = property.most_values;
    if (property.shape == Shape::colour && count == 3) return "r, g, b";
    if (property.shape == Shape::integer && count == 1) return "n";
    if (count == 1) return property.name.substr(0, 1);
    std::string names;
    for (int i = 0; i < count && i < 26; ++i) {
        if (i > 0) names += ", ";
        names += count == 3 ? static_cast<char>('x' + i) : static_cast<char>('a' + i);
    }
    return names;
}

std::string word_names(const PropertySchema& property) {
    std::string names;
    for (const std::string& word : property.words) names += (names.empty() ? "" : " | ") + word;
    if (names.empty()) names = "word";
    return property.most_values > 1 ? names + ", …" : names;
}

// "box" | "gaussian"
std::string quoted_names(const PropertySchema& property) {
    std::string names;
    for (const std::string& word : property.words) names += (names.empty() ? "\"" : " | \"") + word + '"';
    return names;
}

// Values that differ in shape are called by it.
std::string shape_names(const PropertySchema& property) {
    std::string names;
    for (const Shape shape : property.shapes) {
        if (!names.empty()) names += ", ";
        if (shape == Shape::text)
            names += property.words.empty() ? "\"text\"" : quoted_names(property);
        else
            names += shape == Shape::word ? "word" : "number";
    }
    return names;
}

}  // namespace

double Range::clamp(double v) const {
    if (contains(v)) return v;
    // The numbers next to an open end are too small to be of use (a radius of 5e-324), so that end is kept a millionth away.
    const auto inside = [](double bound, double step) { return bound + step * std::max(1.0, std::fabs(bound)); };
    const double lowest = low_open ? inside(low, 1e-6) : low;
    const double highest = high_open ? inside(high, -1e-6) : high;
    if (lowest > highest) return 0.5 * low + 0.5 * high;
    if (v > highest) return highest;
    if (v < lowest) return lowest;
    // Not a number.
    if (std::isfinite(lowest)) return lowest;
    return std::isfinite(highest) ? highest : 0;
}

std::string Range::describe(Unit unit) const {
    const bool has_low = low > -std::numeric_limits<double>::infinity();
    const bool has_high = high < std::numeric_limits<double>::infinity();
    const std::string lowest = number_text(low, unit), highest = number_text(high, unit);
    if (has_low && has_high && !low_open && !high_open) return lowest + " to " + highest;
    std::string text;
    if (has_low) text = (low_open ? "above " : "at least ") + lowest;
    if (has_low && has_high) text += " and ";
    if (has_high) text += (high_open ? "below " : "at most ") + highest;
    return text;
}

std::string PropertySchema::signature() const {
    if (!arguments.empty()) return '(' + arguments + ')';
    if (!shapes.empty()) return '(' + shape_names(*this) + ')';
    switch (shape) {
        case Shape::number:
        case Shape::integer:
        case Shape::colour:
            return '(' + number_names(*this) + ')';
        case Shape::text:
            return "(\"text\")";
        case Shape::word:
            return '(' + word_names(*this) + ')';
    }
    return "()";
}

const PropertySchema* SchemaBase::find(std::string_view name) const {
    const auto found = std::ranges::find(properties_, name, &PropertySchema::name);
    return found == properties_.end() ? nullptr : &*found;
}

std::string SchemaBase::default_text(const PropertySchema& property) const {
    std::string text;
    for (const std::vector<Value>& line : property.read(specimen_.get()))
        text += (text.empty() ? "" : " ") + values_text(line, property.unit);
    return text.empty() ? "none" : text;
}

Value number_value(double v) {
    Value value;
    value.number = v;
    return value;
}

Value text_value(std::string v) {
    Value value;
    value.kind = Value::Kind::text;
    value.text = std::move(v);
    return value;
}

Value word_value(std::string v) {
    Value value;
    value.kind = Value::Kind::word;
    value.text = std::move(v);
    return value;
}

}  // namespace lapidary
