// SPDX-License-Identifier: MIT
//
// Image files by OpenImageIO. Files are encoded in memory: what goes wrong with the disk is then found by the one
// place that writes bytes, not by every format's own code.

#include <lapidary/image_library.h>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <span>
#include <type_traits>

namespace lapidary {

namespace {

OIIO::ImageSpec specification(const Picture& picture, OIIO::TypeDesc type, bool knows_larger_pictures) {
    OIIO::ImageSpec spec(picture.width, picture.height, static_cast<int>(picture.channels.size()), type);
    if (knows_larger_pictures) {
        spec.x = picture.x, spec.y = picture.y;
        spec.full_width = picture.full_width, spec.full_height = picture.full_height;
    }
    for (std::size_t i = 0; i < picture.channels.size(); ++i) {
        const Picture::Channel& channel = picture.channels[i];
        spec.channelnames[i] = channel.name;
        if (type == OIIO::TypeDesc::FLOAT)
            spec.channelformats.push_back(channel.half ? OIIO::TypeDesc::HALF : OIIO::TypeDesc::FLOAT);
    }
    spec.attribute("oiio:ColorSpace", picture.linear ? "Linear" : "sRGB");
    for (const auto& [key, text] : picture.texts) spec.attribute(key, text);
    if (const auto quality = picture.settings.find("quality"); quality != picture.settings.end()) {
        spec.attribute("Compression", "jpeg:" + std::to_string(quality->second));
        spec.attribute("jpeg:subsampling", "4:4:4");  // a rendered edge is sharp in its colours, too
    }
    return spec;
}

// The library keeps its errors per object and, where there is no object, per thread.
std::string reason_of(const std::string& error) { return error.empty() ? OIIO::geterror() : error; }

class OpenImageLibrary final : public ImageLibrary {
public:
    std::vector<std::byte> encode(const Picture& picture) const override {
        const auto output = OIIO::ImageOutput::create(picture.format);
        if (!output) throw std::runtime_error("OpenImageIO cannot write " + picture.format + " files: " + reason_of(""));
        OIIO::Filesystem::IOVecOutput memory;
        if (!output->set_ioproxy(&memory))
            throw std::runtime_error("OpenImageIO cannot write " + picture.format + " into memory");

        const auto write = [&](const auto& samples) {
            using Sample = typename std::remove_cvref_t<decltype(samples)>::value_type;
            const OIIO::TypeDesc type = OIIO::BaseTypeFromC<Sample>::value;
            // The name is not used for a file, but its extension says which format is meant.
            return output->open("picture." + picture.format, specification(picture, type, output->supports("displaywindow"))) &&
                   output->write_image(type, samples.data()) && output->close();
        };
        if (!std::visit(write, picture.samples))
            throw std::runtime_error("OpenImageIO cannot write the picture: " + reason_of(output->geterror()));
        const auto bytes = std::as_bytes(std::span(memory.buffer()));
        return {bytes.begin(), bytes.end()};
    }

    Picture decode(const std::filesystem::path& file) const override {
        const auto input = OIIO::ImageInput::open(file.string());
        if (!input) throw std::runtime_error(file.string() + " cannot be read: " + reason_of(""));
        const OIIO::ImageSpec& spec = input->spec();
        Picture picture;
        picture.format = input->format_name();
        picture.width = spec.width, picture.height = spec.height;
        picture.x = spec.x, picture.y = spec.y;
        picture.full_width = spec.full_width, picture.full_height = spec.full_height;
        for (const std::string& name : spec.channelnames) picture.channels.push_back({name});
        for (const auto& attribute : spec.extra_attribs)
            if (attribute.type() == OIIO::TypeDesc::STRING) picture.texts[attribute.name().string()] = attribute.get_string();
        picture.linear = spec.format.is_floating_point();
        std::vector<float> samples(spec.image_pixels() * static_cast<std::size_t>(spec.nchannels));
        if (!input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, samples.data()))
            throw std::runtime_error(file.string() + " cannot be read: " + reason_of(input->geterror()));
        picture.samples = std::move(samples);
        return picture;
    }
};

}  // namespace

}  // namespace lapidary

extern "C" LAPIDARY_API const lapidary::ImageLibrary* lapidary_image_library() {
    static const lapidary::OpenImageLibrary library;
    return &library;
}
