// SPDX-License-Identifier: MIT
//
// The passes of a picture: what may not matter does not matter, and what is promised is kept.

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <thread>
#include <vector>

#include "kernel/render/passes.h"
#include "kernel/render/pixel_estimate.h"
#include "kernel/render/tile.h"
#include "support/catch.h"
#include "support/stand_in_picture.h"

using namespace lapidary;

namespace {

const LayerSet all_layers{Layer::depth,    Layer::normal,  Layer::position, Layer::object,
                          Layer::material, Layer::samples, Layer::error};

SamplingPlan uniform(int samples) {
    SamplingPlan plan;
    plan.samples = samples;
    return plan;
}

SamplingPlan adaptive(double error) {
    SamplingPlan plan;
    plan.error = error;
    return plan;
}

SamplingPlan adaptive_through_glass(double error) {
    SamplingPlan plan = adaptive(error);
    plan.rays_are_bent = true;
    return plan;
}

bool is_same_pixel(const Frame& a, const Frame& b, int x, int y) {
    for (int i = 0; i < layer_count; ++i) {
        const auto layer = static_cast<Layer>(i);
        if (a.has(layer) && !std::ranges::equal(a.pixel(layer, x, y), b.pixel(layer, x, y))) return false;
    }
    return true;
}

int differing_pixels(const Frame& a, const Frame& b, const PixelRegion& region) {
    int differing = 0;
    for (int y = region.y0; y < region.y1; ++y)
        for (int x = region.x0; x < region.x1; ++x) differing += !is_same_pixel(a, b, x, y);
    return differing;
}

// Rays that are on their way between two looks at the clock.
constexpr auto rays_of_batch = static_cast<int>(pixels_of_part);

// An integrand given by a function of a ray.
template <typename Function>
IntegrandMaker integrand_of(Function function) {
    class Wrapped final : public Integrand {
    public:
        explicit Wrapped(Function f) : function_(f) {}
        void trace(std::span<const RayPacket> rays, std::span<Colour> colours, std::span<FirstFace>) override {
            for (std::size_t i = 0; i < colours.size(); ++i)
                colours[i] = function_(rays[i / batch_size].ray(static_cast<int>(i % batch_size)));
        }

    private:
        Function function_;
    };
    return [function] { return std::make_unique<Wrapped>(function); };
}

}  // namespace

TEST_CASE("the same bits for any number of threads") {
    const StandInPicture picture;
    for (const SamplingPlan& plan : {uniform(1), uniform(5), adaptive(0.004), adaptive(0.05), adaptive_through_glass(0.05)}) {
        Frame one = picture.frame(all_layers);
        RenderOptions options;
        options.threads = 1;
        picture.render(one, plan, options);
        for (const int threads : {2, 7}) {
            Frame many = picture.frame(all_layers);
            options.threads = threads;
            picture.render(many, plan, options);
            CHECK(differing_pixels(one, many, {0, 0, picture.width, picture.height}) == 0);
        }
    }
}

TEST_CASE("a region has the bits of the whole picture") {
    const StandInPicture picture;
    for (const SamplingPlan& plan : {uniform(4), adaptive(0.05), adaptive(0.02), adaptive(0.004), adaptive_through_glass(0.02)}) {
        Frame whole = picture.frame(all_layers);
        picture.render(whole, plan);
        for (const PixelRegion& region :
             {PixelRegion{0, 0, 33, 20}, {40, 30, 41, 31}, {17, 35, 90, 72}, {95, 71, 96, 72}, {31, 31, 65, 65}}) {
            Frame part = picture.frame(all_layers);
            RenderOptions options;
            options.region = region;
            const RenderReport report = picture.render(part, plan, options);
            CHECK(differing_pixels(whole, part, region) == 0);
            CHECK(report.pixels == static_cast<std::size_t>(region.width() * region.height()));
            CHECK(report.finished == report.pixels);
        }
    }
}

