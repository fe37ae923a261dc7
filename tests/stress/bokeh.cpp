// SPDX-License-Identifier: MIT
//
// What a lens makes of a small bright disc that faces it: an even, round patch, of the size that the lens and the distances say,
// and with all of the disc's light (T87, seen in pictures).
//
// A place p of the picture, at distance 1, sees through the place o on the lens what lies at depth z and aside by
// p z + o (1 - z/f). Of a disc of radius s on the axis the picture is therefore the disc of radius s/z, spread over one of the
// radius a |1/z - 1/f| for a lens of radius a. Spreading keeps what is summed over the picture; the mean squares of the
// distance from the axis add up.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "kernel/prepare/world.h"
#include "kernel/render/render.h"
#include "support/catch.h"
#include "support/scenes.h"

namespace lapidary::test {
namespace {

constexpr int width = 44, height = 40;
constexpr double pixel = 0.0015;  // its size in the picture at distance 1

struct Setting {
    double aperture, focus, depth, size;
    int points, samples;

    double image() const { return size / depth; }
    double blur() const { return aperture / 2 * std::fabs(1 / depth - 1 / focus); }
};

class Patch {
public:
    explicit Patch(const Setting& setting) : frame_(width, height, {}) {
        const auto built = build(fmt::format(
            "camera {{ focus({}); aperture({}); points({}); screen {{ size({}, {}); }} }} lights {{ ambient {{ intensity(1); }} "
            "}}\n"
            "objects {{ cylinder {{ radius({}); height(1e-6); transform {{ rotx(90deg); translate(0, 0, {}); }} }} }}",
            setting.focus, setting.aperture, setting.points, pixel * width, pixel * height, setting.size, setting.depth));
        for (const std::string& headline : built->headlines()) UNSCOPED_INFO(headline);
        REQUIRE(built->scene);
        const auto world = prepare_world(*built->scene, built->messages);
        RenderOptions options;
        options.samples = setting.samples;
        REQUIRE(render(*world, *built->scene, frame_, options).complete);
    }

    // Calls visit(x, y, brightness), the place from the middle, in units of the picture at distance 1.
    template <typename Visit>
    void for_each_pixel(Visit&& visit) const {
        for (int j = 0; j < height; ++j)
            for (int i = 0; i < width; ++i)
                visit((i + 0.5 - width / 2.0) * pixel, (height / 2.0 - j - 0.5) * pixel, frame_.pixel(Layer::colour, i, j)[1]);
    }

    // The integral over the picture of brightness times f(x, y).
    template <typename Function>
    double integral(Function&& f) const {
        double sum = 0;
        for_each_pixel([&](double x, double y, double brightness) { sum += f(x, y) * brightness * pixel * pixel; });
        return sum;
    }

private:
    Frame frame_;
};

struct Mean {
    double sum = 0;
    int count = 0;
    void add(double value) { sum += value, ++count; }
    double value() const { return sum / count; }
};

// Before the sharp plane, behind it, in it, through no lens at all, and through places on the lens that were chosen beforehand.
const std::vector<Setting> settings{{0.4, 10, 5, 0.02, 0, 1024}, {0.4, 10, 20, 0.08, 0, 1024}, {0.4, 10, 10, 0.1, 0, 256},
                                    {0.0, 10, 5, 0.05, 0, 256},  {0.4, 10, 5, 0.05, 64, 256},  {0.4, 1e6, 12, 0.05, 0, 1024}};

}  // namespace

TEST_CASE("T87: a lens spreads light over the picture, and loses none") {
    for (const Setting& setting : settings) {
        CAPTURE(setting.aperture, setting.focus, setting.depth, setting.points);
        const Patch patch(setting);
        const double light = patch.integral([](double, double) { return 1; });
        CHECK(light == Approx(std::numbers::pi * setting.image() * setting.image()).epsilon(0.01));
        // About the middle, as wide as the closed form says, and as high as wide. Taking pixels for points adds a sixth of one.
        const double square = (setting.image() * setting.image() + setting.blur() * setting.blur()) / 2 + pixel * pixel / 6;
        const double right = patch.integral([](double x, double) { return x; }) / light;
        const double up = patch.integral([](double, double y) { return y; }) / light;
        const double across = patch.integral([](double x, double) { return x * x; }) / light;
        const double upright = patch.integral([](double, double y) { return y * y; }) / light;
        const double aslant = patch.integral([](double x, double y) { return x * y; }) / light;
        CHECK(std::hypot(right, up) < 0.02 * std::sqrt(square));
        CHECK(across == Approx(square / 2).epsilon(0.02));
        CHECK(upright == Approx(square / 2).epsilon(0.02));
        CHECK(std::fabs(aslant) < 0.02 * square);
    }
}

TEST_CASE("T87: what is out of focus becomes an even, round patch") {
    for (const Setting& setting : settings) {
        if (setting.points > 0 || setting.blur() < 2 * setting.image()) continue;
        CAPTURE(setting.aperture, setting.focus, setting.depth);
        const double edge = std::numbers::sqrt2 / 2 * pixel;  // a pixel's corners lie as far from its middle
        const double even = setting.blur() - setting.image() - edge, dark = setting.blur() + setting.image() + edge;
        REQUIRE(dark < std::min(width, height) * pixel / 2);

        constexpr std::size_t rings = 4, sectors = 8;
        std::vector<Mean> ring(rings), sector(sectors);
        double beyond = 0;
        Patch(setting).for_each_pixel([&](double x, double y, double brightness) {
            const double r = std::hypot(x, y) / even, turn = std::atan2(y, x) / (2 * std::numbers::pi) + 0.5;
            if (r < 1) {
                ring[static_cast<std::size_t>(r * r * rings)].add(brightness);
                sector[static_cast<std::size_t>(turn * sectors) % sectors].add(brightness);
            } else if (std::hypot(x, y) > dark) {
                beyond += brightness;
            }
        });
        const double expected = std::pow(setting.image() / setting.blur(), 2);
        for (const std::vector<Mean>& parts : {ring, sector})
            for (const Mean& part : parts) CHECK(part.value() == Approx(expected).epsilon(0.04));
        CHECK(beyond == 0);
    }
}

}  // namespace lapidary::test
