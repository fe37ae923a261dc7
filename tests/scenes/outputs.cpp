// SPDX-License-Identifier: MIT
//
// The writers, each through its plugin: what is in the file, down to the last step of its encoding.
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <limits>

#include "kernel/interfaces/output.h"
#include "kernel/registry/registry.h"
#include "lapidary/image_library.h"
#include "lapidary/image_writer.h"
#include "support/catch.h"
#include "support/run.h"
#include "support/temporary_folder.h"

using namespace lapidary;

namespace {

namespace fs = std::filesystem;

constexpr float infinity_ = std::numeric_limits<float>::infinity();
constexpr float nan_ = std::numeric_limits<float>::quiet_NaN();

// A writer with its properties set as a scene would.
class Writer {
public:
    explicit Writer(const std::string& keyword) {
        std::string reason;
        plugin_ = registry_.find(PluginKind::output, keyword, reason);
        INFO(reason);
        REQUIRE(plugin_);
        output_ = plugin_->create_output();
    }
    Writer& set(const std::string& property, const std::vector<Value>& values) {
        const PropertySchema* const schema = plugin_->schema().find(property);
        REQUIRE(schema);
        schema->assign(dynamic_cast<void*>(output_.get()), values);
        plugin_->schema().derive(dynamic_cast<void*>(output_.get()));
        return *this;
    }
    bool fits() const {
        for (const Requirement& requirement : plugin_->schema().requirements())
            if (!requirement.holds(dynamic_cast<const void*>(output_.get()))) return false;
        return true;
    }
    Output& output() { return *output_; }
    void write(const Frame& frame, const FrameInfo& info, const fs::path& file) {
        output_->begin(info);
        output_->finish(frame, info, file);
    }

private:
    Registry registry_{{LAPIDARY_PLUGIN_FOLDER}};
    const Plugin* plugin_ = nullptr;
    std::unique_ptr<Output> output_;
};

FrameInfo whole(const Frame& frame) {
    FrameInfo info;
    info.width = frame.width(), info.height = frame.height();
    info.region = {0, 0, frame.width(), frame.height()};
    info.title = "ramp";
    info.metadata = {{"Software", "Lapidary"}};
    return info;
}

// Colours from below 0 to above 1, no two alike, and one that is not a number.
class Ramp final : public Frame {
public:
    explicit Ramp(int width, int height, LayerSet layers = {}) : Frame(width, height, layers) {
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x)
                for (int c = 0; c < 3; ++c)
                    pixel(Layer::colour, x, y)[static_cast<std::size_t>(c)] =
                        -0.1f +
                        1.3f * static_cast<float>(x + width * (y + height * c)) / static_cast<float>(3 * width * height - 1);
        pixel(Layer::colour, 0, 0)[1] = nan_;
        set_complete(true);
    }
};

// The definition of the encoding, written down a second time.
long expected_step(float linear, long steps) {
    const long double v = linear > 0 ? std::fmin(static_cast<long double>(linear), 1.0L) : 0.0L;
    const long double encoded = v <= 0.0031308L ? 12.92L * v : 1.055L * std::pow(v, 1.0L / 2.4L) - 0.055L;
    return static_cast<long>(std::floor(encoded * static_cast<long double>(steps) + 0.5L));
}

std::vector<std::uint8_t> bytes_of(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

std::uint32_t little_endian(const std::vector<std::uint8_t>& bytes, std::size_t at, int count) {
    std::uint32_t value = 0;
    for (int i = count; i-- > 0;) value = value << 8 | bytes.at(at + static_cast<std::size_t>(i));
    return value;
}

Picture read(const fs::path& file) { return load_image_library()->decode(file); }

float sample(const Picture& picture, const std::string& channel, int x, int y) {
    for (std::size_t c = 0; c < picture.channels.size(); ++c)
        if (picture.channels[c].name == channel)
            return std::get<std::vector<float>>(
                picture.samples)[static_cast<std::size_t>(y * picture.width + x) * picture.channels.size() + c];
    FAIL("there is no channel " << channel);
    return 0;
}

}  // namespace