TEST_CASE("the preview does not change the picture") {
    const StandInPicture picture;
    Frame without = picture.frame(all_layers), with = picture.frame(all_layers);
    picture.render(without, adaptive(0.02));
    RenderOptions options;
    options.preview = true;
    std::atomic<int> tiles{0};
    options.on_tile = [&](const Frame&, const PixelRegion&) { ++tiles; };
    picture.render(with, adaptive(0.02), options);
    CHECK(differing_pixels(without, with, {0, 0, picture.width, picture.height}) == 0);
    CHECK(tiles > 4 * 9);  // three grids of blocks and at least one pass, nine tiles each
}

TEST_CASE("a region outside the picture is nothing to render") {
    const StandInPicture picture;
    Frame frame = picture.frame();
    RenderOptions options;
    options.region = PixelRegion{200, 200, 300, 300};
    const RenderReport report = picture.render(frame, adaptive(0.02), options);
    CHECK(report.pixels == 0);
    CHECK(report.complete);
}

TEST_CASE("one ray a pixel goes through its centre") {
    const StandInPicture picture;
    Frame frame = picture.frame({Layer::position});
    const RenderReport report = picture.render(frame, uniform(1));
    CHECK(report.samples == report.pixels);
    for (int x = 0; x < picture.width; ++x) {
        CHECK(frame.pixel(Layer::position, x, 9)[0] == x + 0.5f);
        const Colour expected = picture.at(x + 0.5, 9.5);
        CHECK(frame.pixel(Layer::colour, x, 9)[0] == static_cast<float>(expected.r));
    }
}

TEST_CASE("layers beside colour come from the pixel's centre") {
    const StandInPicture picture;
    for (const double error : {0.02, 0.05}) {
        Frame frame = picture.frame(all_layers);
        picture.render(frame, adaptive(error));
        for (int x = 0; x < picture.width; ++x) {
            CHECK(frame.pixel(Layer::position, x, 40)[0] == x + 0.5f);
            CHECK(frame.pixel(Layer::object, x, 40)[0] == x + 1);
        }
    }
}

TEST_CASE("a flat picture takes the first samples only, twice as many for small errors, middles for large ones, and is exact") {
    Frame frame(40, 30, {Layer::samples, Layer::error});
    const auto flat = integrand_of([](const Ray&) { return Colour{0.1, 0.2, 0.7}; });
    struct Case {
        RenderSettings::Filter filter;
        double error;
        bool rays_are_bent;
        std::uint64_t samples;
    };
    for (const auto& [filter, error, rays_are_bent, samples] : {Case{RenderSettings::Filter::box, 0.004, false, 8},
                                                                {RenderSettings::Filter::gaussian, 0.004, false, 8},
                                                                {RenderSettings::Filter::mitchell, 0.004, false, 16},
                                                                {RenderSettings::Filter::box, 0.009, false, 8},
                                                                {RenderSettings::Filter::box, 0.01, false, 2},
                                                                {RenderSettings::Filter::box, 0.01, true, 2},
                                                                {RenderSettings::Filter::gaussian, 0.05, false, 2},
                                                                {RenderSettings::Filter::box, 0.05, true, 2},
                                                                {RenderSettings::Filter::box, 0.1, true, 2},
                                                                {RenderSettings::Filter::box, 0.2, true, 1}}) {
        const SamplingPlan plan = rays_are_bent ? adaptive_through_glass(error) : adaptive(error);
        const RenderReport report =
            render_passes(flat, CameraRays({}, 40, 30), PixelFilter(filter, default_radius(filter)), plan, frame, {});
        CHECK(report.samples == report.pixels * samples);
        CHECK(report.within_error == report.pixels);
        CHECK(frame.pixel(Layer::colour, 3, 3)[0] == 0.1f);
        CHECK(frame.pixel(Layer::error, 3, 3)[0] == 0);
    }
}

