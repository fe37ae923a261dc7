// SPDX-License-Identifier: MIT
//
// The pictures of scenes/precision, pixel by pixel against their closed forms, at other sizes and far from the world's origin,
// too.
#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "kernel/prepare/world.h"
#include "kernel/render/camera_rays.h"
#include "kernel/render/tracer.h"
#include "stress/exact_pictures.h"
#include "support/catch.h"
#include "support/measurement.h"
#include "support/scenes.h"

namespace lapidary::test {
namespace {

std::string text_of(const std::string& scene) {
    std::ifstream file(std::filesystem::path(LAPIDARY_SOURCE_FOLDER) / "scenes/precision" / (scene + ".scene"));
    REQUIRE(file);
    return {std::istreambuf_iterator<char>(file), {}};
}

// The text with another value in `let name = value;`.
std::string with(std::string text, const std::string& name, const std::string& value) {
    const std::size_t begin = text.find("let " + name + " = ");
    REQUIRE(begin != std::string::npos);
    return text.replace(begin, text.find(';', begin) - begin, "let " + name + " = " + value);
}

// Nothing where it is none of the scenes' colours.
std::optional<Shown> shown_by(const Colour& colour) {
    if (colour == Colour{0.15, 0.18, 0.22}) return Shown::background;
    if (colour == Colour{0.9, 0.65, 0.25}) return Shown::first;
    if (colour == Colour{0.2, 0.4, 0.7}) return Shown::second;
    return {};
}

class Picture {
public:
    Picture(const std::string& text, int width, int height) {
        const auto built = build(text);
        REQUIRE(built->headlines() == std::vector<std::string>{});
        const auto world = prepare_world(*built->scene, built->messages);
        REQUIRE(built->headlines() == std::vector<std::string>{});
        const CameraRays camera(built->scene->camera, width, height);
        std::vector<Ray> rays;
        for (int row = 0; row < height; ++row)
            for (int column = 0; column < width; ++column) rays.push_back(camera.ray(column + 0.5, row + 0.5));
        std::vector<RaySample> samples(rays.size());
        Tracer(*world, built->scene->render, camera.pixel_footprint()).trace(rays, samples);
        for (const RaySample& sample : samples) shown_.push_back(shown_by(sample.colour));
    }

    const std::vector<std::optional<Shown>>& shown() const { return shown_; }

private:
    std::vector<std::optional<Shown>> shown_;
};

struct Case {
    const char *scene, *what, *size, *away;
};

void check_pictures(int width, int height) {
    for (const Case& c :
         {Case{"flush", "box minus flush cylinder", "1", "0"}, Case{"flush", "the same of size 1e-6", "1e-6", "0"},
          Case{"flush", "the same of size 1e6", "1e6", "0"}, Case{"flush", "the same at 1e8", "1", "1e8"},
          Case{"abutting", "abutting boxes, cut along their face", "", ""}, Case{"speck", "ball of 1e-6 seen from 1", "", ""}}) {
        std::string text = text_of(c.scene);
        if (*c.size) text = with(with(text, "size", c.size), "away", c.away);
        Measurement pixels({"pictures", c.what, "", 0});
        const Picture ours = pixels.timed([&] { return Picture(text, width, height); }, static_cast<std::size_t>(width * height));
        const ExactPicture truth(c.scene, width, height);
        int excused = 0;
        for (int row = 0; row < height; ++row)
            for (int column = 0; column < width; ++column) {
                const auto shown = truth.at(column, row);
                if (shown)
                    pixels.expect(ours.shown()[static_cast<std::size_t>(row * width + column)] == *shown);
                else
                    ++excused;
            }
        CAPTURE(c.what, excused);
        CHECK(excused <= width * height / 1000);
    }
}

}  // namespace

TEST_CASE("flush faces, abutting boxes and a speck show what they are, at any size and place") { check_pictures(64, 48); }
TEST_CASE("flush faces, abutting boxes and a speck in pictures of 640 by 480", "[.long]") { check_pictures(640, 480); }

TEST_CASE("a picture is the same at any size and place") {
    const std::string text = text_of("flush");
    const Picture original(text, 320, 240);
    Measurement same({"pictures", "equal to the picture of size 1", "", 0});
    for (const auto& [size, away] : {std::pair{"1e-6", "0"}, std::pair{"1e6", "0"}, std::pair{"1", "1e8"}})
        same.expect(Picture(with(with(text, "size", size), "away", away), 320, 240).shown() == original.shown());
}

}  // namespace lapidary::test
