// SPDX-License-Identifier: MIT
#include "kernel/scene/names.h"

#include <fmt/format.h>

namespace lapidary {

std::string describe(const Place& place) {
    if (!place.file) return "the command line";
    return fmt::format("{}:{}:{}", place.file->name, place.line, place.column);
}

NamedThing* NameTable::reserve(const Block& block, NameKind kind, bool needs_use) {
    if (block.name.empty()) return nullptr;
    if (const auto taken = by_name_.find(block.name); taken != by_name_.end()) {
        messages_.error(block.name_place, fmt::format("'{}' is defined a second time; the first definition is at {}", block.name,
                                                      describe(taken->second->place)));
        return nullptr;
    }
    NamedThing& thing = things_.emplace_back();
    thing.name = block.name;
    thing.kind = kind;
    thing.place = block.name_place;
    thing.needs_use = needs_use;
    by_name_.emplace(thing.name, &thing);
    return &thing;
}

const NamedThing* NameTable::use(const Reference& reference) {
    const auto found = by_name_.find(reference.name);
    if (found == by_name_.end()) {
        report_unknown(reference);
        return nullptr;
    }
    NamedThing& thing = *found->second;
    thing.used = true;
    if (thing.under_way) {
        messages_.error(reference.place, fmt::format("'{}' is used inside its own definition", reference.name));
        return nullptr;
    }
    return &thing;
}

void NameTable::report_unknown(const Reference& reference) {
    // Beyond what is shown, errors only count; and a search through all names for each of very many takes long.
    if (!messages_.wants_errors()) return messages_.error(reference.place, {});
    if (!collected_) collect_definitions(document_.items);
    collected_ = true;
    if (const auto below = defined_anywhere_.find(reference.name); below != defined_anywhere_.end()) {
        messages_.error(reference.place, fmt::format("'{}' is used above its definition at {}; move the definition up",
                                                     reference.name, describe(below->second)));
        return;
    }
    std::vector<std::string> known;
    if (++unknown_ <= most_suggestions)
        for (const NamedThing& thing : things_) known.push_back(thing.name);
    messages_.error(reference.place, fmt::format("unknown name '{}'{}", reference.name, did_you_mean(reference.name, known)));
}

void NameTable::collect_definitions(const Items& items) {
    std::vector<const Items*> pending{&items};
    while (!pending.empty()) {
        const Items* next = pending.back();
        pending.pop_back();
        for (const Item& item : *next)
            if (const auto* block = std::get_if<std::unique_ptr<Block>>(&item)) {
                if (!(*block)->name.empty()) defined_anywhere_.emplace((*block)->name, (*block)->name_place);
                for (const Branch& branch : (*block)->branches) pending.push_back(&branch.items);
            }
    }
}

void NameTable::report_unused() const {
    for (const NamedThing& thing : things_)
        if (thing.needs_use && !thing.used)
            messages_.warning(thing.place, fmt::format("'{}' is defined but never used", thing.name));
}

}  // namespace lapidary
