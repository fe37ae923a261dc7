// SPDX-License-Identifier: MIT
#include "loaders/scene/loading.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "kernel/report/printable.h"

namespace lapidary::scene_language {

void Loading::warning(const Place& place, std::string text) {
    if (later_rounds == 0) messages.warning(place, std::move(text));
}

void Loading::error(const Place& place, std::string text) {
    std::string round;
    if (later_rounds > 0)
        for (const Multiplier& loop : multipliers)
            if (!loop.name.empty())
                round += fmt::format("{}{} = {}", round.empty() ? "" : ", ", printable(loop.name, 40), loop.counter);
    messages.error(place, round.empty() ? std::move(text) : fmt::format("{} (in the round with {})", text, round));
}

// Behind an error, text was skipped that may hold the use.
void Loading::warn_unused_since(std::size_t scope) {
    if (messages.has_errors()) return;
    const std::vector<std::string_view>& names = constants.names();
    for (std::size_t i = scope; i < names.size(); ++i) {
        const Constant& constant = *constants.find(names[i]);
        const bool in_library = !constant.place.file || constant.place.file->included_at.file;
        if (!constant.used && !constant.counter && !in_library)
            warning(constant.place, fmt::format("'{}' is defined, but not used", printable(names[i], 40)));
    }
}

void Loading::charge(std::uint64_t items) {
    if (multipliers.empty() || stopped) return;
    produced += items;
    if (produced > options.max_items) stop();
}

void Loading::foresee(std::uint64_t items) {
    if (!stopped && items > options.max_items - produced) stop();
}

// Of all loops around, the one with the most rounds is what the user wants to hear of.
void Loading::stop() {
    stopped = true;
    const auto fewer_rounds = [](const Multiplier& a, const Multiplier& b) { return a.rounds < b.rounds; };
    const Multiplier& culprit = *std::max_element(multipliers.begin(), multipliers.end(), fewer_rounds);
    messages.error(culprit.place, fmt::format("{} makes more than {} items; make it smaller, or raise the bound with --max-items",
                                              culprit.what, options.max_items));
}

}  // namespace lapidary::scene_language