TEST_CASE("a BMP file holds each colour rounded to the nearest step of the sRGB curve") {
    const TemporaryFolder folder;
    const Ramp frame(31, 17);  // rows of a length that needs filling up
    Writer("bmp").write(frame, whole(frame), folder.path() / "ramp.bmp");

    const auto bytes = bytes_of(folder.path() / "ramp.bmp");
    REQUIRE(bytes.size() > 54);
    CHECK((bytes[0] == 'B' && bytes[1] == 'M'));
    REQUIRE(little_endian(bytes, 18, 4) == 31);
    REQUIRE(little_endian(bytes, 22, 4) == 17);
    REQUIRE(little_endian(bytes, 28, 2) == 24);
    const std::size_t start = little_endian(bytes, 10, 4), row = (31 * 3 + 3) / 4 * 4;
    int wrong = 0;
    for (int y = 0; y < 17; ++y)
        for (int x = 0; x < 31; ++x)
            for (int c = 0; c < 3; ++c)  // rows stand from the bottom, colours from blue
                wrong += bytes.at(start + static_cast<std::size_t>(16 - y) * row + static_cast<std::size_t>(3 * x + 2 - c)) !=
                         expected_step(frame.pixel(Layer::colour, x, y)[static_cast<std::size_t>(c)], 255);
    CHECK(wrong == 0);
}

TEST_CASE("every step of the sRGB curve begins where the formula says") {
    const SrgbBytes bytes;
    int wrong = 0;
    const auto check = [&](float value) { wrong += bytes(value) != expected_step(value, 255); };
    for (int i = 0; i <= 1'000'000; ++i) check(static_cast<float>(i) / 1'000'000);
    for (int step = 1; step <= 255; ++step) {
        // The neighbourhood of each threshold, float by float.
        const double encoded = (step - 0.5) / 255;
        float value = static_cast<float>(srgb_decode(encoded));
        for (int i = 0; i < 20; ++i) value = std::nextafter(value, 0.0f);
        for (int i = 0; i < 40; ++i) check(value = std::nextafter(value, 1.0f));
    }
    CHECK(wrong == 0);
}

TEST_CASE("a TGA file holds 24 bits a pixel") {
    const TemporaryFolder folder;
    const Ramp frame(8, 4);
    Writer("tga").write(frame, whole(frame), folder.path() / "ramp.tga");
    const auto bytes = bytes_of(folder.path() / "ramp.tga");
    CHECK(little_endian(bytes, 12, 2) == 8);
    CHECK(little_endian(bytes, 14, 2) == 4);
    CHECK(bytes.at(16) == 24);
    const Picture picture = read(folder.path() / "ramp.tga");
    CHECK(sample(picture, "G", 5, 2) == Approx(expected_step(frame.pixel(Layer::colour, 5, 2)[1], 255) / 255.0));
}

TEST_CASE("a PNG file of 8 or 16 bits is exact to the step") {
    const TemporaryFolder folder;
    const Ramp frame(64, 48);
    const auto [bits, steps] = GENERATE(std::pair{8, 255L}, std::pair{16, 65535L});
    Writer("png").set("bits", {number_value(bits)}).write(frame, whole(frame), folder.path() / "ramp.png");
    const Picture picture = read(folder.path() / "ramp.png");
    REQUIRE((picture.width == 64 && picture.height == 48 && picture.channels.size() == 3));
    int wrong = 0;
    for (int y = 0; y < 48; ++y)
        for (int x = 0; x < 64; ++x)
            for (int c = 0; c < 3; ++c) {
                const float stored = sample(picture, std::string(1, "RGB"[c]), x, y);
                wrong += std::lround(static_cast<double>(stored) * static_cast<double>(steps)) !=
                         expected_step(frame.pixel(Layer::colour, x, y)[static_cast<std::size_t>(c)], steps);
            }
    CHECK(wrong == 0);
}

TEST_CASE("encoding(linear) writes the values as they are") {
    const TemporaryFolder folder;
    const Ramp frame(16, 16);
    Writer("bmp").set("encoding", {word_value("linear")}).write(frame, whole(frame), folder.path() / "ramp.bmp");
    const Picture picture = read(folder.path() / "ramp.bmp");
    CHECK(sample(picture, "R", 9, 6) == Approx(std::round(255 * frame.pixel(Layer::colour, 9, 6)[0]) / 255));
}

