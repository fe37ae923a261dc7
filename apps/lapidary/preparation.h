// SPDX-License-Identifier: MIT
//
// Lets the outputs load, while the picture renders, what they need when it is finished.
//
// The dynamic loader holds a lock while it opens a library and those that it brings, a sixth of a second for the one
// that knows image files. Whoever creates a thread needs the same lock, and so does a library that opens another. So
// the loading begins a moment after the rendering: then the renderer's threads are there, and nothing waits for it,
// least of all a render that is told to stop. Where somebody looks on, it leaves the processors to the first view, too.
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <stop_token>
#include <thread>
#include <vector>

#include "apps/lapidary/picture_files.h"

namespace lapidary {

class Preparation {
public:
    // The pictures stay as they are meanwhile.
    Preparation(const std::vector<PictureFile>& pictures, bool is_shown)
        : thread_([this, &pictures, is_shown](const std::stop_token& finished) {
              if (!wait(std::chrono::milliseconds(is_shown ? 100 : 10), finished)) return;
              for (const PictureFile& picture : pictures) prepare(*picture.output);
          }) {}

    // The renderer is at work.
    void begin() {
        {
            const std::scoped_lock lock(mutex_);
            has_begun_ = true;
        }
        begun_.notify_one();
    }

private:
    // Until so long after the beginning. False: the picture was finished sooner.
    bool wait(std::chrono::milliseconds moment, const std::stop_token& finished) {
        std::unique_lock lock(mutex_);
        if (!begun_.wait(lock, finished, [this] { return has_begun_; })) return false;
        begun_.wait_for(lock, finished, moment, [] { return false; });
        return !finished.stop_requested();
    }

    static void prepare(Output& output) {
        try {
            output.prepare();
        } catch (...) {
            // What cannot be loaded is missed by finish(), which says so.
        }
    }

    std::mutex mutex_;
    std::condition_variable_any begun_;
    bool has_begun_ = false;
    std::jthread thread_;  // asked to stop and waited for at the end
};

}  // namespace lapidary
