// SPDX-License-Identifier: MIT
//
// What writers of image files share. A writer says which formats it knows and makes a Picture of the finished frame;
// loading the image library in the background, cropping, encoding, metadata and writing are done here.
//
// A region of a picture becomes a file of the region's size; where the format knows of larger pictures (EXR's display
// window), it keeps its place there. Pixels that an interruption left out are black, and the metadata say so.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "kernel/interfaces/output.h"
#include "kernel/registry/schema.h"
#include "lapidary/image_library.h"
#include "lapidary/save_bytes.h"

namespace lapidary {

class ImageWriter : public Output {
public:
    void prepare() override { library_ = load_image_library(); }

    void finish(const Frame& frame, const FrameInfo& info, const std::filesystem::path& file) override {
        if (!library_) library_ = load_image_library();
        Picture picture = outline(frame, info);
        fill(picture, frame, info.region);
        save_bytes(library_->encode(picture), file);
    }

protected:
    // Sets format, channels and samples of the region; everything else is there.
    virtual void fill(Picture& picture, const Frame& frame, const PixelRegion& region) const = 0;

private:
    static Picture outline(const Frame& frame, const FrameInfo& info) {
        const PixelRegion& region = info.region;
        Picture picture;
        picture.width = region.width(), picture.height = region.height();
        picture.x = region.x0, picture.y = region.y0;
        picture.full_width = info.width, picture.full_height = info.height;
        picture.texts = info.metadata;

        std::string description = info.title;
        const auto remark = [&](const std::string& key, const std::string& text) {
            picture.texts[key] = text;
            description += (description.empty() ? "" : "; ") + text;
        };
        if (region.width() != info.width || region.height() != info.height)
            remark("Region", std::to_string(region.x0) + "," + std::to_string(region.y0) + "," + std::to_string(region.x1) + "," +
                                 std::to_string(region.y1) + " of " + std::to_string(info.width) + "x" +
                                 std::to_string(info.height));
        const auto pixels = static_cast<std::size_t>(region.width()) * static_cast<std::size_t>(region.height());
        remark("Status", frame.is_complete() ? "complete"
                                             : "interrupted after " + std::to_string(std::min(frame.finished(), pixels)) +
                                                   " of " + std::to_string(pixels) + " pixels");
        picture.texts["ImageDescription"] = description;
        return picture;
    }

    const ImageLibrary* library_ = nullptr;
};

// The sRGB curve to 8 bits, ten times as fast as by its formula and to the same step: a table brings a value close, and
// from there the exact thresholds between the steps decide.
class SrgbBytes {
public:
    SrgbBytes() {
        for (int step = 1; step <= 255; ++step) thresholds_[static_cast<std::size_t>(step)] = threshold(step);
        for (int i = 0; i < cells; ++i)
            start_[static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(encode(static_cast<double>(i) / cells));
    }

    // Of a value from 0 to 1.
    std::uint8_t operator()(float value) const {
        int step = start_[static_cast<std::size_t>(std::min(static_cast<int>(value * cells), cells - 1))];
        while (step < 255 && value >= thresholds_[static_cast<std::size_t>(step) + 1]) ++step;
        return static_cast<std::uint8_t>(step);
    }

private:
    static constexpr int cells = 4096;  // a power of two, so that the cell of a value is exact

    static long encode(double value) { return std::lround(srgb_encode(value) * 255); }

    // The smallest float that is encoded as `step` or more, by bisection down to neighbouring floats.
    static float threshold(int step) {
        float below = 0, above = 1;
        while (std::nextafter(below, above) < above) {
            const float middle = below + (above - below) / 2;
            (encode(middle) < step ? below : above) = middle;
        }
        return above;
    }

    std::array<float, 256> thresholds_{};
    std::array<std::uint8_t, cells> start_{};
};

// Writers of 8 or 16 bits a sample: three channels, each clipped to 0…1, encoded and rounded to the nearest step.
class IntegerWriter : public ImageWriter {
protected:
    enum class Encoding { srgb, linear };

    template <class Writer>
    static void describe_encoding(Schema<Writer>& schema) {
        schema.add("encoding", &IntegerWriter::encoding_, {"srgb", "linear"})
            .help("srgb: for screens; linear: the values as they are.");
    }

    template <class Sample>
    void fill_samples(Picture& picture, const Frame& frame, const PixelRegion& region) const {
        picture.channels = {{"R"}, {"G"}, {"B"}};
        picture.linear = encoding_ == Encoding::linear;
        std::vector<Sample> samples;
        samples.reserve(3 * static_cast<std::size_t>(region.width()) * static_cast<std::size_t>(region.height()));
        for (int y = region.y0; y < region.y1; ++y)
            for (int x = region.x0; x < region.x1; ++x)
                for (const float value : frame.pixel(Layer::colour, x, y)) samples.push_back(quantise<Sample>(value));
        picture.samples = std::move(samples);
    }

private:
    template <class Sample>
    Sample quantise(float value) const {
        if (!(value > 0)) return 0;  // not a number, too
        const float clipped = std::min(value, 1.0f);
        if (encoding_ == Encoding::linear) return round_to_step<Sample>(clipped);
        if constexpr (sizeof(Sample) == 1) {
            static const SrgbBytes srgb_bytes;
            return srgb_bytes(clipped);
        } else {
            return round_to_step<Sample>(srgb_encode(clipped));
        }
    }

    template <class Sample>
    static Sample round_to_step(double value) {
        return static_cast<Sample>(std::lround(value * std::numeric_limits<Sample>::max()));
    }

    Encoding encoding_ = Encoding::srgb;
};

}  // namespace lapidary
