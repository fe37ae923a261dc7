// SPDX-License-Identifier: MIT
#include "kernel/report/printable.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <iterator>

namespace lapidary {

namespace {

struct Range {
    char32_t first, last;
};

template <std::size_t n>
bool contains(const std::array<Range, n>& sorted, char32_t c) {
    const auto after = std::upper_bound(sorted.begin(), sorted.end(), c, [](char32_t v, const Range& r) { return v < r.first; });
    return after != sorted.begin() && c <= std::prev(after)->last;
}

// The blocks of Unicode's East Asian Width "wide" and of its nonspacing marks that scenes are likely to hold.
constexpr std::array<Range, 13> wide{{{0x1100, 0x115F},
                                      {0x2E80, 0x303E},
                                      {0x3041, 0xA4CF},
                                      {0xA960, 0xA97C},
                                      {0xAC00, 0xD7A3},
                                      {0xF900, 0xFAFF},
                                      {0xFE30, 0xFE6F},
                                      {0xFF00, 0xFF60},
                                      {0xFFE0, 0xFFE6},
                                      {0x1F300, 0x1F64F},
                                      {0x1F680, 0x1F6FF},
                                      {0x1F900, 0x1F9FF},
                                      {0x20000, 0x3FFFD}}};
constexpr std::array<Range, 8> combining{{{0x0300, 0x036F},
                                          {0x0483, 0x0489},
                                          {0x0591, 0x05BD},
                                          {0x064B, 0x065F},
                                          {0x1AB0, 0x1AFF},
                                          {0x1DC0, 0x1DFF},
                                          {0x20D0, 0x20FF},
                                          {0xFE00, 0xFE0F}}};

// Marks, overrides and isolates of writing direction, zero-width characters, and line separators.
bool is_disruptive(char32_t c) {
    return (c >= 0x200B && c <= 0x200F) || (c >= 0x2028 && c <= 0x202E) || (c >= 0x2060 && c <= 0x206F) || c == 0xFEFF ||
           (c >= 0xFFF0 && c <= 0xFFFB) || (c >= 0xE0000 && c <= 0xE0FFF);
}

bool is_control(char32_t c) { return c < 0x20 || (c >= 0x7F && c < 0xA0); }

}  // namespace

CodePoint decode_utf8(std::string_view text) {
    const auto byte = [&](std::size_t i) { return static_cast<std::uint8_t>(text[i]); };
    const std::uint8_t lead = byte(0);
    if (lead < 0x80) return {lead, 1, true};

    const std::size_t length = lead >= 0xF0 ? 4 : lead >= 0xE0 ? 3 : 2;
    if (lead < 0xC2 || lead > 0xF4 || text.size() < length) return {};
    char32_t value = lead & (0x7Fu >> length);
    for (std::size_t i = 1; i < length; ++i) {
        if ((byte(i) & 0xC0) != 0x80) return {};
        value = value << 6 | (byte(i) & 0x3Fu);
    }

    // Overlong forms, surrogates, and what lies beyond Unicode.
    const char32_t least = length == 4 ? 0x10000 : length == 3 ? 0x800 : 0x80;
    if (value < least || (value >= 0xD800 && value <= 0xDFFF) || value > 0x10FFFF) return {};
    return {value, length, true};
}

void append_utf8(std::string& text, char32_t c) {
    const auto put = [&](char32_t bits) { text += static_cast<char>(bits); };
    const auto put_tail = [&](int shift) { put(0x80 | ((c >> shift) & 0x3F)); };
    if (c < 0x80) {
        put(c);
    } else if (c < 0x800) {
        put(0xC0 | c >> 6), put_tail(0);
    } else if (c < 0x10000) {
        put(0xE0 | c >> 12), put_tail(6), put_tail(0);
    } else {
        put(0xF0 | c >> 18), put_tail(12), put_tail(6), put_tail(0);
    }
}

int display_width(char32_t c) {
    if (c < 0x300) return 1;
    return contains(combining, c) ? 0 : contains(wide, c) ? 2 : 1;
}

char32_t harmless(CodePoint c) {
    if (c.valid && (c.value == '\t' || c.value == '\n' || c.value == '\r' || c.value == 0xA0)) return ' ';
    if (!c.valid || is_control(c.value) || is_disruptive(c.value)) return replacement_character;
    return c.value;
}

std::string printable(std::string_view text, std::size_t most) {
    std::string result;
    for (std::size_t at = 0; at < text.size();) {
        const CodePoint c = decode_utf8(text.substr(at));
        if (at + c.length > most) return result + "…";
        append_utf8(result, harmless(c));
        at += c.length;
    }
    return result;
}

}  // namespace lapidary
