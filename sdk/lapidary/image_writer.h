// SPDX-License-Identifier: MIT
//
// What writers of image files share. A writer says which formats it knows and makes a Picture of the finished frame;
// loading the image library in the background, cropping, encoding, metadata and writing are done here.
//
// A region of a picture becomes a file of the region's size; where the format knows of larger pictures (EXR's display
// window), it keeps its place there. Pixels that an interruption left out are black, and the metadata say so.
#pragma once

#include <algorithm>
#include <cmath>
#include <filesystem>
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
    void begin(const FrameInfo&) override { library_ = open_image_library(); }

    void finish(const Frame& frame, const FrameInfo& info, const std::filesystem::path& file) override {
        if (!library_.valid()) library_ = open_image_library();
        Picture picture = outline(frame, info);
        fill(picture, frame, info.region);
        save_bytes(library_.get()->encode(picture), file);
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

    std::shared_future<const ImageLibrary*> library_;
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
                for (float value : frame.pixel(Layer::colour, x, y)) samples.push_back(quantise<Sample>(value));
        picture.samples = std::move(samples);
    }

private:
    template <class Sample>
    Sample quantise(double value) const {
        if (!(value > 0)) return 0;  // not a number, too
        const double clipped = std::min(value, 1.0);
        const double encoded = encoding_ == Encoding::srgb ? srgb_encode(clipped) : clipped;
        return static_cast<Sample>(std::lround(encoded * std::numeric_limits<Sample>::max()));
    }

    Encoding encoding_ = Encoding::srgb;
};

}  // namespace lapidary