// Left of an edge that crosses the pixels of one column all is black, right of it grey. Black wires, thinner than a pixel and
// between all middles, run beside the edge and far from it.
TEST_CASE("of pixels that rest on their middles, those beside pixels that a finer grid tells more of are woken") {
    constexpr int width = 48, height = 24, edge = 16;
    const auto wires = integrand_of([](const Ray& ray) {
        const double x = ray.origin.rounded().x + width / 2.0;
        const auto is_on_wire_before = [x](int column) { return x > column - 0.1 && x < column + 0.2; };
        if (is_on_wire_before(edge + 1) || is_on_wire_before(edge + 20)) return Colour::black();
        return Colour::grey(x < edge + 0.3 ? 0 : 0.75);
    });
    const CameraRays camera = camera_of_unit_pixels(width, height);
    Frame frame(width, height, {Layer::samples});
    const RenderReport report =
        render_passes(wires, camera, PixelFilter(RenderSettings::Filter::box, 0.5), adaptive(0.02), frame, {});
    CHECK(report.within_error == report.pixels);
    const auto samples_of = [&](int x) { return frame.pixel(Layer::samples, x, height / 2)[0]; };
    const auto grey_of = [&](int x) { return frame.pixel(Layer::colour, x, height / 2)[0]; };
    CHECK(samples_of(edge) > 4);
    CHECK(std::fabs(grey_of(edge) - 0.6 * 0.75) < 0.05);
    CHECK(samples_of(edge + 1) > 4);  // woken: its middle is as those beside it
    CHECK(std::fabs(grey_of(edge + 1) - 0.8 * 0.75) < 0.05);
    CHECK(samples_of(edge + 10) == 1);  // nothing is near
    CHECK(samples_of(edge + 20) == 1);  // what hides there is not looked for
    CHECK(grey_of(edge + 20) == 0.75);
}

namespace {

// A wire between the middles of two rows.
class Wire {
public:
    static constexpr int width = 48, height = 24, row = 10;

    static RenderReport render(Frame& frame, double error, const RenderOptions& options = {}) {
        const auto wire = integrand_of([](const Ray& ray) {
            const double y = height / 2.0 - ray.origin.rounded().y;
            return y > row + 0.6 && y < row + 0.9 ? Colour::black() : Colour::grey(0.5);
        });
        const PixelFilter filter(RenderSettings::Filter::box, 0.5);
        return render_passes(wire, camera_of_unit_pixels(width, height), filter, adaptive(error), frame, options);
    }
};

}  // namespace

// Where errors are small, some looks beside the middles find it, and wake the others.
TEST_CASE("what hides between all middles is found for small errors") {
    const auto mean_of_row = [&](double error) {
        Frame frame(Wire::width, Wire::height, {Layer::samples});
        const RenderReport report = Wire::render(frame, error);
        CHECK(report.within_error == report.pixels);
        double sum = 0, samples = 0;
        for (int x = 0; x < Wire::width; ++x) sum += frame.pixel(Layer::colour, x, Wire::row)[0];
        for (const float taken : frame.layer(Layer::samples)) samples += taken;
        CHECK(samples == static_cast<double>(report.samples));
        return sum / Wire::width;
    };
    CHECK(mean_of_row(0.02) == 0.5);
    CHECK(std::fabs(mean_of_row(0.019) - 0.7 * 0.5) < 0.019);
    CHECK(std::fabs(mean_of_row(0.01) - 0.7 * 0.5) < 0.01);
}

// Which pixels are woken depends on those that samples were taken of, one after the other along the wire.
TEST_CASE("what wakes along a wire is the same in a region") {
    Frame whole(Wire::width, Wire::height, all_layers);
    Wire::render(whole, 0.01);
    for (int x = 0; x < Wire::width; ++x) {
        const PixelRegion region{x, 9, x + 1, 13};
        Frame part(Wire::width, Wire::height, all_layers);
        RenderOptions options;
        options.region = region;
        CHECK(Wire::render(part, 0.01, options).complete);
        CHECK(differing_pixels(whole, part, region) == 0);
    }
}