TEST_CASE("a JPEG file comes close, and closer with more quality") {
    const TemporaryFolder folder;
    const Ramp frame(64, 64);
    const auto error_at = [&](int quality) {
        Writer("jpeg").set("quality", {number_value(quality)}).write(frame, whole(frame), folder.path() / "ramp.jpg");
        const Picture picture = read(folder.path() / "ramp.jpg");
        double sum = 0;
        for (int i = 1; i < 64; ++i) {
            const double wanted = static_cast<double>(expected_step(frame.pixel(Layer::colour, i, i)[0], 255)) / 255;
            sum += std::abs(static_cast<double>(sample(picture, "R", i, i)) - wanted);
        }
        return sum / 63;
    };
    const double coarse = error_at(5), fine = error_at(98);
    CHECK(fine < 0.02);
    CHECK(fine < coarse);
}

TEST_CASE("an EXR file keeps every value and names its layers") {
    const TemporaryFolder folder;
    Writer writer("exr");
    writer.set("bits", {number_value(32)}).set("aov", {word_value("object"), word_value("depth"), word_value("normal")});
    CHECK(writer.output().layers().has(Layer::depth));
    CHECK_FALSE(writer.output().layers().has(Layer::position));

    Ramp frame(20, 10, writer.output().layers());
    frame.pixel(Layer::depth, 3, 4)[0] = infinity_;
    frame.pixel(Layer::object, 3, 4)[0] = 1234567;
    frame.pixel(Layer::normal, 3, 4)[1] = -1;
    writer.write(frame, whole(frame), folder.path() / "ramp.exr");

    const Picture picture = read(folder.path() / "ramp.exr");
    CHECK(picture.channels.size() == 8);
    CHECK(sample(picture, "Z", 3, 4) == infinity_);
    CHECK(sample(picture, "object", 3, 4) == 1234567);
    CHECK(sample(picture, "normal.Y", 3, 4) == -1);
    CHECK(std::isnan(sample(picture, "G", 0, 0)));
    int wrong = 0;
    for (int y = 0; y < 10; ++y)
        for (int x = 0; x < 20; ++x) wrong += sample(picture, "B", x, y) != frame.pixel(Layer::colour, x, y)[2];
    CHECK(wrong == 0);
}

TEST_CASE("an EXR file tells what a picture cost, pixel by pixel, and how far each may be off") {
    const TemporaryFolder folder;
    const fs::path scene = folder.path() / "edge.scene", file = folder.path() / "edge.exr";
    std::ofstream(scene) << "output { resolution(48, 36); exr { aov(samples, error); } } background(0.1, 0.2, 0.3);\n"
                            "render { error(0.01); filter(\"gaussian\"); } camera { location(0, 0, -4); }\n"
                            "lights { ambient { } point { location(-3, 4, -4); intensity(30); } } objects { sphere { } }\n";
    const RunResult result = run(fmt::format("cd {} && {} -v -w edge.scene", quoted(folder.path()), quoted(LAPIDARY_PROGRAM)));
    INFO(result.output);
    REQUIRE(result.exit_code == 0);

    const Picture picture = read(file);
    long samples = 0;
    int within = 0, most_doubled = 0;
    for (int y = 0; y < 36; ++y)
        for (int x = 0; x < 48; ++x) {
            const float taken = sample(picture, "samples", x, y), error = sample(picture, "error", x, y);
            REQUIRE(std::has_single_bit(static_cast<unsigned>(taken)));
            REQUIRE(error >= 0);
            samples += static_cast<long>(taken);
            within += error <= 0.01f;
            most_doubled = std::max(most_doubled, static_cast<int>(taken));
        }
    // The corner shows the background; the ball's edge takes more than its middle.
    CHECK(sample(picture, "error", 0, 0) == 0);
    CHECK(sample(picture, "samples", 0, 0) == 2);
    CHECK(most_doubled >= 8);
    CHECK(result.output.find(fmt::format("{} samples,", samples)) != std::string::npos);
    CHECK(within == 48 * 36);
    CHECK(result.output.find("100 % within an error of 0.01") != std::string::npos);
}

