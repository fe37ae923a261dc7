// SPDX-License-Identifier: MIT
//
// The format-neutral tree that every loader produces: blocks, properties, references, values and places. It knows
// nothing of spheres or lights; expressions, `let`, `repeat` and `include` are already carried out.
#pragma once

#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "kernel/report/place.h"

namespace lapidary {

// One value between the parentheses of a property. `srgb(…)` and `hex(…)` arrive as the three linear numbers they
// stand for.
struct Value {
    enum class Kind { number, text, word };
    Kind kind = Kind::number;
    double number = 0;
    bool angle = false;  // written with a unit of angle: 90deg, 0.5rad, or an expression of such
    std::string text;    // of a text (without quotes) or a word; of a number that is one constant, its name
    Place place;
};

struct Property {
    std::string keyword;
    std::vector<Value> values;
    Place place;
};

// `name;`
struct Reference {
    std::string name;
    Place place;
};

struct Block;
using Item = std::variant<Property, Reference, std::unique_ptr<Block>>;
using Items = std::vector<Item>;

// `{ … }`
struct Branch {
    Place place;  // of the `{`
    Items items;
};

// `keyword [name] { … } [with { … }]…`
struct Block {
    std::string keyword;
    std::string name;              // empty: none
    std::vector<Branch> branches;  // at least one; more after each `with`
    Place place;                   // of the keyword
    Place name_place;
};

struct Document {
    std::shared_ptr<Sources> sources = std::make_shared<Sources>();  // what the places point into
    Items items;
    std::vector<std::string> constants;  // names of the numbers that it defined, for suggestions
};

}  // namespace lapidary
