// SPDX-License-Identifier: MIT
//
// Signals that ask the program to end. The first one asks the renderer to stop, so that what is done can be written;
// the second one ends the program at once. Before the first pixel there is nothing to save, and signals do what they
// always do.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>

namespace lapidary {

class Interruption {
public:
    // From now on SIGINT, SIGTERM and SIGHUP set the flag.
    static void listen();
    static void request();
    static const std::atomic<bool>& requested() { return requested_; }
    // How long ago the first request was made, in seconds; nothing where there is none.
    static std::optional<double> seconds_since_request();
    // Whether a signal came, not the program's own request.
    static bool signalled();
    // Takes a request of the program's own back; a signal's stays.
    static void withdraw();

    // A file that is half written; the second signal removes it.
    static void guard(const std::filesystem::path& file);
    static void release();

private:
    static void receive(int signal);
    using Clock = std::chrono::steady_clock;
    static inline std::atomic<bool> requested_{false};
    static inline std::atomic<Clock::rep> requested_at_{0};  // 0: never
};

}  // namespace lapidary
