// SPDX-License-Identifier: MIT
//
// The interface of a destination for the picture: takes tiles as they are finished, and the whole frame at the end;
// may show them, write them, or both.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "kernel/export.h"
#include "kernel/render/frame.h"

namespace lapidary {

// Pixels x0 <= x < x1, y0 <= y < y1, from the top left.
struct PixelRegion {
    int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
    int width() const { return x1 - x0; }
    int height() const { return y1 - y0; }
    bool is_empty() const { return x1 <= x0 || y1 <= y0; }
};

// What the numbers of the layers `object` and `material` stand for, by number; [0] is what is not there.
struct Legend {
    std::vector<std::string> objects, materials;
};

struct FrameInfo {
    int width = 0, height = 0;   // of the full picture
    PixelRegion region;          // the part that is rendered
    std::filesystem::path path;  // the file that the user asked for; empty for an output without a file
    std::string title;
    std::map<std::string, std::string> metadata;  // program, version, scene …
    std::shared_ptr<const Legend> legend;         // null where nobody looks on
};

class LAPIDARY_API Output {
public:
    Output() = default;
    Output(const Output&) = delete;
    Output& operator=(const Output&) = delete;
    virtual ~Output();

    // The layers beside colour that this output wants filled.
    virtual LayerSet layers() const { return {}; }
    // File extensions (without dot, lower case) that this output writes; none for an output without a file.
    virtual std::vector<std::string> extensions() const { return {}; }

    // Called before the first pixel.
    virtual void begin(const FrameInfo& info);
    // Called while the picture renders, from a thread of its own, unless it is finished too soon: the place to load heavy
    // libraries for finish(), which loads them itself where this was not called, or failed.
    virtual void prepare();
    // Called after each finished tile, from the thread that finished it, one at a time.
    virtual void tile(const Frame& frame, const PixelRegion& region);
    // Called once at the end, also after an interruption (frame.is_complete() tells). Writes to `file`, a name beside the
    // final one that the kernel renames afterwards. Throws std::runtime_error with a sentence where it cannot.
    virtual void finish(const Frame& frame, const FrameInfo& info, const std::filesystem::path& file) = 0;
    // A closed window, an Escape key.
    virtual bool wants_to_stop() const { return false; }
    // After the end: somebody still looks at it, and the program should wait.
    virtual bool stays_open() const { return false; }
};

}  // namespace lapidary
