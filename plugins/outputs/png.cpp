// SPDX-License-Identifier: MIT
//
// png: a lossless picture of 8 or 16 bits a colour.

#include <lapidary/image_writer.h>
#include <lapidary/plugin.h>

namespace lapidary {

class Png final : public IntegerWriter {
public:
    static void describe(Schema<Png>& schema) {
        schema.summary("Writes a PNG file.");
        schema.add("bits", &Png::bits_).help("Of each colour of a pixel: 8 or 16.");
        schema.require("bits must be 8 or 16", [](const Png& png) { return png.bits_ == 8 || png.bits_ == 16; });
        describe_encoding(schema);
    }

    std::vector<std::string> extensions() const override { return {"png"}; }

private:
    void fill(Picture& picture, const Frame& frame, const PixelRegion& region) const override {
        picture.format = "png";
        if (bits_ == 16)
            fill_samples<std::uint16_t>(picture, frame, region);
        else
            fill_samples<std::uint8_t>(picture, frame, region);
    }

    int bits_ = 8;
};

LAPIDARY_PLUGIN(Png)

}  // namespace lapidary
