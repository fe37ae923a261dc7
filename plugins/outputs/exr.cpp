// SPDX-License-Identifier: MIT
//
// exr: linear values without clipping, with any of the renderer's layers beside the colours.
//
// Colours are R, G, B. Depth is Z, as other programs expect; the other layers are groups of channels of their own:
// normal.X, position.Y, object … A half holds whole numbers only up to 2048 and lengths only to three digits, so
// `float(16)` is for colours and normals; everything else is always stored in 32 bits.

#include <lapidary/image_writer.h>
#include <lapidary/plugin.h>

#include <utility>

namespace lapidary {

class Exr final : public ImageWriter {
public:
    static void describe(Schema<Exr>& schema) {
        schema.summary("Writes an OpenEXR file of linear values, with layers.");
        schema.add("bits", &Exr::bits_).help("Of each colour and normal: 16 (half) or 32 (float).");
        schema.require("bits must be 16 or 32", [](const Exr& exr) { return exr.bits_ == 16 || exr.bits_ == 32; });
        schema.add("aov", &Exr::aov_)
            .help("Layers beside the colours: depth, normal, position, object, material, samples, error.");
        schema.require("aov knows the layers depth, normal, position, object, material, samples and error",
                       [](const Exr& exr) { return std::all_of(exr.aov_.begin(), exr.aov_.end(), is_layer); });
    }

    std::vector<std::string> extensions() const override { return {"exr"}; }

    LayerSet layers() const override {
        LayerSet layers;
        for (const Layer layer : asked()) layers.add(layer);
        return layers;
    }

private:
    static constexpr Layer known[] = {Layer::depth,    Layer::normal,  Layer::position, Layer::object,
                                      Layer::material, Layer::samples, Layer::error};

    static bool is_layer(const std::string& word) {
        return std::any_of(std::begin(known), std::end(known), [&](Layer layer) { return name_of(layer) == word; });
    }

    // Each layer once, in a fixed order.
    std::vector<Layer> asked() const {
        std::vector<Layer> layers;
        for (const Layer layer : known)
            if (std::find(aov_.begin(), aov_.end(), name_of(layer)) != aov_.end()) layers.push_back(layer);
        return layers;
    }

    void fill(Picture& picture, const Frame& frame, const PixelRegion& region) const override {
        picture.format = "openexr";
        std::vector<Layer> layers{Layer::colour};
        for (const Layer layer : asked())
            if (frame.has(layer)) layers.push_back(layer);
        for (const Layer layer : layers) add_channels(picture, layer);

        std::vector<float> samples;
        samples.reserve(picture.channels.size() * static_cast<std::size_t>(region.width()) *
                        static_cast<std::size_t>(region.height()));
        for (int y = region.y0; y < region.y1; ++y)
            for (int x = region.x0; x < region.x1; ++x)
                for (const Layer layer : layers)
                    for (const float value : frame.pixel(layer, x, y)) samples.push_back(value);
        picture.samples = std::move(samples);
    }

    void add_channels(Picture& picture, Layer layer) const {
        const std::string name(name_of(layer));
        const bool half = bits_ == 16;
        if (layer == Layer::colour)
            for (const char* channel : {"R", "G", "B"}) picture.channels.push_back({channel, half});
        else if (layer == Layer::depth)
            picture.channels.push_back({"Z", false});
        else if (channels_of(layer) == 3)
            for (const char* axis : {".X", ".Y", ".Z"}) picture.channels.push_back({name + axis, half && layer == Layer::normal});
        else
            picture.channels.push_back({name, false});
    }

    int bits_ = 16;
    std::vector<std::string> aov_;
};

LAPIDARY_PLUGIN(Exr)

}  // namespace lapidary
