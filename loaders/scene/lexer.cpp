// SPDX-License-Identifier: MIT
#include "loaders/scene/lexer.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <limits>
#include <system_error>

#include "kernel/report/printable.h"

namespace lapidary::scene_language {

namespace {

enum class Class : std::uint8_t { other, blank, letter, digit, symbol, beyond_ascii };

constexpr std::array<Class, 256> make_classes() {
    std::array<Class, 256> classes{};
    const auto set = [&](std::string_view characters, Class c) {
        for (const char character : characters) classes[static_cast<unsigned char>(character)] = c;
    };
    set(" \t\r\n\f\v", Class::blank);
    set("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_", Class::letter);
    set("0123456789", Class::digit);
    set("{}(),;=+-*/", Class::symbol);
    for (std::size_t i = 0x80; i < 256; ++i) classes[i] = Class::beyond_ascii;
    return classes;
}

constexpr std::array<Class, 256> classes = make_classes();

Class class_of(char c) { return classes[static_cast<unsigned char>(c)]; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

// Names may be written in any script; punctuation and signs of Unicode are no letters.
bool is_letter(CodePoint c) {
    if (!c.valid || c.value < 0xAA || harmless(c) != c.value) return false;
    const bool latin_sign = c.value < 0xC0 && c.value != 0xAA && c.value != 0xB5 && c.value != 0xBA;
    const bool arithmetic = c.value == 0xD7 || c.value == 0xF7 || (c.value >= 0x2190 && c.value <= 0x2BFF);
    const bool punctuation = (c.value >= 0x2000 && c.value <= 0x206F) || (c.value >= 0x3000 && c.value <= 0x303F) ||
                             (c.value >= 0xFF01 && c.value <= 0xFF0F);
    return !latin_sign && !arithmetic && !punctuation;
}

// Whether a written number that no double can hold is too large, rather than too small: the decimal place of its
// first digit that is not zero decides.
bool is_too_large(std::string_view number) {
    const std::size_t e = std::min(number.find_first_of("eE"), number.size());
    const std::string_view mantissa = number.substr(0, e);
    const std::size_t first = mantissa.find_first_of("123456789");
    if (first == std::string_view::npos) return false;

    const std::size_t point = std::min(mantissa.find('.'), mantissa.size());
    const double place = static_cast<double>(point) - static_cast<double>(first);
    if (e == number.size()) return place > 0;
    const bool negative = number.substr(e + 1).starts_with('-');
    const std::string_view digits = number.substr(e + (is_digit(number[e + 1]) ? 1 : 2));
    double exponent = 0;
    for (const char digit : digits) exponent = std::min(1e18, 10 * exponent + (digit - '0'));
    return place + (negative ? -exponent : exponent) > 0;
}

}  // namespace

std::string name_of(const Token& token) {
    constexpr std::size_t most = 40;
    switch (token.kind) {
        case Token::Kind::number:
            return "the number " + printable(token.text, most);
        case Token::Kind::string:
            return "the string \"" + printable(token.text, most) + "\"";
        case Token::Kind::end:
            return "the end of the file";
        default:
            return "'" + printable(token.text, most) + "'";
    }
}

Lexer::Lexer(const SourceFile& file, Messages& messages)
    : file_(file), messages_(messages), text_(file.text), behind_{&file, 1, 1} {
    if (text_.starts_with("\xFF\xFE") || text_.starts_with("\xFE\xFF")) {
        messages_.error({&file_, 0, 0}, "the file is written in UTF-16; save it as UTF-8");
        position_ = text_.size();
    }
    current_ = scan();
}

const Token& Lexer::ahead() {
    if (!ahead_) ahead_ = scan();
    return *ahead_;
}

Token Lexer::take() {
    const Token taken = current_;
    behind_ = {&file_, taken.line, taken.end_column};
    behind_unclosed_string_ = !taken.closed;
    current_ = ahead_ ? *ahead_ : scan();
    ahead_.reset();
    return taken;
}

Lexer::Mark Lexer::mark() const { return {current_, position_, line_start_, line_}; }

void Lexer::return_to(const Mark& mark) {
    current_ = mark.current;
    position_ = mark.position;
    line_start_ = mark.line_start;
    line_ = mark.line;
    ahead_.reset();
}

void Lexer::skip_to_end() {
    position_ = text_.size();
    ahead_.reset();
    current_ = token(Token::Kind::end, position_, position_);
}

Token Lexer::scan() {
    for (;;) {
        skip_blanks();
        if (position_ == text_.size()) return token(Token::Kind::end, position_, position_);
        const char c = text_[position_];
        switch (class_of(c)) {
            case Class::letter:
                return scan_word();
            case Class::digit:
                return scan_number();
            case Class::symbol:
                return ++position_, token(Token::Kind::symbol, position_ - 1, position_);
            case Class::beyond_ascii:
                if (letter_length(position_)) return scan_word();
                break;
            default:
                if (c == '"') return scan_string();
                if (c == '.' && is_digit(at(position_ + 1))) return scan_number();
        }
        skip_unknown();
    }
}

void Lexer::skip_blanks() {
    for (; position_ < text_.size(); ++position_) {
        const char c = text_[position_];
        if (c == '\n') {
            ++line_;
            line_start_ = position_ + 1;
        } else if (c == '/' && at(position_ + 1) == '/') {
            position_ = std::min(text_.find('\n', position_), text_.size()) - 1;
        } else if (c == '/' && at(position_ + 1) == '*') {
            skip_comment();
        } else if (class_of(c) != Class::blank) {
            return;
        }
    }
}

// Leaves the position on the last character of the comment.
void Lexer::skip_comment() {
    const Place opened = place_at(position_);
    const std::size_t close = text_.find("*/", position_ + 2);
    if (close == std::string_view::npos)
        messages_.error(opened, "the comment that is opened here is not closed: '*/' is missing before the end of the file");

    const std::size_t end = close == std::string_view::npos ? text_.size() : close + 2;
    const std::string_view comment = text_.substr(position_, end - position_);
    line_ += static_cast<std::uint32_t>(std::count(comment.begin(), comment.end(), '\n'));
    if (const std::size_t last = comment.rfind('\n'); last != std::string_view::npos) line_start_ = position_ + last + 1;
    position_ = end - 1;
}

// The bytes of a letter or digit of a word, 0 where there is none.
std::size_t Lexer::letter_length(std::size_t position) const {
    if (position >= text_.size()) return 0;
    const Class c = class_of(text_[position]);
    if (c != Class::beyond_ascii) return c == Class::letter || c == Class::digit;
    const CodePoint code_point = decode_utf8(text_.substr(position, 4));
    return is_letter(code_point) ? code_point.length : 0;
}

Token Lexer::scan_word() {
    const std::size_t begin = position_;
    while (const std::size_t length = letter_length(position_)) position_ += length;
    return token(Token::Kind::word, begin, position_);
}

Token Lexer::scan_number() {
    const std::size_t begin = position_;
    const char* first = text_.data() + begin;
    double number = 0;
    const auto [end, error] = std::from_chars(first, text_.data() + text_.size(), number);
    position_ += static_cast<std::size_t>(end - first);

    Token result = token(Token::Kind::number, begin, position_);
    result.number = error == std::errc() ? number : 0;
    if (error == std::errc::result_out_of_range && is_too_large(result.text)) {
        result.number = std::numeric_limits<double>::quiet_NaN();
        messages_.error(place_of(result),
                        fmt::format("{} is too large: numbers reach up to 1.79e308", printable(result.text, 40)));
    }
    return result;
}

// A string ends where its line ends, so that a forgotten quote spoils no more than its line.
Token Lexer::scan_string() {
    const std::size_t begin = position_ + 1;
    const std::size_t end = std::min(text_.find_first_of("\"\n", begin), text_.size());
    const bool closed = at(end) == '"';
    if (!closed)
        messages_.error(place_at(position_),
                        "the string that is opened here is not closed: '\"' is missing before the end of the line");

    Token result = token(Token::Kind::string, begin, end);
    result.column -= 1;
    result.end_column += closed;
    result.closed = closed;
    position_ = end + closed;
    return result;
}

// One message for a run of them: a binary file is not worth a message a byte.
void Lexer::skip_unknown() {
    const std::size_t begin = position_;
    const CodePoint first = decode_utf8(text_.substr(begin, 4));
    const auto is_unknown = [&](std::size_t position) {
        const char c = at(position);
        return (class_of(c) == Class::other && c != '"' && !(c == '.' && is_digit(at(position + 1)))) ||
               (class_of(c) == Class::beyond_ascii && !letter_length(position));
    };
    for (position_ += first.length; position_ < text_.size() && is_unknown(position_);)
        position_ += decode_utf8(text_.substr(position_, 4)).length;

    const Place place = place_at(begin);
    const std::string shown = printable(text_.substr(begin, first.length));
    if (!first.valid)
        messages_.error(place, fmt::format("the byte 0x{:02x} is no UTF-8; save the file as UTF-8",
                                           static_cast<unsigned char>(text_[begin])));
    else if (first.value == 0x201C || first.value == 0x201D || first.value == 0x201E)
        messages_.error(
            place, fmt::format("the quotation mark '{}' means nothing here; strings stand between straight ones: \"…\"", shown));
    else if (first.value == '#')
        messages_.error(place, "'#' means nothing here; a comment begins with '//', and a colour is written hex(\"#ff8800\")");
    else if (harmless(first) != first.value)
        messages_.error(place,
                        fmt::format("the character U+{:04X} means nothing here; remove it", static_cast<unsigned>(first.value)));
    else
        messages_.error(place, fmt::format("the character '{}' means nothing here; remove it", shown));
}

Token Lexer::token(Token::Kind kind, std::size_t begin, std::size_t end) const {
    const auto column = [&](std::size_t position) { return static_cast<std::uint32_t>(position - line_start_ + 1); };
    return {kind, line_, column(begin), column(end), text_.substr(begin, end - begin), true, 0};
}

Place Lexer::place_at(std::size_t position) const {
    return {&file_, line_, static_cast<std::uint32_t>(position - line_start_ + 1)};
}

}  // namespace lapidary::scene_language
