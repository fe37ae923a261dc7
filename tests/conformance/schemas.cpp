// SPDX-License-Identifier: MIT
//
// What holds for the declaration of every plugin, of whatever kind: it is there, it explains itself, and what it says about
// defaults is true.

#include <cctype>
#include <filesystem>

#include "conformance/instances.h"
#include "kernel/interfaces/light.h"
#include "kernel/interfaces/material.h"
#include "kernel/interfaces/object.h"
#include "kernel/interfaces/output.h"
#include "support/catch.h"

namespace lapidary::test {
namespace {

constexpr PluginKind kinds[] = {PluginKind::object, PluginKind::material, PluginKind::light, PluginKind::output};

// Calls `check` with the most derived address of a new instance.
template <class F>
void with_instance(const Plugin& plugin, F check) {
    const auto run = [&](const auto& instance) { check(dynamic_cast<void*>(instance.get())); };
    switch (plugin.kind()) {
        case PluginKind::object:
            run(plugin.create_object());
            break;
        case PluginKind::material:
            run(plugin.create_material());
            break;
        case PluginKind::light:
            run(plugin.create_light());
            break;
        case PluginKind::output:
            run(plugin.create_output());
            break;
    }
}

bool is_sentence(const std::string& text) { return !text.empty() && text.back() == '.'; }

bool is_keyword(const std::string& name) {
    if (name.empty() || std::isdigit(static_cast<unsigned char>(name.front()))) return false;
    for (unsigned char c : name)
        if (!std::islower(c) && !std::isdigit(c) && c != '_') return false;
    return true;
}

bool equal(const std::vector<std::vector<Value>>& a, const std::vector<std::vector<Value>>& b) {
    if (a.size() != b.size()) return false;
    for (std::size_t i = 0; i < a.size(); ++i) {
        if (a[i].size() != b[i].size()) return false;
        for (std::size_t k = 0; k < a[i].size(); ++k)
            if (a[i][k].number != b[i][k].number || a[i][k].text != b[i][k].text) return false;
    }
    return true;
}

template <class F>
void for_every_plugin(F check) {
    for (PluginKind kind : kinds)
        for (const std::string& keyword : registry().keywords(kind)) {
            CAPTURE(keyword);
            check(plugin(kind, keyword));
        }
}

}  // namespace

TEST_CASE("every file of the plugin folders became a plugin that loads") {
    namespace fs = std::filesystem;
    for (PluginKind kind : kinds)
        for (const auto& file : fs::directory_iterator(fs::path(LAPIDARY_SOURCE_FOLDER) / "plugins" / folder_of(kind)))
            if (file.path().extension() == ".cpp") plugin(kind, file.path().stem().string());
}

TEST_CASE("every plugin explains itself and its properties") {
    for_every_plugin([](const Plugin& p) {
        CHECK(is_keyword(p.keyword()));
        CHECK(is_sentence(p.schema().summary()));
        for (const PropertySchema& property : p.schema().properties()) {
            CAPTURE(property.name);
            CHECK(is_keyword(property.name));
            CHECK(is_sentence(property.help));
            CHECK(property.least_values >= 1);
            CHECK(property.least_values <= property.most_values);
            CHECK(p.schema().find(property.name) == &property);  // no name twice
        }
        for (const ChildSchema& child : p.schema().children()) {
            CAPTURE(child.name);
            CHECK(is_sentence(child.help));
        }
    });
}

TEST_CASE("every default lies in its range and meets the requirements") {
    for_every_plugin([](const Plugin& p) {
        with_instance(p, [&](void* object) {
            for (const PropertySchema& property : p.schema().properties()) {
                CAPTURE(property.name);
                const auto lines = property.read(object);
                if (!property.optional) CHECK(lines.size() == 1);
                for (const auto& line : lines) {
                    CHECK(static_cast<int>(line.size()) >= property.least_values);
                    CHECK(static_cast<int>(line.size()) <= property.most_values);
                    for (std::size_t i = 0; i < line.size(); ++i)
                        if (property.shape_at(i) == Shape::number || property.shape_at(i) == Shape::integer)
                            CHECK(property.range.contains(line[i].number));
                }
            }
            for (const Requirement& requirement : p.schema().requirements()) {
                CAPTURE(requirement.sentence);
                CHECK(requirement.holds(object));
            }
        });
    });
}

TEST_CASE("every property gives back what it was given") {
    Random random(3);
    for_every_plugin([&](const Plugin& p) {
        for (const PropertySchema& property : p.schema().properties())
            with_instance(p, [&](void* object) {
                CAPTURE(property.name);
                const std::vector<Value> values = random_values(property, random);
                if (values.empty()) return;
                property.assign(object, values);
                const auto lines = property.read(object);
                REQUIRE_FALSE(lines.empty());
                CHECK(equal({lines.back()}, {values}));
            });
    });
}

}  // namespace lapidary::test
