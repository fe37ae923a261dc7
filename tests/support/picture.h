// SPDX-License-Identifier: MIT
//
// Reads the pictures that tests let the program write as 24-bit BMP.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <vector>

namespace lapidary {

// Everything behind the header of 54 bytes; empty where there is no such file.
inline std::vector<std::uint8_t> read_bmp_pixels(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    std::vector<std::uint8_t> bytes((std::istreambuf_iterator<char>(stream)), std::istreambuf_iterator<char>());
    bytes.erase(bytes.begin(), bytes.begin() + std::min<std::ptrdiff_t>(54, static_cast<std::ptrdiff_t>(bytes.size())));
    return bytes;
}

// How many bytes differ by more than a step of rounding.
inline std::size_t count_differences(const std::vector<std::uint8_t>& a, const std::vector<std::uint8_t>& b) {
    if (a.size() != b.size()) return std::max(a.size(), b.size());
    std::size_t differences = 0;
    for (std::size_t i = 0; i < a.size(); ++i) differences += std::abs(a[i] - b[i]) > 1;
    return differences;
}

}  // namespace lapidary
