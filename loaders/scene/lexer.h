// SPDX-License-Identifier: MIT
//
// Text of the scene language as a stream of tokens, with one token of lookahead. White space and comments vanish here.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "kernel/report/messages.h"

namespace lapidary::scene_language {

struct Token {
    enum class Kind : std::uint8_t { word, number, string, symbol, end };
    Kind kind = Kind::end;
    std::uint32_t line = 1, column = 1, end_column = 1;
    std::string_view text;  // of the file; a string's without its quotes
    bool closed = true;     // of a string
    double number = 0;      // not a number where no double can hold what is written

    bool is(char symbol) const { return kind == Kind::symbol && text.front() == symbol; }
    bool is_word() const { return kind == Kind::word; }
    bool is_word(std::string_view word) const { return kind == Kind::word && text == word; }
};

// The token as a sentence names it: "'{'", "the number 12", "the end of the file".
std::string name_of(const Token& token);

// Never fails: what is no token is reported once and skipped.
class Lexer {
public:
    Lexer(const SourceFile& file, Messages& messages);

    const Token& current() const { return current_; }
    const Token& ahead();  // the one after the current one
    Token take();          // the current one; the next becomes current

    Place place_of(const Token& token) const { return {&file_, token.line, token.column}; }
    Place place() const { return place_of(current_); }
    // Right behind the token taken last, where something is missing.
    Place place_behind() const { return behind_; }

    // What would follow a string that is not closed was taken for a part of it, and is not worth a message.
    bool behind_unclosed_string() const { return behind_unclosed_string_; }

    // A token to return to, for text that is read several times.
    struct Mark {
        Token current;
        std::size_t position, line_start;
        std::uint32_t line;
    };
    Mark mark() const;
    void return_to(const Mark& mark);
    void skip_to_end();
    // How far the text was read, in bytes.
    std::size_t position() const { return position_; }

private:
    void skip_blanks();
    void skip_comment();
    Token scan();
    Token scan_word();
    Token scan_number();
    Token scan_string();
    void skip_unknown();
    Token token(Token::Kind kind, std::size_t begin, std::size_t end) const;
    Place place_at(std::size_t position) const;
    char at(std::size_t position) const { return position < text_.size() ? text_[position] : '\0'; }
    std::size_t letter_length(std::size_t position) const;

    const SourceFile& file_;
    Messages& messages_;
    std::string_view text_;
    std::size_t position_ = 0, line_start_ = 0;
    std::uint32_t line_ = 1;
    Token current_;
    std::optional<Token> ahead_;
    Place behind_;
    bool behind_unclosed_string_ = false;
};

}  // namespace lapidary::scene_language
