// SPDX-License-Identifier: MIT
//
// A file appears whole or not at all: it is written beside its place, then renamed.
#pragma once

#include <filesystem>
#include <functional>

namespace lapidary {

// Fails before any work is spent where `file` surely cannot be written. Throws OutputError.
void require_writable(const std::filesystem::path& file);

// Calls `write` with the name to write to. Where it throws, nothing is left behind, an older file stays as it was, and
// an OutputError tells of it. A device or pipe is written as it is.
void replace_file(const std::filesystem::path& file, const std::function<void(const std::filesystem::path&)>& write);

}  // namespace lapidary
