// SPDX-License-Identifier: MIT
#include "loaders/scene/expression.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "kernel/report/printable.h"

namespace lapidary::scene_language {

namespace {

constexpr Number invalid_number{0, false, false};
constexpr int deepest = 200;  // parentheses within parentheses

// What a function makes of angles.
enum class Result { number, angle, like_arguments };

struct Function {
    std::string_view name;
    std::size_t least, most;  // arguments
    Result result;
    double (*apply)(const std::vector<Number>&);
};

constexpr std::size_t any = std::numeric_limits<std::size_t>::max();

double smallest(const std::vector<Number>& a) {
    return std::min_element(a.begin(), a.end(), [](const Number& x, const Number& y) { return x.value < y.value; })->value;
}
double greatest(const std::vector<Number>& a) {
    return std::max_element(a.begin(), a.end(), [](const Number& x, const Number& y) { return x.value < y.value; })->value;
}

using Arguments = const std::vector<Number>&;
constexpr std::array<Function, 15> functions{{
    {"sin", 1, 1, Result::number, [](Arguments a) { return std::sin(a[0].value); }},
    {"cos", 1, 1, Result::number, [](Arguments a) { return std::cos(a[0].value); }},
    {"tan", 1, 1, Result::number, [](Arguments a) { return std::tan(a[0].value); }},
    {"asin", 1, 1, Result::angle, [](Arguments a) { return std::asin(a[0].value); }},
    {"acos", 1, 1, Result::angle, [](Arguments a) { return std::acos(a[0].value); }},
    {"atan", 1, 1, Result::angle, [](Arguments a) { return std::atan(a[0].value); }},
    {"atan2", 2, 2, Result::angle, [](Arguments a) { return std::atan2(a[0].value, a[1].value); }},
    {"sqrt", 1, 1, Result::number, [](Arguments a) { return std::sqrt(a[0].value); }},
    {"abs", 1, 1, Result::like_arguments, [](Arguments a) { return std::fabs(a[0].value); }},
    {"min", 2, any, Result::like_arguments, smallest},
    {"max", 2, any, Result::like_arguments, greatest},
    {"floor", 1, 1, Result::like_arguments, [](Arguments a) { return std::floor(a[0].value); }},
    {"pow", 2, 2, Result::number, [](Arguments a) { return std::pow(a[0].value, a[1].value); }},
    {"exp", 1, 1, Result::number, [](Arguments a) { return std::exp(a[0].value); }},
    {"log", 1, 1, Result::number, [](Arguments a) { return std::log(a[0].value); }},
}};

const Function* find_function(std::string_view name) {
    const auto found = std::find_if(functions.begin(), functions.end(), [&](const Function& f) { return f.name == name; });
    return found == functions.end() ? nullptr : &*found;
}

std::vector<std::string> function_names() {
    std::vector<std::string> names;
    names.reserve(std::size(functions));
    for (const Function& function : functions) names.emplace_back(function.name);
    return names;
}

std::string argument_count(const Function& f) {
    if (f.most == any) return fmt::format("at least {} numbers", f.least);
    return f.least == 1 ? "1 number" : fmt::format("{} numbers", f.least);
}

std::string list_of(const std::vector<Number>& numbers) {
    std::string list;
    for (const Number& number : numbers) list += fmt::format("{}{}", list.empty() ? "" : ", ", number.value);
    return list;
}

}  // namespace

bool is_function(std::string_view word) { return find_function(word) != nullptr; }
bool is_unit(std::string_view word) { return word == "deg" || word == "rad"; }

std::optional<Number> ExpressionParser::parse() {
    open_ = 0;
    return sum();
}

std::optional<std::vector<Number>> ExpressionParser::parse_arguments() {
    open_ = 0;
    return argument_list();
}

std::optional<Number> ExpressionParser::sum() {
    std::optional<Number> result = product();
    while (result && (lexer_.current().is('+') || lexer_.current().is('-'))) {
        const Token op = lexer_.take();
        const std::optional<Number> term = product();
        if (!term) return {};
        const double value = op.is('+') ? result->value + term->value : result->value - term->value;
        result = finite({value, result->angle || term->angle, result->valid && term->valid}, lexer_.place_of(op));
    }
    return result;
}

std::optional<Number> ExpressionParser::product() {
    std::optional<Number> result = factor();
    while (result && (lexer_.current().is('*') || lexer_.current().is('/'))) {
        const Token op = lexer_.take();
        const std::optional<Number> other = factor();
        if (!other) return {};
        const Place place = lexer_.place_of(op);
        result = op.is('/') ? quotient(*result, *other, place)
                            : finite({result->value * other->value, result->angle || other->angle, result->valid && other->valid},
                                     place);
    }
    return result;
}

// The ratio of two angles is a plain number.
Number ExpressionParser::quotient(const Number& a, const Number& b, const Place& place) {
    const bool valid = a.valid && b.valid;
    if (valid && b.value == 0) {
        loading_.error(place, "division by zero");
        return invalid_number;
    }
    return finite({a.value / b.value, a.angle && !b.angle, valid}, place);
}

std::optional<Number> ExpressionParser::factor() {
    bool negative = false;
    while (lexer_.current().is('-') || lexer_.current().is('+')) negative ^= lexer_.take().is('-');
    std::optional<Number> result = primary();
    if (!result) return {};
    if (unit_follows()) apply_unit(*result);
    if (negative) result->value = -result->value;
    return result;
}

// A word that touches a number can only be meant as its unit.
bool ExpressionParser::unit_follows() const {
    const Token& next = lexer_.current();
    const Place behind = lexer_.place_behind();
    const bool touches = next.line == behind.line && next.column == behind.column;
    return next.is_word() && (is_unit(next.text) || touches);
}

void ExpressionParser::apply_unit(Number& number) {
    const Token unit = lexer_.take();
    if (!is_unit(unit.text)) {
        loading_.error(lexer_.place_of(unit), fmt::format("unknown unit {}; the units are 'deg' and 'rad'", name_of(unit)));
        number.valid = false;
        return;
    }
    if (number.angle) {
        loading_.error(lexer_.place_of(unit), fmt::format("this is an angle already; remove '{}'", unit.text));
        number.valid = false;
    }
    if (unit.text == "deg") number.value *= std::numbers::pi / 180;
    number.angle = true;
}

std::optional<Number> ExpressionParser::primary() {
    const Token& next = lexer_.current();
    if (next.kind == Token::Kind::number) return literal();
    if (next.is('(')) return parenthesised();
    if (next.is_word() && lexer_.ahead().is('(')) return function_call();
    if (next.is_word()) return constant();
    loading_.error(lexer_.place(), fmt::format("expected a number, not {}", name_of(next)));
    return {};
}

// What no double can hold was reported by the lexer.
Number ExpressionParser::literal() {
    const double value = lexer_.take().number;
    return std::isnan(value) ? invalid_number : Number{value};
}

std::optional<Number> ExpressionParser::constant() {
    const Token name = lexer_.take();
    if (const Constant* found = loading_.constants.use(name.text)) return found->number;
    const Place place = lexer_.place_of(name);
    if (const Function* f = find_function(name.text)) {
        loading_.error(place, fmt::format("'{0}' is a function; it is written {0}(…) with {1}", f->name, argument_count(*f)));
    } else {
        std::string suggestion;
        if (loading_.messages.wants_errors()) suggestion = did_you_mean(name.text, loading_.constants.name_list());
        const std::string remedy = fmt::format("; define it above with 'let {} = …;'", printable(name.text, 40));
        loading_.error(place, fmt::format("{} is not defined{}", name_of(name), suggestion.empty() ? remedy : suggestion));
    }
    return invalid_number;
}

bool ExpressionParser::open() {
    if (open_ == deepest) {
        loading_.error(lexer_.place(),
                       fmt::format("parentheses stand more than {} deep; name parts of the expression with 'let'", deepest));
        return false;
    }
    lexer_.take();
    ++open_;
    return true;
}

bool ExpressionParser::close(std::string_view expected) {
    if (!lexer_.current().is(')')) {
        loading_.error(lexer_.place(), fmt::format("expected {}, not {}", expected, name_of(lexer_.current())));
        return false;
    }
    lexer_.take();
    --open_;
    return true;
}

std::optional<Number> ExpressionParser::parenthesised() {
    if (!open()) return {};
    const std::optional<Number> result = sum();
    if (!result || !close("an operator or ')'")) return {};
    return result;
}

std::optional<Number> ExpressionParser::function_call() {
    const Token name = lexer_.take();
    const Place place = lexer_.place_of(name);
    if (name.text == "srgb" || name.text == "hex") {
        loading_.error(place,
                       fmt::format("'{}' stands for a colour's three numbers and cannot be part of an expression", name.text));
        return {};
    }
    const std::optional<std::vector<Number>> arguments = argument_list();
    if (!arguments) return {};

    const Function* function = find_function(name.text);
    if (!function) {
        loading_.error(place, fmt::format("unknown function {}{}", name_of(name), did_you_mean(name.text, function_names())));
        return invalid_number;
    }
    if (arguments->size() < function->least || arguments->size() > function->most) {
        loading_.error(place, fmt::format("'{}' takes {}, not {}", function->name, argument_count(*function), arguments->size()));
        return invalid_number;
    }
    if (std::any_of(arguments->begin(), arguments->end(), [](const Number& n) { return !n.valid; })) return invalid_number;

    const double value = function->apply(*arguments);
    if (!std::isfinite(value)) {
        loading_.error(place, fmt::format("{}({}) is no finite number", function->name, list_of(*arguments)));
        return invalid_number;
    }
    const bool any_angle = std::any_of(arguments->begin(), arguments->end(), [](const Number& n) { return n.angle; });
    return Number{value, function->result == Result::angle || (function->result == Result::like_arguments && any_angle), true};
}

std::optional<std::vector<Number>> ExpressionParser::argument_list() {
    std::vector<Number> arguments;
    if (!open()) return {};
    if (!lexer_.current().is(')')) {
        do {
            if (!arguments.empty()) lexer_.take();
            const std::optional<Number> argument = sum();
            if (!argument) return {};
            arguments.push_back(*argument);
        } while (lexer_.current().is(','));
    }
    if (!close("',' or ')'")) return {};
    return arguments;
}

Number ExpressionParser::finite(Number number, const Place& place) {
    if (number.valid && !std::isfinite(number.value)) {
        loading_.error(place, "the result is too large: numbers reach up to 1.79e308");
        number.valid = false;
    }
    if (!number.valid) number.value = 0;
    return number;
}

}  // namespace lapidary::scene_language
