// SPDX-License-Identifier: MIT
//
// What the user reads while the program works, on standard error: messages as they come, the progress, and, where
// asked for, remarks about what is going on.
#pragma once

#include <chrono>
#include <mutex>
#include <string>

#include "apps/lapidary/progress.h"
#include "kernel/report/messages.h"

namespace lapidary {

class Console {
public:
    struct Style {
        bool warnings = true, verbose = false;
    };
    explicit Console(Style style);
    ~Console();
    Console(const Console&) = delete;
    Console& operator=(const Console&) = delete;

    // Shows messages as they come.
    void listen_to(Messages& messages);
    // Shown always, and where -v was given.
    void say(const std::string& line);
    void remark(const std::string& line);
    bool is_terminal() const { return terminal_; }

    // The share of the picture that is finished, as often as one likes.
    void show_progress(double done);
    // Takes the bar away.
    void end_progress();

private:
    using Clock = std::chrono::steady_clock;
    void write(const std::string& text);
    void erase_bar();

    Style style_;
    bool terminal_;
    std::mutex mutex_;
    RemainingTime remaining_;
    std::optional<Clock::time_point> start_;
    Clock::time_point next_;
    bool bar_shown_ = false;
};

}  // namespace lapidary
