// SPDX-License-Identifier: MIT
//
// One file of the scene language, by recursive descent:
//
//     items     = { item }
//     item      = property | reference | block | let | repeat | include | plugins
//     property  = keyword "(" [ value { "," value } ] ")" ";"
//     reference = name ";"
//     block     = keyword [ name ] "{" items "}" { "with" "{" items "}" }
//     let       = "let" name "=" sum ";"
//     repeat    = "repeat" name "(" sum "," sum ")" "{" items "}"
//     include   = "include" string [ ";" ]
//     plugins   = "plugins" string ";"
//     value     = sum | string | word | "srgb" "(" sum "," sum "," sum ")" | "hex" "(" string ")"
//
// `let`, `repeat` and `include` are carried out as they are read; a loop reads its text once a round. After an error
// the parser goes on at the next place that makes sense.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string_view>
#include <vector>

#include "kernel/scene/document.h"
#include "loaders/scene/expression.h"
#include "loaders/scene/lexer.h"
#include "loaders/scene/loading.h"

namespace lapidary::scene_language {

class Parser {
public:
    Parser(const SourceFile& file, Loading& loading);

    // Everything to the end of the file.
    void parse(Items& items);

private:
    // Items up to the closing brace, which stays, or to the end of the file.
    void parse_items(Items& items, bool in_block);
    void parse_item(Items& items);
    void parse_statement(Items& items);
    void parse_property(Items& items, const Token& keyword);
    void parse_plugins(Items& items, const Token& keyword);
    void parse_block(Items& items, const Token& keyword, const Token* name);
    void parse_branch(Block& block, std::string_view what);
    void add_reference(Items& items, const Token& name);

    // What became of a value: wrong ones are reported and read to their end, after others the parser is lost.
    enum class Outcome { good, wrong, lost };
    bool parse_values(Property& property);
    bool parse_value_list(std::string_view keyword);
    Outcome parse_value();
    Outcome parse_number();
    Outcome parse_srgb();
    Outcome parse_hex();
    bool stands_alone();
    void skip_values(int open_parentheses);

    void parse_let();
    bool may_define(const Token& name);
    struct Loop {
        Token name;
        Place place;
        double first = 0;
        std::uint64_t rounds = 0;
    };
    void parse_repeat(Items& items);
    std::optional<Loop> parse_loop_head();
    std::optional<double> parse_loop_bound();
    void parse_rounds(Items& items, const Loop& loop);

    void parse_include(Items& items);
    const SourceFile* open_include(std::string_view name, const Place& place);
    bool is_circular(const std::filesystem::path& identity, const Place& place);

    void add(Items& items, Item item, std::size_t values);
    void expect_semicolon(std::string_view after);
    bool expect(char symbol, std::string_view behind);
    void close_block(std::string_view what, const Place& opened);
    bool too_deep(const Place& place);
    void skip_block();
    void skip_statement();
    void skip_to_item();

    Loading& loading_;
    const SourceFile& file_;
    Lexer lexer_;
    ExpressionParser expressions_;
    std::vector<Value> values_;  // of the property that is being read
    bool unclosed_reported_ = false;
};

}  // namespace lapidary::scene_language
