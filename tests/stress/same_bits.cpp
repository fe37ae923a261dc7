// SPDX-License-Identifier: MIT
//
// T95: a picture has the same bits whatever arithmetic the program around it has set for itself, for any number of threads, in
// whatever pieces and order it is rendered, and from any compiler at any level of optimisation. T96: the compiler does what is
// written, on which all else stands.
#include <fmt/format.h>

#include <algorithm>
#include <cfenv>
#include <cmath>
#include <cstdint>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "kernel/prepare/world.h"
#include "kernel/render/render.h"
#include "stress/exact.h"
#include "support/fingerprint.h"
#include "support/measurement.h"
#include "support/scenes.h"
#include "support/solids.h"
#include "support/traced_scene.h"

namespace lapidary::test {
namespace {

// The arithmetic of the calling thread while it lives.
class OtherArithmetic {
public:
    OtherArithmetic(int rounding, bool flushes) {
        std::fegetenv(&before_);
        std::fesetround(rounding);
#ifdef __SSE2__
        // Flush to zero, and denormals are zero.
        if (flushes) __builtin_ia32_ldmxcsr(__builtin_ia32_stmxcsr() | 0x8040);
#else
        static_cast<void>(flushes);
#endif
    }
    ~OtherArithmetic() { std::fesetenv(&before_); }
    OtherArithmetic(const OtherArithmetic&) = delete;
    OtherArithmetic& operator=(const OtherArithmetic&) = delete;

private:
    std::fenv_t before_{};
};

// Coincident faces, mirrors, glass and textures. Where it is tiny, parts of squared lengths are denormal; where it is tinier
// still they overflow or vanish: what is to be seen then is little, but it is the same, and there is an end to it.
std::string picture_scene(double size) {
    return fmt::format(R"(
camera {{ location({0}, {1}, {2}); look_at(0, 0, 0); angle(50deg); }}
lights {{ ambient {{ }} direct {{ direction(1, -2, 1.5); }} }}
objects {{ union {{
    subtraction {{ cube {{ }} cylinder {{ height(2); radius(0.6); }} }}
    cube {{ colour(1, 0.3, 0.1); transform {{ translate(2, 0, 0); }} }}
    sphere {{ {3} transform {{ translate(0.3, 1.2, -1.6); scale(0.8); rotate(1, 2, 3, 0.7); }} }}
    torus {{ radii(1.2, 0.3); material {{ noise {{ solid {{ colour(1, 0, 0); }} solid {{ reflection(0.5); }} value(0.5); transform {{ scale(0.2); }} }} }}
             transform {{ translate(-1, -0.5, -1.5); }} }}
    cone {{ transform {{ rotx(0.1); translate(-2.5, 0.1, 0.3); }} }}
    transform {{ scale({4}); }} }} }}
)",
                       2.1 * size, 3.3 * size, -5.7 * size, glass(1.5), size);
}

constexpr std::array compared{Layer::colour, Layer::depth, Layer::normal, Layer::position, Layer::object, Layer::material};

class Picture {
public:
    Picture(const std::string& text, int width, int height) : built_(build(text)), width_(width), height_(height) {
        for (const std::string& headline : built_->headlines()) UNSCOPED_INFO(headline);
        REQUIRE(built_->scene);
        world_ = prepare_world(*built_->scene, built_->messages);
    }

    std::unique_ptr<Frame> render(const RenderOptions& options) const {
        const LayerSet layers{Layer::depth, Layer::normal, Layer::position, Layer::object, Layer::material, Layer::error};
        auto frame = std::make_unique<Frame>(width_, height_, layers);
        CHECK(lapidary::render(*world_, *built_->scene, *frame, options).complete);
        return frame;
    }

private:
    std::unique_ptr<BuiltScene> built_;
    std::shared_ptr<const World> world_;
    int width_, height_;
};

// The bits of the pixels of a region.
std::uint64_t fingerprint_of(const Frame& frame, const PixelRegion& region) {
    Fingerprint fingerprint;
    for (const Layer layer : compared)
        for (int y = region.y0; y < region.y1; ++y)
            for (const float value : frame.row(layer, region.x0, region.x1, y)) fingerprint.add(value);
    return fingerprint.value();
}

std::uint64_t fingerprint_of_picture(const std::string& text, int threads) {
    RenderOptions options;
    options.threads = threads;
    options.error = 0.05;
    return fingerprint_of(*Picture(text, 90, 70).render(options), {0, 0, 90, 70});
}

// A picture cut along a grid of cells of that size whose lines do not begin at its corner; in no order.
std::vector<PixelRegion> cut(int width, int height, int cell_width, int cell_height, std::mt19937_64& random) {
    std::vector<PixelRegion> regions;
    for (int y = -cell_height / 3; y < height; y += cell_height)
        for (int x = -cell_width / 2; x < width; x += cell_width) {
            const PixelRegion region{std::max(x, 0), std::max(y, 0), std::min(x + cell_width, width),
                                     std::min(y + cell_height, height)};
            if (region.x0 < region.x1 && region.y0 < region.y1) regions.push_back(region);
        }
    std::shuffle(regions.begin(), regions.end(), random);
    return regions;
}

}  // namespace

