// SPDX-License-Identifier: MIT
//
// What stands between the parentheses of a property.
#include <fmt/format.h>

#include <charconv>
#include <iterator>
#include <optional>

#include "kernel/math/colour.h"
#include "kernel/report/printable.h"
#include "loaders/scene/parser.h"

namespace lapidary::scene_language {

namespace {

bool is_operator(const Token& token) { return token.is('+') || token.is('-') || token.is('*') || token.is('/') || token.is('('); }

bool begins_value(const Token& token) {
    return token.is_word() || token.kind == Token::Kind::number || token.kind == Token::Kind::string || token.is('(');
}

void append_colour(std::vector<Value>& values, double r, double g, double b, const Place& place) {
    for (const double part : {r, g, b}) values.push_back({Value::Kind::number, srgb_decode(part), false, {}, place});
}

// "#f80", "#ff8800", or the same without '#', as parts from 0 to 1.
std::optional<Colour> colour_of(std::string_view digits) {
    if (digits.starts_with('#')) digits.remove_prefix(1);
    if (digits.size() != 3 && digits.size() != 6) return {};
    const std::size_t width = digits.size() / 3;
    double parts[3];
    for (std::size_t i = 0; i < 3; ++i) {
        const std::string_view part = digits.substr(i * width, width);
        unsigned value = 0;
        const auto [end, error] = std::from_chars(part.data(), part.data() + width, value, 16);
        if (error != std::errc() || end != part.data() + width) return {};
        parts[i] = value / (width == 1 ? 15.0 : 255.0);
    }
    return Colour{parts[0], parts[1], parts[2]};
}

}  // namespace

// True where all values are good.
bool Parser::parse_values(Property& property) {
    lexer_.take();
    if (lexer_.current().is(')')) return lexer_.take(), true;
    values_.clear();
    const bool good = parse_value_list(property.keyword);
    property.values.assign(std::make_move_iterator(values_.begin()), std::make_move_iterator(values_.end()));
    return good;
}

bool Parser::parse_value_list(std::string_view keyword) {
    for (bool good = true;;) {
        const Token next = lexer_.current();
        Outcome outcome = Outcome::wrong;
        if (next.is(',') || next.is(')'))
            loading_.error(lexer_.place(), fmt::format("a value is missing before {}", name_of(next)));
        else
            outcome = parse_value();
        if (outcome == Outcome::lost) return skip_values(expressions_.open_parentheses() + 1), false;
        good &= outcome == Outcome::good;

        const Token& behind = lexer_.current();
        if (behind.is(',')) {
            lexer_.take();
        } else if (behind.is(')')) {
            return lexer_.take(), good;
        } else if (begins_value(behind) && behind.line == lexer_.place_behind().line) {
            loading_.error(lexer_.place(), fmt::format("expected ',' or ')' before {}", name_of(behind)));
            good = false;
        } else if (lexer_.behind_unclosed_string()) {
            return false;
        } else {
            loading_.error(lexer_.place_behind(), fmt::format("missing ')' after the values of '{}'", printable(keyword, 40)));
            if (!behind.is_word()) skip_values(1);
            return false;
        }
    }
}

Parser::Outcome Parser::parse_value() {
    const Token& token = lexer_.current();
    const Place place = lexer_.place();
    if (token.kind == Token::Kind::string) {
        values_.push_back({Value::Kind::text, 0, false, std::string(lexer_.take().text), place});
        return Outcome::good;
    }
    if (token.is_word("srgb") && lexer_.ahead().is('(')) return parse_srgb();
    if (token.is_word("hex") && lexer_.ahead().is('(')) return parse_hex();
    if (token.is_word() && !loading_.constants.find(token.text) && stands_alone()) {
        values_.push_back({Value::Kind::word, 0, false, std::string(lexer_.take().text), place});
        return Outcome::good;
    }
    return parse_number();
}

bool Parser::stands_alone() {
    return !is_operator(lexer_.ahead()) && !(lexer_.ahead().is_word() && is_unit(lexer_.ahead().text));
}

// A constant that stands alone keeps its name, for a property that takes a word.
Parser::Outcome Parser::parse_number() {
    const Token token = lexer_.current();
    const std::string_view name = token.is_word() && stands_alone() ? token.text : std::string_view();
    const std::optional<Number> number = expressions_.parse();
    if (!number) return Outcome::lost;
    values_.push_back({Value::Kind::number, number->value, number->angle, std::string(name), lexer_.place_of(token)});
    return number->valid ? Outcome::good : Outcome::wrong;
}

Parser::Outcome Parser::parse_srgb() {
    const Place place = lexer_.place();
    lexer_.take();
    const std::optional<std::vector<Number>> parts = expressions_.parse_arguments();
    if (!parts) return Outcome::lost;
    if (parts->size() != 3) {
        loading_.error(place, fmt::format("'srgb' takes 3 numbers, not {}", parts->size()));
        return Outcome::wrong;
    }
    bool valid = true, bytes = false;
    for (const Number& part : *parts) valid &= part.valid, bytes |= part.value > 16;
    if (bytes) loading_.warning(place, "the numbers of 'srgb' run from 0 to 1; parts from 0 to 255 are written hex(\"#rrggbb\")");
    append_colour(values_, (*parts)[0].value, (*parts)[1].value, (*parts)[2].value, place);
    return valid ? Outcome::good : Outcome::wrong;
}

Parser::Outcome Parser::parse_hex() {
    const Place place = lexer_.place();
    lexer_.take();
    lexer_.take();
    if (lexer_.current().kind != Token::Kind::string) {
        loading_.error(lexer_.place(), fmt::format("'hex' takes a string: hex(\"#ff8800\"), not {}", name_of(lexer_.current())));
        skip_values(1);
        return Outcome::wrong;
    }
    const Place text_place = lexer_.place();
    const std::optional<Colour> colour = colour_of(lexer_.take().text);
    if (!colour)
        loading_.error(text_place, "a colour is written with three or six hexadecimal digits: hex(\"#f80\") or hex(\"#ff8800\")");
    else
        append_colour(values_, colour->r, colour->g, colour->b, place);
    if (!expect(')', "the colour")) return Outcome::lost;
    return colour ? Outcome::good : Outcome::wrong;
}

// Past the parenthesis that closes the outermost of those that are open, or up to where the statement must end.
void Parser::skip_values(int open_parentheses) {
    for (;;) {
        const Token& token = lexer_.current();
        if (token.is(';') || token.is('}') || token.kind == Token::Kind::end) return;
        if (token.is('{')) {
            skip_block();
            continue;
        }
        if (token.is('(')) ++open_parentheses;
        const bool closes = token.is(')') && --open_parentheses == 0;
        lexer_.take();
        if (closes) return;
    }
}

}  // namespace lapidary::scene_language
