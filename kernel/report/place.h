// SPDX-License-Identifier: MIT
//
// Where in the user's files something stands.
#pragma once

#include <cstdint>
#include <deque>
#include <string>

#include "kernel/export.h"

namespace lapidary {

struct SourceFile;

// Line and column count from 1, columns in bytes; 0 means "the file as a whole". A place without a file belongs to the command
// line or to the program itself.
struct Place {
    const SourceFile* file = nullptr;
    std::uint32_t line = 0;
    std::uint32_t column = 0;
};

struct SourceFile {
    std::string name;  // as the user would write it
    std::string text;
    Place included_at;  // where the include stands; no file for the first one
};

// Keeps every file that was read, so that messages can show lines of it. Addresses stay valid.
class LAPIDARY_API Sources {
public:
    const SourceFile& add(std::string name, std::string text, Place included_at = {});
    const std::deque<SourceFile>& files() const { return files_; }

private:
    std::deque<SourceFile> files_;
};

}  // namespace lapidary
