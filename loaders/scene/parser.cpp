// SPDX-License-Identifier: MIT
//
// Items, blocks and properties; values stand in values.cpp, what makes items of other text in multipliers.cpp.
#include "loaders/scene/parser.h"

#include <fmt/format.h>

#include <utility>

#include "kernel/report/printable.h"
#include "loaders/scene/nesting.h"

namespace lapidary::scene_language {

namespace {

// Words that begin a statement of their own and therefore cannot name a block.
bool begins_statement(const Token& token) {
    return token.is_word("with") || token.is_word("let") || token.is_word("repeat") || token.is_word("include");
}

std::string quoted(std::string_view text) { return "'" + printable(text, 40) + "'"; }

}  // namespace

Parser::Parser(const SourceFile& file, Loading& loading)
    : loading_(loading), file_(file), lexer_(file, loading.messages), expressions_(lexer_, loading) {}

void Parser::parse(Items& items) { parse_items(items, false); }

void Parser::parse_items(Items& items, bool in_block) {
    while (lexer_.current().kind != Token::Kind::end) {
        if (loading_.stopped) return lexer_.skip_to_end();
        if (!lexer_.current().is('}')) {
            parse_item(items);
        } else if (in_block) {
            return;
        } else {
            loading_.error(lexer_.place(), "'}' closes no block; remove it, or look for a '{' that is missing above");
            lexer_.take();
        }
    }
}

void Parser::parse_item(Items& items) {
    const Token& token = lexer_.current();
    if (token.is_word()) return parse_statement(items);
    if (token.is(';')) {
        loading_.warning(lexer_.place(), "this ';' ends nothing: ignored");
        lexer_.take();
    } else if (token.is('{')) {
        loading_.error(lexer_.place(), "a block needs a keyword before its '{'");
        skip_block();
    } else {
        loading_.error(lexer_.place(), fmt::format("expected a keyword or a name, not {}", name_of(token)));
        skip_to_item();
    }
}

void Parser::parse_statement(Items& items) {
    if (lexer_.current().is_word("let")) return parse_let();
    if (lexer_.current().is_word("repeat")) return parse_repeat(items);
    if (lexer_.current().is_word("include")) return parse_include(items);

    const Token keyword = lexer_.take();
    const Token next = lexer_.current();
    const Place place = lexer_.place_of(keyword);
    if (keyword.is_word("with")) {
        loading_.error(place, "'with' follows the '}' of a block: keyword { … } with { … }");
        if (next.is('{')) skip_block();
    } else if (next.is('(')) {
        parse_property(items, keyword);
    } else if (next.is('{')) {
        parse_block(items, keyword, nullptr);
    } else if (next.is_word() && !begins_statement(next) && lexer_.ahead().is('{') &&
               !(next.line > keyword.line && loading_.block_names.contains(keyword.text))) {
        lexer_.take();
        parse_block(items, keyword, &next);
    } else if (keyword.is_word("plugins") && next.kind == Token::Kind::string) {
        parse_plugins(items, keyword);
    } else if (next.is('=')) {
        loading_.error(place, fmt::format("a property is written '{0}(…);', and a constant is defined with 'let {0} = …;'",
                                          printable(keyword.text, 40)));
        skip_statement();
    } else if (next.kind == Token::Kind::number || next.kind == Token::Kind::string || next.is('-')) {
        loading_.error(lexer_.place(), fmt::format("values stand in parentheses: {}(…);", printable(keyword.text, 40)));
        skip_statement();
    } else if (next.is(';') || next.is_word() || next.is('}') || next.kind == Token::Kind::end) {
        add_reference(items, keyword);
    } else {
        loading_.error(lexer_.place(),
                       fmt::format("expected '(', '{{' or ';' after {}, not {}", name_of(keyword), name_of(next)));
        skip_statement();
    }
}

void Parser::add_reference(Items& items, const Token& name) {
    expect_semicolon(quoted(name.text));
    add(items, Reference{std::string(name.text), lexer_.place_of(name)}, 0);
}

// A property with a wrong value is left out: what would be made of it would only cause further messages.
void Parser::parse_property(Items& items, const Token& keyword) {
    Property property{std::string(keyword.text), {}, lexer_.place_of(keyword)};
    if (parse_values(property)) {
        expect_semicolon(fmt::format("'{}(…)'", printable(keyword.text, 40)));
        const std::size_t values = property.values.size();
        add(items, std::move(property), values);
    } else if (lexer_.current().is(';')) {
        lexer_.take();
    }
}

void Parser::parse_plugins(Items& items, const Token& keyword) {
    const Place place = lexer_.place();
    Value folder{Value::Kind::text, 0, false, std::string(lexer_.take().text), place};
    expect_semicolon(fmt::format("\"{}\"", printable(folder.text, 40)));
    Property property{std::string(keyword.text), {}, lexer_.place_of(keyword)};
    property.values.push_back(std::move(folder));
    add(items, std::move(property), 1);
}

void Parser::parse_block(Items& items, const Token& keyword, const Token* name) {
    auto block = std::make_unique<Block>();
    block->keyword = keyword.text;
    block->place = lexer_.place_of(keyword);
    if (name) {
        block->name_place = lexer_.place_of(*name);
        const bool is_new = loading_.block_names.insert(name->text).second;
        if (is_new || loading_.later_rounds == 0)
            block->name = name->text;
        else
            loading_.error(
                block->name_place,
                fmt::format("{} is defined again in every round of the loop; define it above the loop", name_of(*name)));
    }
    if (too_deep(block->place)) return skip_block();

    const Nesting nesting(loading_.depth);
    parse_branch(*block, keyword.text);
    while (lexer_.current().is_word("with") && lexer_.ahead().is('{')) {
        lexer_.take();
        parse_branch(*block, "with");
    }
    if (lexer_.current().is_word("with")) {
        lexer_.take();
        loading_.error(lexer_.place(), fmt::format("expected '{{' after 'with', not {}", name_of(lexer_.current())));
    }
    add(items, std::move(block), 0);
}

void Parser::parse_branch(Block& block, std::string_view what) {
    const Place opened = lexer_.place();
    lexer_.take();
    parse_items(block.branches.emplace_back(Branch{opened, {}}).items, true);
    close_block(what, opened);
}

// Values beyond a handful count, too, so that a loop over a long list stays within its bound.
void Parser::add(Items& items, Item item, std::size_t values) {
    loading_.charge(1 + values / 4);
    items.push_back(std::move(item));
}

void Parser::expect_semicolon(std::string_view after) {
    if (lexer_.current().is(';'))
        lexer_.take();
    else if (!loading_.stopped && !lexer_.behind_unclosed_string())
        loading_.warning(lexer_.place_behind(), fmt::format("missing ';' after {}: assumed", after));
}

bool Parser::expect(char symbol, std::string_view behind) {
    if (lexer_.current().is(symbol)) {
        lexer_.take();
        return true;
    }
    loading_.error(lexer_.place(), fmt::format("expected '{}' after {}, not {}", symbol, behind, name_of(lexer_.current())));
    return false;
}

// At the end of the file the innermost open block speaks for those around it.
void Parser::close_block(std::string_view what, const Place& opened) {
    if (lexer_.current().is('}')) {
        lexer_.take();
    } else if (!unclosed_reported_ && !loading_.stopped) {
        unclosed_reported_ = true;
        loading_.error(
            opened, fmt::format("the block of {} that is opened here is not closed: '}}' is missing before the end of the file",
                                quoted(what)));
    }
}

bool Parser::too_deep(const Place& place) {
    if (loading_.depth < deepest_nesting) return false;
    loading_.error(place,
                   fmt::format("blocks are nested more than {} deep; name the inner ones and refer to them", deepest_nesting));
    return true;
}

// From a '{' past its '}'.
void Parser::skip_block() {
    const Place opened = lexer_.place();
    std::size_t open = 0;
    while (lexer_.current().kind != Token::Kind::end) {
        const Token token = lexer_.take();
        if (token.is('{')) ++open;
        if (token.is('}') && --open == 0) return;
    }
    unclosed_reported_ = true;
    loading_.error(opened, "the block that is opened here is not closed: '}' is missing before the end of the file");
}

// Past everything that cannot begin an item.
void Parser::skip_to_item() {
    for (;;) {
        const Token& token = lexer_.current();
        if (token.is_word() || token.is('{') || token.is('}') || token.kind == Token::Kind::end) return;
        if (lexer_.take().is(';')) return;
    }
}

// Past the next ';', or past a block, or up to the '}' around.
void Parser::skip_statement() {
    for (;;) {
        const Token& token = lexer_.current();
        if (token.is('{')) return skip_block();
        if (token.is('}') || token.kind == Token::Kind::end) return;
        if (lexer_.take().is(';')) return;
    }
}

}  // namespace lapidary::scene_language
