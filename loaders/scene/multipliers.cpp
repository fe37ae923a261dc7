// SPDX-License-Identifier: MIT
//
// `let`, `repeat` and `include`: carried out as they are read.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "kernel/report/printable.h"
#include "loaders/scene/files.h"
#include "loaders/scene/nesting.h"
#include "loaders/scene/parser.h"

namespace lapidary::scene_language {

namespace {

constexpr std::size_t bytes_per_item = 256;           // text that is read again counts as an item, too, so that time is bounded
constexpr double largest_counter = 9007199254740992;  // 2^53: beyond it counting by one stands still

std::string text_of(const Place& place) { return fmt::format("{}:{}:{}", place.file->name, place.line, place.column); }

// Something that is left when the scope is.
template <typename Leave>
struct Scope {
    Leave leave;
    ~Scope() { leave(); }
};
template <typename Leave>
Scope(Leave) -> Scope<Leave>;

}  // namespace

// let name = expression;
void Parser::parse_let() {
    lexer_.take();
    const Token name = lexer_.current();
    if (!name.is_word()) {
        loading_.error(lexer_.place(), fmt::format("expected a name after 'let', not {}", name_of(name)));
        return skip_statement();
    }
    lexer_.take();
    if (!expect('=', fmt::format("'let {}'", printable(name.text, 40)))) return skip_statement();
    if (lexer_.current().kind == Token::Kind::string) {
        loading_.error(lexer_.place(), "'let' names a number, not a string");
        return skip_statement();
    }

    const std::optional<Number> number = expressions_.parse();
    if (!number) skip_values(expressions_.open_parentheses());
    expect_semicolon(fmt::format("'let {} = …'", printable(name.text, 40)));
    if (!may_define(name)) return;
    const bool valid = number && number->valid;  // a wrong one is not worth the warning that it is not used
    loading_.constants.define(name.text, {number.value_or(Number{0, false, false}), lexer_.place_of(name), false, !valid});
}

bool Parser::may_define(const Token& name) {
    const Place place = lexer_.place_of(name);
    const std::string shown = name_of(name);
    if (name.text == "pi")
        loading_.error(place, "'pi' is defined already; choose another name");
    else if (is_function(name.text) || name.text == "srgb" || name.text == "hex")
        loading_.error(place, fmt::format("{} is a function of the language; choose another name", shown));
    else if (is_unit(name.text))
        loading_.error(place, fmt::format("{} is a unit of the language; choose another name", shown));
    else if (const Constant* first = loading_.constants.find(name.text))
        loading_.error(place, fmt::format("{} is defined twice, first at {}; choose another name", shown, text_of(first->place)));
    else
        return true;
    return false;
}

// repeat name (first, last) { … }
void Parser::parse_repeat(Items& items) {
    const Place place = lexer_.place();
    lexer_.take();
    std::optional<Loop> loop = parse_loop_head();
    if (!loop) return skip_statement();
    loop->place = place;
    if (!may_define(loop->name)) loop->rounds = 0;
    if (too_deep(place)) return skip_block();
    parse_rounds(items, *loop);
}

std::optional<Parser::Loop> Parser::parse_loop_head() {
    constexpr std::string_view form = "repeat i (first, last) { … }";
    Loop loop;
    loop.name = lexer_.current();
    if (!loop.name.is_word()) {
        loading_.error(lexer_.place(), fmt::format("expected the name of a counter, not {}: {}", name_of(loop.name), form));
        return {};
    }
    lexer_.take();

    if (!expect('(', "the name of the counter")) return {};
    const std::optional<double> first = parse_loop_bound();
    if (!first || !expect(',', "the first value of the counter")) return {};
    const std::optional<double> last = parse_loop_bound();
    if (!last || !expect(')', "the last value of the counter")) return {};
    if (!lexer_.current().is('{')) {
        loading_.error(lexer_.place(),
                       fmt::format("expected '{{' after the bounds of the loop, not {}", name_of(lexer_.current())));
        return {};
    }
    const bool valid = !std::isnan(*first) && !std::isnan(*last);
    loop.first = *first;
    loop.rounds = valid && *last >= *first ? static_cast<std::uint64_t>(*last - *first) + 1 : 0;
    if (valid && loop.rounds == 0)
        loading_.warning(lexer_.place(),
                         fmt::format("the loop from {} to {} has no round: what it holds is left out", *first, *last));
    return loop;
}

// Not a number where the bound is an expression, but a wrong one.
std::optional<double> Parser::parse_loop_bound() {
    const Place place = lexer_.place();
    const std::optional<Number> number = expressions_.parse();
    if (!number) return {};
    if (!number->valid) return std::nan("");
    if (number->value == std::floor(number->value) && std::fabs(number->value) < largest_counter) return number->value;
    loading_.error(place, std::fabs(number->value) < largest_counter
                              ? fmt::format("a loop counts in whole numbers, and {} is none; floor(…) makes one", number->value)
                              : fmt::format("a loop cannot count as far as {}", number->value));
    return std::nan("");
}

// Every round reads the text anew. A round with errors is the last, for the next would only repeat them.
void Parser::parse_rounds(Items& items, const Loop& loop) {
    const Place opened = lexer_.place();
    if (loop.rounds == 0) return skip_block();
    lexer_.take();

    const Nesting nesting(loading_.depth);
    loading_.multipliers.push_back(
        {fmt::format("the loop over {}", name_of(loop.name)), loop.name.text, loop.place, loop.rounds});
    loading_.foresee(loop.rounds);
    const Lexer::Mark body = lexer_.mark();
    const std::size_t scope = loading_.constants.size();
    const std::size_t errors_before = loading_.messages.errors();

    for (std::uint64_t round = 0; round < loop.rounds && !loading_.stopped; ++round) {
        if (round > 0) lexer_.return_to(body);
        loading_.later_rounds += round > 0;
        const std::size_t start = lexer_.position();
        const std::uint64_t produced_before = loading_.produced;
        const Number counter{loop.first + static_cast<double>(round), false, true};
        loading_.multipliers.back().counter = counter.value;
        loading_.constants.define(loop.name.text, {counter, lexer_.place_of(loop.name), true});
        parse_items(items, true);

        // A round counts for at least one item, and for more where much text made few.
        const std::uint64_t effort = 1 + (lexer_.position() - start) / bytes_per_item;
        loading_.charge(effort - std::min(effort, loading_.produced - produced_before));
        loading_.warn_unused_since(scope);
        loading_.constants.forget_since(scope);
        loading_.later_rounds -= round > 0;
        if (loading_.messages.errors() > errors_before) break;
    }
    loading_.multipliers.pop_back();
    if (loading_.stopped) return lexer_.skip_to_end();
    close_block("repeat", opened);
}

// include "file"
void Parser::parse_include(Items& items) {
    const Place place = lexer_.place();
    lexer_.take();
    if (lexer_.current().kind != Token::Kind::string) {
        loading_.error(lexer_.place(),
                       fmt::format("expected a file name after 'include', not {}: include \"file\"", name_of(lexer_.current())));
        return skip_statement();
    }
    const Token name = lexer_.take();
    if (lexer_.current().is(';')) lexer_.take();

    if (name.text.empty()) return loading_.error(lexer_.place_of(name), "the name of the file to include is empty");
    if (too_deep(place)) return;
    const SourceFile* file = open_include(name.text, lexer_.place_of(name));
    if (!file) return;

    const Nesting nesting(loading_.depth);
    loading_.multipliers.push_back({fmt::format("the included file '{}'", printable(name.text, 200)), {}, place});
    loading_.include_chain.push_back(identity_of(file->name));
    loading_.charge(1 + file->text.size() / bytes_per_item);
    Parser(*file, loading_).parse(items);
    loading_.include_chain.pop_back();
    loading_.multipliers.pop_back();
    if (loading_.stopped) lexer_.skip_to_end();
}

// Null where it cannot be; that is reported. In a loop a file is read from the disk once.
const SourceFile* Parser::open_include(std::string_view name, const Place& place) {
    const SourceFile*& known = loading_.included[{place.file, std::uint64_t{place.line} << 32 | place.column}];
    if (known) return known;

    const FoundFile found = find_include(name, file_.name, loading_.options.include_path);
    if (found.file.empty()) {
        std::string tried;
        for (const auto& file : found.tried) tried += fmt::format("{}'{}'", tried.empty() ? "" : ", ", file.string());
        loading_.error(place, fmt::format("there is no file '{}' to include; looked for {}{}", printable(name, 200), tried,
                                          did_you_mean(name, neighbours(found.tried))));
        return nullptr;
    }
    if (is_circular(identity_of(found.file), place)) return nullptr;

    FileText file = read_file(found.file);
    if (!file.failure.empty()) {
        loading_.error(place, file.failure);
        return nullptr;
    }
    known = &loading_.sources.add(found.file.string(), std::move(file.text), place);
    return known;
}

bool Parser::is_circular(const std::filesystem::path& identity, const Place& place) {
    const std::vector<std::filesystem::path>& chain = loading_.include_chain;
    const auto first = std::find(chain.begin(), chain.end(), identity);
    if (first == chain.end()) return false;

    // Back along the includes to where the circle began.
    const SourceFile* file = &file_;
    std::string circle = fmt::format("'{}' includes ", file->name);
    for (auto link = chain.end() - 1; link != first; --link) {
        file = file->included_at.file;
        circle.insert(0, fmt::format("'{}' includes ", file->name));
    }
    loading_.error(place, fmt::format("circular include: {}'{}'; take one of these includes out", circle, file->name));
    return true;
}

}  // namespace lapidary::scene_language
