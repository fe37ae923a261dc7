// SPDX-License-Identifier: MIT
#include "apps/lapidary/interruption.h"

#include <unistd.h>

#include <csignal>
#include <cstring>

#include "apps/lapidary/exit_code.h"

namespace lapidary {

namespace {

// What a signal handler may touch: plain memory and lock-free flags.
char guarded_file[4096];
std::atomic<bool> guarded{false};
std::atomic<int> signals{0};

}  // namespace

void Interruption::receive(int) {
    request();
    if (signals.fetch_add(1) == 0) return;
    if (guarded) unlink(guarded_file);
    _exit(static_cast<int>(ExitCode::interrupted));
}

// Async-signal-safe, as is all that it calls.
void Interruption::request() {
    static_assert(std::atomic<Clock::rep>::is_always_lock_free);
    Clock::rep never = 0;
    requested_at_.compare_exchange_strong(never, Clock::now().time_since_epoch().count());
    requested_ = true;
}

void Interruption::withdraw() {
    requested_ = signalled();
    if (!requested_) requested_at_ = 0;
}

std::optional<double> Interruption::seconds_since_request() {
    const Clock::rep at = requested_at_;
    if (at == 0) return std::nullopt;
    return std::chrono::duration<double>(Clock::now().time_since_epoch() - Clock::duration(at)).count();
}

bool Interruption::signalled() { return signals > 0; }

void Interruption::listen() {
    static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<int>::is_always_lock_free);
    struct sigaction action {};
    action.sa_handler = &Interruption::receive;
    action.sa_flags = SA_RESTART;
    sigemptyset(&action.sa_mask);
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
        struct sigaction before {};
        // A program started with nohup stays deaf to the hang-up.
        if (sigaction(signal, nullptr, &before) == 0 && before.sa_handler == SIG_IGN) continue;
        sigaction(signal, &action, nullptr);
    }
}

void Interruption::guard(const std::filesystem::path& file) {
    guarded = false;
    if (std::strlen(file.c_str()) >= sizeof guarded_file) return;
    std::strcpy(guarded_file, file.c_str());
    guarded = true;
}

void Interruption::release() { guarded = false; }

}  // namespace lapidary
