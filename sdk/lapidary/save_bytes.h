// SPDX-License-Identifier: MIT
//
// Writes a file whole, or says why not.
#pragma once

#include <cerrno>
#include <cstddef>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <span>
#include <stdexcept>

namespace lapidary {

// Throws std::runtime_error with the system's reason; what was written until then stays for the caller to remove.
inline void save_bytes(std::span<const std::byte> bytes, const std::filesystem::path& file) {
    std::FILE* const stream = std::fopen(file.c_str(), "wb");
    if (!stream) throw std::runtime_error(std::strerror(errno));
    const bool written = std::fwrite(bytes.data(), 1, bytes.size(), stream) == bytes.size();
    const int reason = errno;
    const bool closed = std::fclose(stream) == 0;  // writes the rest
    if (!written || !closed) throw std::runtime_error(std::strerror(written ? errno : reason));
}

}  // namespace lapidary
