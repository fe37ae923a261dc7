// SPDX-License-Identifier: MIT
//
// Encoding and decoding of image files. The library that does it takes a sixth of a second to load (it brings some 260
// others), so nothing links it: it is opened when a picture has to be written or read, best where nobody waits for it
// (Output::prepare).
//
//     const std::vector<std::byte> bytes = load_image_library()->encode(picture);  // throws std::runtime_error
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

#include "kernel/registry/library.h"

namespace lapidary {

// A picture as it stands in a file: what the format calls samples, interleaved, row by row from the top left.
struct Picture {
    struct Channel {
        std::string name;   // "R", "Z", "normal.X"
        bool half = false;  // of float samples: store 16 bits
    };
    std::string format;         // as the library calls it: "png", "openexr"
    int width = 0, height = 0;  // of the samples
    int x = 0, y = 0;           // where they lie in the full picture
    int full_width = 0, full_height = 0;
    std::vector<Channel> channels;
    std::variant<std::vector<std::uint8_t>, std::vector<std::uint16_t>, std::vector<float>> samples;
    std::map<std::string, std::string> texts;  // metadata; formats keep what they have a place for
    std::map<std::string, int> settings;       // of the format: "quality"
    bool linear = true;                        // intensities; otherwise encoded with the sRGB curve
};

class ImageLibrary {
public:
    virtual ~ImageLibrary() = default;
    // The bytes of the file. Throws std::runtime_error with a sentence.
    virtual std::vector<std::byte> encode(const Picture& picture) const = 0;
    // The file as floats: integer samples are divided by the largest one. Throws std::runtime_error with a sentence.
    virtual Picture decode(const std::filesystem::path& file) const = 0;
};

// What the module "image" exports as lapidary_image_library.
using ImageLibraryEntry = const ImageLibrary* (*)();

// Opens it at the first call; it stays open until the program ends. Throws std::runtime_error where it does not load.
inline const ImageLibrary* load_image_library() {
    return reinterpret_cast<ImageLibraryEntry>(open_module("image", "lapidary_image_library"))();
}

}  // namespace lapidary
