// SPDX-License-Identifier: MIT
//
// Suggestions for misspelt words. The distance counts insertions, deletions, replacements and swaps of neighbours, no
// part of the word being edited twice (optimal string alignment): 'spehre' is 1 from 'sphere'.
#include <algorithm>
#include <array>
#include <cstddef>
#include <set>

#include "kernel/report/messages.h"

namespace lapidary {

namespace {

constexpr std::size_t longest_word = 64;  // nobody means a longer one
constexpr std::size_t most_suggestions = 3;

std::size_t limit_for(std::string_view word) { return std::max<std::size_t>(1, word.size() / 3); }

// The usual table of distances between prefixes, of which three rows are alive.
std::size_t distance(std::string_view a, std::string_view b) {
    using Row = std::array<std::size_t, longest_word + 1>;
    std::array<Row, 3> rows{};
    for (std::size_t j = 0; j <= b.size(); ++j) rows[0][j] = j;

    for (std::size_t i = 1; i <= a.size(); ++i) {
        const Row& before = rows[(i + 1) % 3];
        const Row& last = rows[(i + 2) % 3];
        Row& row = rows[i % 3];
        row[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (a[i - 1] != b[j - 1])});
            const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
            if (swapped) row[j] = std::min(row[j], before[j - 2] + 1);
        }
    }
    return rows[a.size() % 3][b.size()];
}

bool lengths_allow(std::string_view word, std::string_view candidate, std::size_t limit) {
    return candidate.size() <= longest_word && candidate.size() + limit >= word.size() && word.size() + limit >= candidate.size();
}

}  // namespace

std::vector<std::string> nearest_names(std::string_view word, const std::vector<std::string>& candidates) {
    if (word.empty() || word.size() > longest_word) return {};

    // Sorted by distance, then by name; each once.
    std::set<std::pair<std::size_t, std::string_view>> near;
    const std::size_t limit = limit_for(word);
    for (const std::string& candidate : candidates) {
        if (candidate.empty() || candidate == word || !lengths_allow(word, candidate, limit)) continue;
        const std::size_t d = distance(word, candidate);
        // A single letter is one edit from every other: no suggestion at all.
        if (d <= limit && d < std::max(word.size(), candidate.size())) near.emplace(d, candidate);
    }

    std::vector<std::string> names;
    for (const auto& [d, name] : near)
        if (names.size() < most_suggestions) names.emplace_back(name);
    return names;
}

std::string did_you_mean(std::string_view word, const std::vector<std::string>& candidates) {
    const std::vector<std::string> names = nearest_names(word, candidates);
    if (names.empty()) return {};
    std::string sentence = "; did you mean ";
    for (std::size_t i = 0; i < names.size(); ++i)
        sentence += (i == 0 ? "'" : i + 1 == names.size() ? " or '" : ", '") + names[i] + "'";
    return sentence + "?";
}

}  // namespace lapidary
