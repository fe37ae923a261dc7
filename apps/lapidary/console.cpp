// SPDX-License-Identifier: MIT
#include "apps/lapidary/console.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdio>

namespace lapidary {

namespace {

using namespace std::chrono_literals;

// A bar moves ten times a second; into a file goes a line every ten seconds, so that a short job says nothing.
constexpr auto bar_interval = 100ms;
constexpr auto line_interval = 10s;

std::size_t terminal_columns() {
    winsize size{};
    return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

}  // namespace

Console::Console(Style style) : style_(style), terminal_(isatty(STDERR_FILENO) == 1) {}

Console::~Console() { end_progress(); }

void Console::listen_to(Messages& messages) {
    messages.listen([this](const Message& message) {
        if (style_.warnings || message.severity == Severity::error) write(message.format());
    });
}

void Console::say(const std::string& line) { write(line + "\n"); }

void Console::remark(const std::string& line) {
    if (style_.verbose) say(line);
}

void Console::show_progress(double done) {
    const std::scoped_lock lock(mutex_);
    const auto now = Clock::now();
    if (!start_) start_ = now, next_ = now + (terminal_ ? Clock::duration(bar_interval) : Clock::duration(line_interval));
    if (now < next_) return;
    remaining_.update(std::chrono::duration<double>(now - *start_).count(), done);
    if (terminal_) {
        const std::string bar = progress_bar(done, remaining_.seconds(), terminal_columns() - 1);
        std::fprintf(stderr, "\r\033[K%s", bar.c_str());
        std::fflush(stderr);
        bar_shown_ = true;
        next_ = now + bar_interval;
    } else {
        std::fprintf(stderr, "%s\n", progress_text(done, remaining_.seconds()).c_str());
        next_ = now + line_interval;
    }
}

void Console::end_progress() {
    const std::scoped_lock lock(mutex_);
    erase_bar();
    start_.reset();
    remaining_ = {};
}

void Console::write(const std::string& text) {
    const std::scoped_lock lock(mutex_);
    erase_bar();
    std::fputs(text.c_str(), stderr);
}

void Console::erase_bar() {
    if (bar_shown_) std::fputs("\r\033[K", stderr);
    bar_shown_ = false;
}

}  // namespace lapidary
