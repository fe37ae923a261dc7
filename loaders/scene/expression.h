// SPDX-License-Identifier: MIT
//
// Numbers as the scene language writes them, computed as they are read:
//
//     sum     = product { ("+" | "-") product }
//     product = factor { ("*" | "/") factor }
//     factor  = { "-" | "+" } primary [ "deg" | "rad" ]
//     primary = number | constant | function "(" sum { "," sum } ")" | "(" sum ")"
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "loaders/scene/constants.h"
#include "loaders/scene/lexer.h"
#include "loaders/scene/loading.h"

namespace lapidary::scene_language {

bool is_function(std::string_view word);
bool is_unit(std::string_view word);

class ExpressionParser {
public:
    ExpressionParser(Lexer& lexer, Loading& loading) : lexer_(lexer), loading_(loading) {}

    // Nothing where the text is no expression: that is reported, and the rest of it still to be skipped.
    std::optional<Number> parse();
    // The same for a list of them in parentheses, the first of which is the current token.
    std::optional<std::vector<Number>> parse_arguments();
    // Parentheses that were open where the last of these gave up.
    int open_parentheses() const { return open_; }

private:
    std::optional<Number> sum();
    std::optional<Number> product();
    std::optional<Number> factor();
    std::optional<Number> primary();
    Number literal();
    std::optional<Number> constant();
    std::optional<Number> parenthesised();
    std::optional<Number> function_call();
    std::optional<std::vector<Number>> argument_list();
    bool unit_follows() const;
    void apply_unit(Number& number);
    Number quotient(const Number& a, const Number& b, const Place& place);
    Number finite(Number number, const Place& place);
    bool open();
    bool close(std::string_view expected);

    Lexer& lexer_;
    Loading& loading_;
    int open_ = 0;
};

}  // namespace lapidary::scene_language
