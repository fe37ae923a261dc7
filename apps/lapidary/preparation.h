// SPDX-License-Identifier: MIT
//
// Lets the outputs load, while the picture renders, what they need when it is finished.
//
// The dynamic loader holds a lock while it opens a library and those that it brings, a sixth of a second for the one
// that knows image files. Whoever creates a thread needs the same lock, and so does a library that opens another. So
// the loading begins a moment after the rendering: then the renderer's threads are there, and nothing waits for it,
// least of all a render that is told to stop.
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
    explicit Preparation(const std::vector<PictureFile>& pictures)
        : thread_([&pictures](const std::stop_token& finished) {
              if (!wait(finished)) return;
              for (const PictureFile& picture : pictures) prepare(*picture.output);
          }) {}

private:
    // Until the renderer's threads are there. False: the picture was finished sooner.
    static bool wait(const std::stop_token& finished) {
        std::mutex mutex;
        std::condition_variable_any never;
        std::unique_lock lock(mutex);
        never.wait_for(lock, finished, std::chrono::milliseconds(10), [] { return false; });
        return !finished.stop_requested();
    }

    static void prepare(Output& output) {
        try {
            output.prepare();
        } catch (...) {
            // What cannot be loaded is missed by finish(), which says so.
        }
    }

    std::jthread thread_;  // asked to stop and waited for at the end
};

}  // namespace lapidary
