// SPDX-License-Identifier: MIT
//
// jpeg: a small file that is close to the picture.

#include <lapidary/image_writer.h>
#include <lapidary/plugin.h>

namespace lapidary {

class Jpeg final : public IntegerWriter {
public:
    static void describe(Schema<Jpeg>& schema) {
        schema.summary("Writes a JPEG file.");
        schema.add("quality", &Jpeg::quality_).between(1, 100).help("From 1 (smallest file) to 100 (closest to the picture).");
        describe_encoding(schema);
    }

    std::vector<std::string> extensions() const override { return {"jpg", "jpeg"}; }

private:
    void fill(Picture& picture, const Frame& frame, const PixelRegion& region) const override {
        picture.format = "jpeg";
        picture.settings["quality"] = quality_;
        fill_samples<std::uint8_t>(picture, frame, region);
    }

    int quality_ = 90;
};

LAPIDARY_PLUGIN(Jpeg)

}  // namespace lapidary