TEST_CASE("of a coarse picture, a pixel whose middle is not finite takes samples that are") {
    const auto hole = integrand_of([](const Ray& ray) {
        const Point p = ray.origin.rounded();
        return std::hypot(p.x - 0.5, p.y - 0.5) < 0.1 ? Colour::grey(std::numeric_limits<double>::quiet_NaN()) : Colour::white();
    });
    Frame frame(12, 12, {Layer::samples});
    const RenderReport report = render_passes(hole, camera_of_unit_pixels(12, 12), PixelFilter(RenderSettings::Filter::box, 0.5),
                                              adaptive(0.05), frame, {});
    CHECK(report.trace.non_finite_samples > 0);
    CHECK(report.complete);
    for (const float value : frame.layer(Layer::colour)) CHECK(value == 1);
}

TEST_CASE("a picture of nothing but NaN ends, black") {
    const auto poisoned = integrand_of([](const Ray&) { return Colour::grey(std::numeric_limits<double>::quiet_NaN()); });
    Frame frame(16, 16, {});
    const RenderReport report = render_passes(poisoned, CameraRays({}, 16, 16), PixelFilter(RenderSettings::Filter::box, 0.5),
                                              adaptive(0.004), frame, {});
    CHECK(report.samples <= 64 * report.pixels);
    CHECK(report.within_error == 0);
    for (const float value : frame.layer(Layer::colour)) CHECK(value == 0);
}

TEST_CASE("light beyond the range of floats stays finite") {
    const auto blinding = integrand_of([](const Ray&) { return Colour::grey(1e300); });
    Frame frame(4, 4, {});
    render_passes(blinding, CameraRays({}, 4, 4), PixelFilter(RenderSettings::Filter::box, 0.5), adaptive(0.004), frame, {});
    for (const float value : frame.layer(Layer::colour)) CHECK(value == std::numeric_limits<float>::max());
}

TEST_CASE("a cancellation stops the work within a few dozen rays and says so") {
    for (const SamplingPlan& plan : {uniform(1000), adaptive(0.001)}) {
        Frame frame(640, 480, {});
        std::atomic<bool> cancel{false};
        std::atomic<int> begun{0}, begun_after{0};
        const auto cancelling = integrand_of([&](const Ray&) {
            begun_after += cancel;
            if (++begun == 5000) cancel = true;
            return Colour::white();
        });
        RenderOptions options;
        options.threads = 2;
        options.cancel = &cancel;
        const RenderReport report = render_passes(cancelling, CameraRays({}, 640, 480),
                                                  PixelFilter(RenderSettings::Filter::box, 0.5), plan, frame, options);
        CHECK_FALSE(report.complete);
        CHECK_FALSE(frame.is_complete());
        CHECK(report.finished < report.pixels);
        CHECK(begun_after < 2 * rays_of_batch);  // less than one batch a thread
    }
}

namespace {

// A picture that takes a second for every ray, by the clock that it is given.
class TimedPicture {
public:
    TimedPicture() {
        picture_.width = 48, picture_.height = 36;
        picture_.traced = &traced_;
    }

    struct Taken {
        std::unique_ptr<Frame> frame;
        RenderReport report;
    };

    Taken render(const SamplingPlan& plan, std::optional<double> limit, int threads = 1, std::uint32_t sequence = 0) {
        Taken taken{std::make_unique<Frame>(picture_.width, picture_.height, LayerSet{Layer::samples}), {}};
        RenderOptions options;
        options.threads = threads;
        options.sequence = sequence;
        options.clock = [this] { return std::chrono::duration<double>(static_cast<double>(traced_.load())); };
        if (limit) options.time = std::chrono::duration<double>(*limit);
        taken.report = picture_.render(*taken.frame, plan, options);
        return taken;
    }

