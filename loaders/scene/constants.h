// SPDX-License-Identifier: MIT
//
// The numbers that a scene gave names to: `let`, the counters of `repeat`, and pi.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "kernel/report/place.h"

namespace lapidary::scene_language {

// A number in the making. Where its expression was wrong it carries on as `valid = false`, so that one mistake makes
// one message.
struct Number {
    double value = 0;
    bool angle = false;  // has a unit of angle
    bool valid = true;
};

struct Constant {
    Number number;
    Place place;
    bool counter = false;  // of a loop
    bool used = false;
};

// Names are views into the sources, which live longer.
class Constants {
public:
    Constants();

    // Null where the name is unknown; counts as use otherwise.
    const Constant* use(std::string_view name);
    const Constant* find(std::string_view name) const;
    // The name must be new.
    void define(std::string_view name, const Constant& constant);

    // Where a scope begins; forget_since() ends it.
    std::size_t size() const { return names_.size(); }
    void forget_since(std::size_t size);

    // Those defined since, in the order of writing.
    const std::vector<std::string_view>& names() const { return names_; }
    std::vector<std::string> name_list() const { return {names_.begin(), names_.end()}; }

private:
    std::unordered_map<std::string_view, Constant> constants_;
    std::vector<std::string_view> names_;
};

}  // namespace lapidary::scene_language
