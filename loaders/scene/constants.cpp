// SPDX-License-Identifier: MIT
#include "loaders/scene/constants.h"

#include <numbers>

namespace lapidary::scene_language {

Constants::Constants() { define("pi", {{std::numbers::pi, false, true}, {}, false, true}); }

const Constant* Constants::use(std::string_view name) {
    const auto found = constants_.find(name);
    if (found == constants_.end()) return nullptr;
    found->second.used = true;
    return &found->second;
}

const Constant* Constants::find(std::string_view name) const {
    const auto found = constants_.find(name);
    return found == constants_.end() ? nullptr : &found->second;
}

void Constants::define(std::string_view name, const Constant& constant) {
    constants_.emplace(name, constant);
    names_.push_back(name);
}

void Constants::forget_since(std::size_t size) {
    for (; names_.size() > size; names_.pop_back()) constants_.erase(names_.back());
}

}  // namespace lapidary::scene_language
