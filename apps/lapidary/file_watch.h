// SPDX-License-Identifier: MIT
//
// Notices that files were saved, for --watch: by asking for their times, which works on every file system.
#pragma once

#include <chrono>
#include <filesystem>
#include <map>

namespace lapidary {

class FileWatch {
public:
    void add(const std::filesystem::path& file) { states_.emplace(file, state_of(file)); }

    // Whether one of the files is another than when it was added. Asks the system at most ten times a second.
    bool changed() {
        const auto now = std::chrono::steady_clock::now();
        if (changed_ || now < next_) return changed_;
        next_ = now + std::chrono::milliseconds(100);
        for (const auto& [file, state] : states_)
            if (state_of(file) != state) changed_ = true;
        return changed_;
    }

private:
    struct State {
        bool exists = false;
        std::filesystem::file_time_type time;
        std::uintmax_t size = 0;
        bool operator==(const State&) const = default;
    };

    static State state_of(const std::filesystem::path& file) {
        std::error_code missing;
        State state;
        state.time = std::filesystem::last_write_time(file, missing);
        if (missing) return {};
        state.size = std::filesystem::file_size(file, missing);
        state.exists = true;
        return state;
    }

    std::map<std::filesystem::path, State> states_;
    std::chrono::steady_clock::time_point next_;
    bool changed_ = false;
};

}  // namespace lapidary
