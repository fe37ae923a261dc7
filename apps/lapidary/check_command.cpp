// SPDX-License-Identifier: MIT
//
// lapidary check: all messages about a scene, for people or as JSON for programs.
#include <fmt/format.h>

#include <cstdio>
#include <nlohmann/json.hpp>

#include "apps/lapidary/command_line.h"
#include "apps/lapidary/session.h"
#include "kernel/prepare/world.h"

namespace lapidary {

namespace {

bool is_error(const Message& message) { return message.severity == Severity::error; }

nlohmann::ordered_json to_json(const Message& message) {
    nlohmann::ordered_json json;
    json["severity"] = is_error(message) ? "error" : "warning";
    json["text"] = message.text;
    if (!message.file.empty()) json["file"] = message.file;
    if (message.line > 0) json["line"] = message.line, json["column"] = message.column;
    if (!message.excerpt.empty()) json["excerpt"] = message.excerpt, json["caret"] = message.caret;
    if (!message.included_from.empty()) json["included_from"] = message.included_from;
    return json;
}

void print_json(const std::vector<Message>& messages, std::size_t errors, std::size_t warnings) {
    nlohmann::ordered_json json;
    json["errors"] = errors;
    json["warnings"] = warnings;
    json["messages"] = nlohmann::ordered_json::array();
    for (const Message& message : messages) json["messages"].push_back(to_json(message));
    // What is not UTF-8 in a message becomes a replacement character.
    fmt::print("{}\n", json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
}

std::string counted(std::size_t n, const char* thing) { return fmt::format("{} {}{}", n, thing, n == 1 ? "" : "s"); }

}  // namespace

ExitCode check_command(const Words& words) {
    const auto arguments = parse_check(words);
    if (!arguments) return ExitCode::success;
    Messages messages;
    Session session(arguments->scene, messages);
    session.load();
    if (const auto scene = session.build()) prepare_world(*scene, messages);

    std::vector<Message> shown = messages.all();
    if (arguments->no_warnings) std::erase_if(shown, [](const Message& message) { return !is_error(message); });
    if (arguments->json) {
        print_json(shown, messages.errors(), messages.warnings());
    } else {
        for (const Message& message : shown) fmt::print("{}", message.format());
        fmt::print("{}: {}, {}\n", arguments->scene.file.string(), counted(messages.errors(), "error"),
                   counted(messages.warnings(), "warning"));
    }
    return messages.has_errors() ? ExitCode::scene : ExitCode::success;
}

}  // namespace lapidary
