// SPDX-License-Identifier: MIT
//
// tga: a Truevision Targa file, 24 bits a pixel.

#include <lapidary/image_writer.h>
#include <lapidary/plugin.h>

namespace lapidary {

class Tga final : public IntegerWriter {
public:
    static void describe(Schema<Tga>& schema) {
        schema.summary("Writes a Targa file of 24 bits a pixel.");
        describe_encoding(schema);
    }

    std::vector<std::string> extensions() const override { return {"tga"}; }

private:
    void fill(Picture& picture, const Frame& frame, const PixelRegion& region) const override {
        picture.format = "targa";
        fill_samples<std::uint8_t>(picture, frame, region);
    }
};

LAPIDARY_PLUGIN(Tga)

}  // namespace lapidary