TEST_CASE("T95: a picture has the same bits whatever arithmetic the program has set, for any number of threads") {
    struct Setting {
        int rounding;
        bool flushes;
    };
    Measurement same({"T95", "pictures under other arithmetic", "", 0});
    for (const double size : {1.0, 1e-150, 1e-156}) {
        const std::string text = picture_scene(size);
        const std::uint64_t expected = fingerprint_of_picture(text, 1);
        for (const Setting& setting :
             {Setting{FE_TONEAREST, false}, {FE_TONEAREST, true}, {FE_UPWARD, false}, {FE_DOWNWARD, true}})
            for (const int threads : {1, 3}) {
                const OtherArithmetic other(setting.rounding, setting.flushes);
                same.expect(fingerprint_of_picture(text, threads) == expected);
                CHECK(std::fegetround() == setting.rounding);
            }
    }
}

TEST_CASE("T95: a picture has the same bits in whatever regions and order it is rendered") {
    // The tiles of a region begin at its corner: each cut makes others, of any size, and takes them in another order.
    constexpr int width = 45, height = 35;
    const Picture picture(picture_scene(1), width, height);
    const bool is_adaptive = GENERATE(false, true);
    RenderOptions options;
    options.threads = 1;
    if (is_adaptive) options.error = 0.05;
    if (!is_adaptive) options.samples = 3;
    const std::unique_ptr<Frame> whole = picture.render(options);
    std::mt19937_64 random(95);
    Measurement same({"T95", is_adaptive ? "regions, to an error asked for" : "regions, of three samples a pixel", "", 0});
    for (const auto& [cell_width, cell_height] : {std::pair(7, 5), {16, 11}, {width, 4}, {3, height}, {33, 32}})
        for (const int threads : {1, 3}) {
            options.threads = threads;
            for (const PixelRegion& region : cut(width, height, cell_width, cell_height, random)) {
                options.region = region;
                same.expect(fingerprint_of(*picture.render(options), region) == fingerprint_of(*whole, region));
            }
        }
}

TEST_CASE("T95: rays have the same bits from every compiler") {
    // Nothing here calls a function of the mathematical library other than those that are rounded correctly everywhere.
    TracedScene scene(
        "render { depth(6); } background(0.1, 0.2, 0.3); lights { ambient { } point { location(-3, 6, -4); intensity(40); } "
        "direct { direction(1, -2, 1); } } objects { halfspace { material { solid { reflection(0.3); } } "
        "transform { translate(0, -1, 0); } } subtraction { intersection { cube { } sphere { radius(1.4); } } "
        "sphere { radius(0.4); colour(0, 0, 0); transform { translate(0, 1.1, 0); } } cylinder { radius(0.3); } "
        "transform { rotate(1, 2, 3, 0.7); } } cube { colour(1, 0, 0); transform { scale(0.5); translate(2, -0.5, 0); } } "
        "cube { colour(0, 1, 0); transform { scale(0.5); translate(3, -0.5, 0); } } "
        "cone { transform { shear(0.1, 0, 0, 0, 0, 0.2); translate(-2.5, 0, 1); } } "
        "sphere { " +
        glass(1.5) + "transform { scale(1, 0.5, 0.7); translate(1, 0.2, -2); } } }");
    std::mt19937_64 random(95);
    const auto coordinate = [&] { return static_cast<double>(random() >> 11) * 0x1p-52 - 1; };
    Fingerprint fingerprint;
    int met = 0;
    for (int i = 0; i < 4000; ++i) {
        const Point eye{8 * coordinate(), 3 + 2 * coordinate(), -6};
        const RaySample sample = scene.sample(eye, Point{2 * coordinate(), coordinate(), coordinate()} - eye);
        met += sample.object > 1;
        for (const double value : {sample.colour.r, sample.colour.g, sample.colour.b, sample.depth, sample.normal.x,
                                   sample.normal.y, sample.normal.z, sample.position.x, sample.position.y, sample.position.z})
            fingerprint.add(value);
    }
    CHECK(met > 1500);
    Measurement same({"T95", "bits of rays from every compiler", "", 0});
    CAPTURE(fingerprint.value());
    same.expect(fingerprint.value() == 0x2aa8e75fcdacf3fe);
}

TEST_CASE("T96: the compiler neither contracts nor assumes away") {
    Measurement as_written({"T96", "arithmetic as it is written", "", 0});
    Random random(96);
    for (int i = 0; i < 1000; ++i) {
        const auto next = [&] { return random.uniform(-1, 1) * random.magnitude(-15, 15); };
        const Vector a{next(), next(), next()};
        as_written.expect(cross(a, a) == Vector{0, 0, 0});
    }
    volatile double near_one = 1 + 0x1p-27;
    const double a = near_one, square = a * a;
    as_written.expect(std::fma(a, a, -square) == 0x1p-54);
    as_written.expect(a * a - square == 0);
    volatile double zero = 0;
    const double nan = zero / zero;
    as_written.expect(!(nan == nan));
}

}  // namespace lapidary::test
