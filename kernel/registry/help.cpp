// SPDX-License-Identifier: MIT
#include "kernel/registry/help.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <vector>

namespace lapidary {

namespace {

// A line that begins with a term, and what is said about it in lines that stand beside one another.
struct Entry {
    std::string term;
    std::vector<std::string> lines;
};

// Characters as the terminal counts them: bytes of UTF-8 that continue a character take no room.
std::size_t width_of(std::string_view text) {
    return static_cast<std::size_t>(std::ranges::count_if(text, [](unsigned char c) { return (c & 0xc0) != 0x80; }));
}

std::string table(const std::vector<Entry>& entries) {
    std::size_t widest = 0;
    for (const Entry& entry : entries) widest = std::max(widest, width_of(entry.term));
    std::string text;
    for (const Entry& entry : entries) {
        std::string margin = "  " + entry.term + std::string(widest - width_of(entry.term), ' ');
        for (const std::string& line : entry.lines) {
            text += margin + "   " + line + '\n';
            margin.assign(widest + 2, ' ');
        }
    }
    return text;
}

Entry property_entry(const SchemaBase& schema, const PropertySchema& property) {
    Entry entry{property.name + property.signature(), {}};
    const std::string text = schema.default_text(property);
    const std::string absent = property.optional && text == "none" ? "nothing unless given" : text + " unless given";
    entry.lines.push_back(describe_values(property) + "; " + absent);
    if (property.repeats) entry.lines.push_back("May be written several times.");
    if (!property.help.empty()) entry.lines.push_back(property.help);
    return entry;
}

Entry child_entry(const ChildSchema& child) {
    Entry entry{child.repeats ? child.name + " …" : child.name, {child.help}};
    if (child.optional) entry.lines.push_back("May be left out.");
    return entry;
}

std::string join_alternatives(const std::vector<std::string>& words) {
    std::string text;
    for (std::size_t i = 0; i < words.size(); ++i) {
        if (i > 0) text += i + 1 == words.size() ? " or " : ", ";
        text += words[i];
    }
    return text;
}

}  // namespace

std::string describe_values(const PropertySchema& property) {
    std::string what;
    switch (property.shape) {
        case Shape::colour:
            what = "colour";
            break;
        case Shape::text:
            what = property.words.empty() ? "text" : join_alternatives(property.words);
            break;
        case Shape::word:
            what = property.words.empty() ? "words" : join_alternatives(property.words);
            break;
        case Shape::integer:
            what = "whole number";
            break;
        case Shape::number:
            what = property.unit == Unit::length ? "length" : property.unit == Unit::angle ? "angle" : "number";
            break;
    }
    if (property.shape == Shape::number && property.most_values > 1) what += 's';
    const std::string range = property.range.describe(property.unit);
    return range.empty() ? what : what + ", " + range;
}

std::string help_text(const SchemaBase& schema, const std::string& keyword) {
    std::string text = fmt::format("{}: {}\n", keyword, schema.summary());
    if (!schema.properties().empty()) {
        std::vector<Entry> entries;
        for (const PropertySchema& property : schema.properties()) entries.push_back(property_entry(schema, property));
        text += '\n' + table(entries);
    }
    if (!schema.children().empty()) {
        std::vector<Entry> entries;
        for (const ChildSchema& child : schema.children()) entries.push_back(child_entry(child));
        text += "\nTextures inside, in the order of writing:\n" + table(entries);
    }
    if (!schema.requirements().empty()) {
        text += "\nConditions:\n";
        for (const Requirement& requirement : schema.requirements()) text += "  " + requirement.sentence + '\n';
    }
    return text;
}

std::string help_text(const Plugin& plugin) {
    return fmt::format("{}\n{}, from {}\n", help_text(plugin.schema(), plugin.keyword()), name_of(plugin.kind()),
                       plugin.file().string());
}

}  // namespace lapidary
