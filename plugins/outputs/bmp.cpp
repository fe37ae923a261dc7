// SPDX-License-Identifier: MIT
//
// bmp: a Windows bitmap, 24 bits a pixel, uncompressed.

#include <lapidary/image_writer.h>
#include <lapidary/plugin.h>

namespace lapidary {

class Bmp final : public IntegerWriter {
public:
    static void describe(Schema<Bmp>& schema) {
        schema.summary("Writes a Windows bitmap of 24 bits a pixel.");
        describe_encoding(schema);
    }

    std::vector<std::string> extensions() const override { return {"bmp"}; }

private:
    void fill(Picture& picture, const Frame& frame, const PixelRegion& region) const override {
        picture.format = "bmp";
        fill_samples<std::uint8_t>(picture, frame, region);
    }
};

LAPIDARY_PLUGIN(Bmp)

}  // namespace lapidary
