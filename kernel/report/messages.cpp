// SPDX-License-Identifier: MIT
#include "kernel/report/messages.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "kernel/report/printable.h"

namespace lapidary {

namespace {

constexpr std::uint32_t excerpt_columns = 100;  // of a source line, around the caret
constexpr std::size_t sentence_bytes = 2000;    // beyond this a message is cut

std::string_view word_for(Severity severity) { return severity == Severity::error ? "error" : "warning"; }

std::string place_text(const Place& place) {
    const std::string name = printable(place.file->name);
    return place.line ? fmt::format("{}:{}:{}", name, place.line, place.column) : name;
}

std::string_view line_of(std::string_view text, std::uint32_t line) {
    std::size_t begin = 0;
    for (std::uint32_t i = 1; i < line; ++i) {
        const std::size_t end = text.find('\n', begin);
        if (end == std::string_view::npos) return {};
        begin = end + 1;
    }
    text.remove_prefix(begin);
    return text.substr(0, text.find('\n'));
}

// A source line as it is shown: one byte of the file may be no column of the terminal or two, so the caret's column is
// counted along.
struct Excerpt {
    std::string text;
    std::uint32_t caret = 0;
};

// Where the shown part of [begin, end) starts: at a code point, with some room in front of the caret.
std::size_t window_start(std::string_view line, std::size_t begin, std::size_t end, std::size_t caret) {
    constexpr std::size_t room = excerpt_columns / 2;
    if (end - begin <= excerpt_columns || caret - begin <= room) return begin;
    std::size_t start = caret - room;
    while (start < caret && (static_cast<unsigned char>(line[start]) & 0xC0) == 0x80) ++start;
    return start;
}

Excerpt excerpt_of(std::string_view line, std::size_t place) {
    const std::string_view blanks = " \t\r";
    const std::size_t end = line.find_last_not_of(blanks) + 1;
    const std::size_t begin = std::min({line.find_first_not_of(blanks), end, place});
    const std::size_t caret = std::min(place, end);

    Excerpt excerpt;
    std::uint32_t columns = 0;
    const auto append = [&](char32_t c) {
        append_utf8(excerpt.text, c);
        columns += static_cast<std::uint32_t>(display_width(c));
    };
    constexpr char32_t ellipsis = 0x2026;

    std::size_t at = window_start(line, begin, end, caret);
    if (at > begin) append(ellipsis);
    for (excerpt.caret = columns; at < end && (columns < excerpt_columns || at <= caret);) {
        const CodePoint c = decode_utf8(line.substr(at));
        append(harmless(c));
        at += c.length;
        if (at <= caret) excerpt.caret = columns;
    }
    if (at < end) append(ellipsis);
    return excerpt;
}

Message located(Severity severity, const Place& place, std::string text) {
    Message message;
    message.severity = severity;
    message.text = std::move(text);
    if (!place.file) return message;

    message.file = printable(place.file->name);
    message.line = place.line;
    message.column = place.column;
    for (const SourceFile* file = place.file; file->included_at.file; file = file->included_at.file)
        message.included_from.push_back(place_text(file->included_at));
    if (place.line && place.column) {
        Excerpt excerpt = excerpt_of(line_of(place.file->text, place.line), place.column - 1);
        message.excerpt = std::move(excerpt.text);
        message.caret = excerpt.caret;
    }
    return message;
}

std::string count_of(std::size_t n, std::string_view what) { return fmt::format("{} {}{}", n, what, n == 1 ? "" : "s"); }

}  // namespace

std::string Message::headline() const {
    std::string result = file;
    if (!file.empty() && line) result += fmt::format(":{}:{}", line, column);
    if (!file.empty()) result += ": ";
    return result + fmt::format("{}: {}", word_for(severity), text);
}

std::string Message::format() const {
    std::string result = headline() + "\n";
    if (!excerpt.empty()) result += fmt::format("    {}\n    {:>{}}\n", excerpt, "^", caret + 1);
    for (const std::string& place : included_from) result += fmt::format("  included from {}\n", place);
    return result;
}

void Messages::error(const Place& place, std::string text) { add_at(Severity::error, place, std::move(text)); }
void Messages::warning(const Place& place, std::string text) { add_at(Severity::warning, place, std::move(text)); }

// Beyond the limit no excerpt is made: a million errors cost no more than counting them.
void Messages::add_at(Severity severity, const Place& place, std::string text) {
    {
        const std::scoped_lock lock(mutex_);
        if (is_kept(severity, place, text)) return;
        if (count(severity) >= limit_) {
            ++count(severity);
            return;
        }
    }
    add(located(severity, place, std::move(text)));
}

void Messages::add(Message message) {
    message.text = printable(message.text, sentence_bytes);
    Listener listener;
    {
        const std::scoped_lock lock(mutex_);
        if (++count(message.severity) > limit_) return;
        messages_.push_back(message);
        listener = listener_;
    }
    if (listener) listener(message);
}

void Messages::listen(Listener listener) {
    const std::scoped_lock lock(mutex_);
    listener_ = std::move(listener);
}

void Messages::finish() {
    Listener listener;
    Message last;
    {
        const std::scoped_lock lock(mutex_);
        listener = listener_;
        last = remainder();
    }
    if (listener && !last.text.empty()) listener(last);
}

std::size_t Messages::errors() const {
    const std::scoped_lock lock(mutex_);
    return errors_;
}

std::size_t Messages::warnings() const {
    const std::scoped_lock lock(mutex_);
    return warnings_;
}

std::vector<Message> Messages::all() const {
    const std::scoped_lock lock(mutex_);
    std::vector<Message> result = messages_;
    if (Message last = remainder(); !last.text.empty()) result.push_back(std::move(last));
    return result;
}

bool Messages::is_kept(Severity severity, const Place& place, const std::string& text) const {
    if (!place.line) return false;
    return std::ranges::any_of(messages_, [&](const Message& m) {
        return m.line == place.line && m.column == place.column && m.severity == severity && m.text == text &&
               m.file == printable(place.file->name);
    });
}

Message Messages::remainder() const {
    const std::size_t more_errors = errors_ - std::min(errors_, limit_);
    const std::size_t more_warnings = warnings_ - std::min(warnings_, limit_);
    Message last;
    last.severity = more_errors ? Severity::error : Severity::warning;
    if (more_errors && more_warnings)
        last.text = fmt::format("… and {} and {}", count_of(more_errors, "more error"), count_of(more_warnings, "more warning"));
    else if (more_errors || more_warnings)
        last.text = "… and " + (more_errors ? count_of(more_errors, "more error") : count_of(more_warnings, "more warning"));
    return last;
}

}  // namespace lapidary
