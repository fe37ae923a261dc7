// SPDX-License-Identifier: MIT
//
// Text from files, made fit for a terminal: no control characters, no invalid UTF-8, nothing that turns the writing
// direction round, and a known width.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "kernel/export.h"

namespace lapidary {

// What stands in for everything that must not reach a terminal.
inline constexpr char32_t replacement_character = 0xFFFD;

struct CodePoint {
    char32_t value = replacement_character;
    std::size_t length = 1;  // bytes
    bool valid = false;
};

// The first code point of a text that is not empty; an invalid byte counts as one of length 1.
LAPIDARY_API CodePoint decode_utf8(std::string_view text);
LAPIDARY_API void append_utf8(std::string& text, char32_t code_point);

// Terminal columns that a printable code point takes: 0 for combining marks, 2 for East Asian wide ones, else 1.
LAPIDARY_API int display_width(char32_t code_point);

// The code point itself, a space for white space of any kind, else the replacement character.
LAPIDARY_API char32_t harmless(CodePoint code_point);

// The whole text made harmless; what is longer than `most` bytes is cut and ends in an ellipsis.
LAPIDARY_API std::string printable(std::string_view text, std::size_t most = std::string::npos);

}  // namespace lapidary
