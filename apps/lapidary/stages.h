// SPDX-License-Identifier: MIT
//
// How long each stage of the work took, by the clock and of all processors together.
#pragma once

#include <chrono>
#include <ctime>
#include <string>
#include <string_view>
#include <vector>

namespace lapidary {

struct Stage {
    std::string name;
    double seconds = 0;
    double processor_seconds = 0;
};

// A stage lasts until the next one begins.
class Stages {
public:
    void begin(std::string name) {
        end();
        stages_.push_back({std::move(name), 0, 0});
        running_ = true;
    }
    void end() {
        const auto now = Clock::now();
        const std::clock_t processor_now = std::clock();
        if (running_) {
            stages_.back().seconds = std::chrono::duration<double>(now - since_).count();
            stages_.back().processor_seconds = static_cast<double>(processor_now - processor_since_) / CLOCKS_PER_SEC;
        }
        since_ = now;
        processor_since_ = processor_now;
        running_ = false;
    }
    // What the stages before one of this name took together.
    double seconds_before(std::string_view name) const {
        double seconds = 0;
        for (const Stage& stage : stages_) {
            if (stage.name == name) break;
            seconds += stage.seconds;
        }
        return seconds;
    }
    const std::vector<Stage>& all() const { return stages_; }

private:
    using Clock = std::chrono::steady_clock;
    std::vector<Stage> stages_;
    Clock::time_point since_ = Clock::now();
    std::clock_t processor_since_ = std::clock();
    bool running_ = false;
};

}  // namespace lapidary