TEST_CASE("a half EXR keeps whole numbers and lengths in 32 bits") {
    const TemporaryFolder folder;
    Writer writer("exr");
    writer.set("aov", {word_value("depth"), word_value("object")});
    Ramp frame(4, 4, writer.output().layers());
    frame.pixel(Layer::depth, 1, 1)[0] = 70000.125f;  // beyond the largest half
    frame.pixel(Layer::object, 1, 1)[0] = 2049;       // between two halves
    writer.write(frame, whole(frame), folder.path() / "ramp.exr");
    const Picture picture = read(folder.path() / "ramp.exr");
    CHECK(sample(picture, "Z", 1, 1) == 70000.125f);
    CHECK(sample(picture, "object", 1, 1) == 2049);
    CHECK(sample(picture, "R", 2, 2) == Approx(frame.pixel(Layer::colour, 2, 2)[0]).epsilon(1e-3));
    CHECK(sample(picture, "R", 2, 2) != frame.pixel(Layer::colour, 2, 2)[0]);
}

TEST_CASE("a region becomes a file of its own size and says where it lies") {
    const TemporaryFolder folder;
    const Ramp frame(40, 30);
    FrameInfo info = whole(frame);
    info.region = {10, 5, 17, 9};
    for (const std::string format : {"png", "bmp", "tga", "jpeg", "exr"}) {
        INFO(format);
        const fs::path file = folder.path() / ("part." + format);
        Writer(format).write(frame, info, file);
        const Picture picture = read(file);
        CHECK((picture.width == 7 && picture.height == 4));
        if (format == "jpeg") continue;
        const float value = frame.pixel(Layer::colour, 16, 8)[2];
        const double wanted = format == "exr" ? static_cast<double>(value) : static_cast<double>(expected_step(value, 255)) / 255;
        CHECK(sample(picture, "B", 6, 3) == Approx(wanted).epsilon(1e-3));
    }
    const Picture exr = read(folder.path() / "part.exr");
    CHECK((exr.x == 10 && exr.y == 5 && exr.full_width == 40 && exr.full_height == 30));
}

TEST_CASE("the metadata tell the program, the region and whether the picture is complete") {
    const TemporaryFolder folder;
    Ramp frame(40, 30);
    frame.set_complete(false);
    frame.count_finished(7);
    FrameInfo info = whole(frame);
    info.region = {10, 5, 17, 9};
    for (const std::string format : {"png", "jpeg", "exr"}) {
        INFO(format);
        const fs::path file = folder.path() / ("part." + format);
        Writer(format).write(frame, info, file);
        auto texts = read(file).texts;
        CHECK(texts["Software"] == "Lapidary");
        CHECK(texts["ImageDescription"] == "ramp; 10,5,17,9 of 40x30; interrupted after 7 of 28 pixels");
    }
    frame.set_complete(true);
    Writer("png").write(frame, whole(frame), folder.path() / "whole.png");
    CHECK(read(folder.path() / "whole.png").texts["ImageDescription"] == "ramp; complete");
}

TEST_CASE("bits and layers that do not exist are refused by a sentence") {
    CHECK(Writer("png").fits());
    CHECK_FALSE(Writer("png").set("bits", {number_value(12)}).fits());
    CHECK_FALSE(Writer("exr").set("bits", {number_value(8)}).fits());
    CHECK(Writer("exr").set("aov", {word_value("samples")}).fits());
    CHECK_FALSE(Writer("exr").set("aov", {word_value("dephts")}).fits());
}

TEST_CASE("a file that cannot be written is an exception with the system's reason") {
    const Ramp frame(4, 4);
    CHECK_THROWS_WITH(Writer("png").write(frame, whole(frame), "/dev/null/ramp.png"), "Not a directory");
    CHECK_THROWS_WITH(Writer("bmp").write(frame, whole(frame), "/dev/full"), "No space left on device");
}

TEST_CASE("opening a writer does not load the library of image formats") {
    const auto loaded = [] {
        std::ifstream maps("/proc/self/maps");
        return std::string(std::istreambuf_iterator<char>(maps), {}).find("libOpenImageIO") != std::string::npos;
    };
    if (loaded()) return;  // another test of this process was here before
    const Writer writer("png");
    CHECK_FALSE(loaded());
}
