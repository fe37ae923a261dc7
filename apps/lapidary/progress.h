// SPDX-License-Identifier: MIT
//
// How far the picture is, in words: a bar on a terminal, lines at long intervals elsewhere. No clock and no stream is
// touched here.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>

namespace lapidary {

// "0.4 s", "42 s", "3 min 07 s", "2 h 05 min".
inline std::string format_duration(double seconds) {
    const auto two_digits = [](long n) { return (n < 10 ? "0" : "") + std::to_string(n); };
    if (!(seconds >= 0) || seconds > 1e9) return "unknown time";
    if (seconds < 9.95) {
        const long tenths = std::lround(seconds * 10);
        return std::to_string(tenths / 10) + "." + std::to_string(tenths % 10) + " s";
    }
    const long whole = std::lround(seconds);
    if (whole < 60) return std::to_string(whole) + " s";
    if (whole < 3600) return std::to_string(whole / 60) + " min " + two_digits(whole % 60) + " s";
    return std::to_string(whole / 3600) + " h " + two_digits(whole / 60 % 60) + " min";
}

// How long the rest will take. Pictures are uneven, so the recent speed counts for more than the old one: an
// exponential mean whose memory is a tenth of the time spent, at least two seconds.
class RemainingTime {
public:
    // Tells that at `seconds` since the start the share `done` (0 to 1) is finished.
    void update(double seconds, double done) {
        const double step = seconds - seconds_, gain = done - done_;
        if (!(step > 0)) return;
        const double memory = std::max(2.0, 0.1 * seconds);
        const double weight = rate_ ? 1 - std::exp(-step / memory) : 1;
        rate_ = rate_.value_or(0) * (1 - weight) + weight * gain / step;
        seconds_ = seconds, done_ = done;
    }

    // Nothing as long as there is too little to tell by.
    std::optional<double> seconds() const {
        if (!rate_ || !(*rate_ > 0) || seconds_ < 0.5) return std::nullopt;
        return (1 - done_) / *rate_;
    }

private:
    double seconds_ = 0, done_ = 0;
    std::optional<double> rate_;
};

// "37 %  12 s left": percent never shows 100 before the end.
inline std::string progress_text(double done, const std::optional<double>& remaining) {
    const int percent = std::clamp(static_cast<int>(std::floor(done * 100)), 0, 100);
    return std::to_string(percent) + " %" + (remaining ? ", " + format_duration(*remaining) + " left" : "");
}

// "[######----]  37 %, 12 s left", as wide as fits in `columns`; without bar where that is narrow.
inline std::string progress_bar(double done, const std::optional<double>& remaining, std::size_t columns) {
    const std::string text = progress_text(done, remaining);
    const std::size_t taken = text.size() + 4;
    if (columns < taken + 10) return text.substr(0, columns);
    const std::size_t length = std::min<std::size_t>(columns - taken, 50);
    const auto filled = static_cast<std::size_t>(std::clamp(done, 0.0, 1.0) * static_cast<double>(length));
    return "[" + std::string(filled, '#') + std::string(length - filled, '-') + "]  " + text;
}

}  // namespace lapidary