    int differing_pixels(const Frame& a, const Frame& b) const {
        return ::differing_pixels(a, b, {0, 0, picture_.width, picture_.height});
    }

private:
    StandInPicture picture_;
    std::atomic<std::int64_t> traced_{0};
};

SamplingPlan as_good_as_time_allows() {
    SamplingPlan plan;
    plan.refine_until_time_is_up = true;
    return plan;
}

double rmse(const Frame& a, const Frame& b) {
    double squares = 0;
    for (std::size_t i = 0; i < a.layer(Layer::colour).size(); ++i)
        squares += std::pow(a.layer(Layer::colour)[i] - b.layer(Layer::colour)[i], 2);
    return std::sqrt(squares / static_cast<double>(a.layer(Layer::colour).size()));
}

}  // namespace

TEST_CASE("with a time limit the picture is refined until the time is up, less than a batch of rays beyond") {
    TimedPicture picture;
    for (const int threads : {1, 2, 3}) {
        const auto [frame, report] = picture.render(as_good_as_time_allows(), 20000, threads);
        CHECK(report.complete);
        CHECK(report.seconds >= 20000);
        CHECK(report.seconds < 20000 + threads * rays_of_batch);
        CHECK(*std::ranges::min_element(frame->layer(Layer::samples)) >= 1);
        // All but the few rays of the preview went into the picture.
        CHECK(report.samples > 19500);
    }
}

TEST_CASE("more time makes a better picture") {
    TimedPicture picture;
    const auto reference = picture.render(uniform(1024), {}, 1, 1).frame;
    double before = rmse(*picture.render(as_good_as_time_allows(), 2500).frame, *reference);
    for (const double limit : {10000, 40000, 160000}) {
        const auto [frame, report] = picture.render(as_good_as_time_allows(), limit);
        const double error = rmse(*frame, *reference);
        INFO(limit << " rays: " << error);
        CHECK(error < 0.6 * before);  // random samples would halve it
        before = error;
    }
}

TEST_CASE("whenever the time is up, the places that are flat so far are told to be good") {
    TimedPicture picture;
    for (const double limit : {8000, 10000, 12000, 14000, 16000, 20000}) {
        const auto [frame, report] = picture.render(as_good_as_time_allows(), limit);
        INFO(limit << " rays");
        CHECK(report.within_error > report.pixels / 16);
        CHECK(report.within_error < report.pixels);
    }
}

TEST_CASE("a time too short for a sample of every pixel leaves the preview, and says so") {
    TimedPicture picture;
    const auto [frame, report] = picture.render(as_good_as_time_allows(), 1000);
    CHECK_FALSE(report.complete);
    CHECK(report.finished < report.pixels);
    CHECK(report.seconds < 1000 + rays_of_batch);
    int black = 0;
    for (int y = 0; y < frame->height(); ++y)
        for (int x = 0; x < frame->width(); ++x) black += frame->pixel(Layer::colour, x, y)[2] == 0;
    CHECK(black == 0);  // the picture has no black place
}

TEST_CASE("a time limit that is not reached changes nothing") {
    TimedPicture picture;
    for (const SamplingPlan& plan : {uniform(5), adaptive(0.02)}) {
        const auto free = picture.render(plan, {}), limited = picture.render(plan, 1e7);
        CHECK(limited.report.complete);
        CHECK(limited.report.seconds < 1e7);
        CHECK(picture.differing_pixels(*free.frame, *limited.frame) == 0);

        const auto stopped = picture.render(plan, 1500);
        CHECK_FALSE(stopped.report.finished == stopped.report.pixels);
        CHECK(stopped.report.seconds < 1500 + rays_of_batch);
    }
}

TEST_CASE("finished pixels are counted once each, tiles are announced one at a time") {
    const StandInPicture picture;
    for (const SamplingPlan& plan : {uniform(3), adaptive(0.02), adaptive(0.05)}) {
        Frame frame = picture.frame();
        std::size_t finished = 0;
        double progress = 0;
        bool falls = false;
        std::atomic<int> inside{0}, most_inside{0};
        RenderOptions options;
        options.threads = 4;
        options.on_tile = [&](const Frame& shown, const PixelRegion& tile) {
            most_inside = std::max<int>(most_inside, ++inside);
            falls |= shown.finished() < finished || shown.progress() < progress || tile.is_empty();
            finished = shown.finished(), progress = shown.progress();
            --inside;
        };
        const RenderReport report = picture.render(frame, plan, options);
        CHECK_FALSE(falls);
        CHECK(most_inside == 1);
        CHECK(report.finished == report.pixels);
        CHECK(frame.progress() == 1);
        CHECK(frame.is_complete());
    }
}

TEST_CASE("filters blur as their shapes say") {
    // A step at x = 0: the mean over many samples is the filter's integral right of it.
    const auto step = integrand_of([](const Ray& ray) { return Colour::grey(ray.origin.rounded().x > 0 ? 1 : 0); });
    Camera description;
    description.projection = Camera::Projection::orthographic;
    description.screen_height = 8;
    const CameraRays camera(description, 8, 8);
    const auto left_of_step = [&](RenderSettings::Filter shape) {
        Frame frame(8, 8, {});
        render_passes(step, camera, PixelFilter(shape, default_radius(shape)), uniform(16384), frame, {});
        return std::pair{frame.pixel(Layer::colour, 3, 4)[0], frame.pixel(Layer::colour, 2, 4)[0]};
    };
    CHECK(left_of_step(RenderSettings::Filter::box).first == 0);

    // Mitchell's filter right of 1/2 and of 3/2, integrated from its polynomial.
    const auto [near_mitchell, far_mitchell] = left_of_step(RenderSettings::Filter::mitchell);
    const auto inner = [](double x) { return (7 * x * x * x * x / 4 - 4 * x * x * x + 16.0 / 3 * x) / 6; };
    const auto outer = [](double x) { return (-7.0 / 12 * x * x * x * x + 4 * x * x * x - 10 * x * x + 32.0 / 3 * x) / 6; };
    CHECK(near_mitchell == Approx(inner(1) - inner(0.5) + outer(2) - outer(1)).margin(2e-3));
    CHECK(far_mitchell == Approx(outer(2) - outer(1.5)).margin(2e-3));

    const auto [near_gaussian, far_gaussian] = left_of_step(RenderSettings::Filter::gaussian);
    CHECK(near_gaussian > 0.1);
    CHECK(near_gaussian < 0.2);
    CHECK(far_gaussian == Approx(0).margin(1e-4));
}

TEST_CASE("the estimate of equal samples is exact") {
    PixelEstimate estimate;
    for (int i = 0; i < 1000; ++i) estimate.add({0.1, 0.2, 0.3});
    CHECK(estimate.mean() == Colour{0.1, 0.2, 0.3});
    CHECK(estimate.spread() == 0);
}

TEST_CASE("moves that shrink as those of independent samples are remembered as the last one") {
    double move = 0.3, remembered = remembered_moves(no_moves, move);
    CHECK(remembered == Approx(move * move));
    for (int doubling = 0; doubling < 10; ++doubling) {
        move /= std::numbers::sqrt2;
        remembered = remembered_moves(remembered, move);
        CHECK(remembered == Approx(move * move));
    }
    // A colour that happens not to move is not believed to have come to rest.
    CHECK(remembered_moves(remembered, 0) == Approx(move * move / 4));
}

TEST_CASE("what may hide between the samples of a pixel falls as their number") {
    CHECK(error_from_around(0.2, 0.1, 16) == Approx(std::numbers::sqrt2 / 16 * 0.2));
    CHECK(error_from_around(0.1, 0.6, 16) == Approx(std::numbers::sqrt2 / 16 * 0.3));
    CHECK(error_from_spread(0.4, 16) == Approx(1.25 * 0.4 / 8));
}
