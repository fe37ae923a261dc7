// SPDX-License-Identifier: MIT
#include "kernel/render/passes.h"

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <ctime>
#include <limits>
#include <thread>
#include <utility>

#include "kernel/render/passes_implementation.h"

namespace lapidary {

namespace {

constexpr std::array<int, 4> preview_blocks{32, 16, 8, 4};

constexpr std::uint32_t first_samples = 4;
constexpr std::uint32_t first_samples_of_left_over = 16;  // what even the finest grid does not tell is not simple
// Neighbours reveal edges to two samples as well as to four; only what is smaller than a pixel, and matters to small errors,
// takes four, and so does a lens, through which everything is spread thin.
constexpr std::uint32_t first_samples_of_coarse_picture = 2;
constexpr double least_coarse_error = 0.01;
// Even for these, the middles of the pixels and edges between them will do where rays go straight on. What is thinner than a
// pixel can hide from them, which would matter to smaller errors. What is seen through glass is tangled, and edges in it are
// worth following for large errors only.
constexpr double least_error_from_middles = least_coarse_error, least_error_from_middles_through_glass = 0.2;
constexpr std::uint32_t first_samples_of_signed_filter = 16;  // so that negative lobes cannot outweigh the rest
constexpr std::uint32_t fewest_at_most = 64, most_at_most = 65536;
constexpr std::uint32_t guessed_refinement = 4;                        // all samples for one of the first, until more is known
constexpr double coarsest_tolerance = 0.064, finest_tolerance = 1e-6;  // against the clock

// How many samples a pixel that will have so many next will still take if its error falls as it should.
std::uint64_t samples_to_come(const Pixel& pixel, std::uint32_t next, double tolerance, std::uint32_t most) {
    std::uint64_t taken = next;
    for (double error = pixel.error * error_after_doubling; error > tolerance && taken < most; error *= error_after_doubling)
        taken *= 2;
    return taken - pixel.taken;
}

constexpr std::size_t colour_channels = channels_of(Layer::colour), channels_of_part = colour_channels * pixels_of_part;
static_assert(sizeof(Colour) == colour_channels * sizeof(double) && sizeof(FloatColour) == colour_channels * sizeof(float));
using ChannelsOfPart = std::array<float, channels_of_part>;

// The channels of a part's colours as floats; whether all were finite.
[[gnu::noinline]] bool round_channels(const double* __restrict channels, ChannelsOfPart& __restrict rounded) {
    std::int64_t finite = 0;
    for (std::size_t i = 0; i < channels_of_part; ++i) {
        finite += std::fabs(channels[i]) < infinity ? 1 : 0;
        rounded[i] = to_float(channels[i]);
    }
    return finite == channels_of_part;
}

// In the order of places_in_part, where pixels stand beside each other by twos. `row` is from one row of the picture to the
// next.
void store_channels(const ChannelsOfPart& channels, float* corner, std::ptrdiff_t row) {
    constexpr std::size_t of_two = 2 * colour_channels;
    for (std::size_t i = 0; i < pixels_of_part; i += 2) {
        const PixelPlace& place = places_in_part[i];
        std::copy_n(&channels[colour_channels * i], of_two, corner + place.y * row + std::ptrdiff_t{colour_channels} * place.x);
    }
}

bool is_coarse(const SamplingPlan& plan) { return plan.error >= least_coarse_error && !plan.refine_until_time_is_up; }

bool may_begin_with_middles(const SamplingPlan& plan, const CameraRays& camera, const PixelFilter& filter) {
    const double least_error = plan.rays_are_bent ? least_error_from_middles_through_glass : least_error_from_middles;
    return is_coarse(plan) && plan.error >= least_error && filter.is_pixel() && !camera.has_lens() && !plan.lights_are_sampled;
}

// Enough even for a pixel of black and white noise, in which the error falls no faster than 1/2 n^-1/2.
std::uint32_t most_samples(const SamplingPlan& plan) {
    const double needed = std::pow(0.5 / plan.error, 2);
    if (plan.refine_until_time_is_up || !(needed < most_at_most)) return most_at_most;
    return std::max(fewest_at_most, std::bit_ceil(static_cast<std::uint32_t>(needed)));
}

std::uint32_t first_samples_of(const SamplingPlan& plan, const CameraRays& camera, const PixelFilter& filter) {
    const bool few = is_coarse(plan) && !may_begin_with_middles(plan, camera, filter) && !camera.has_lens();
    const std::uint32_t samples = filter.has_negative_lobes()                    ? first_samples_of_signed_filter
                                  : may_begin_with_middles(plan, camera, filter) ? first_samples_of_left_over
                                  : few                                          ? first_samples_of_coarse_picture
                                                                                 : first_samples;
    // Every lens point has its turn.
    return std::max(samples, std::bit_ceil(static_cast<std::uint32_t>(camera.lens_points())));
}

}  // namespace

double processor_time() {
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

Passes::Passes(const IntegrandMaker& make_integrand, const CameraRays& camera, const PixelFilter& filter,
               const SamplingPlan& plan, Frame& frame, const RenderOptions& options)
    : camera_(camera),
      filter_(filter),
      plan_(plan),
      frame_(frame),
      options_(options),
      begin_(now()),
      picture_{0, 0, frame.width(), frame.height()},
      region_(options.region ? intersection(*options.region, picture_) : picture_),
      workers_([&make_integrand] { return Worker(make_integrand()); }) {
    for (const Layer layer : {Layer::depth, Layer::normal, Layer::position, Layer::object, Layer::material})
        wants_layers_ |= frame.has(layer);

    first_samples_ = first_samples_of(plan, camera, filter);
    begins_with_middles_ = plan.samples == 0 && may_begin_with_middles(plan, camera, filter);

    area_ = region_;
    if (plan.samples == 0) {
        most_samples_ = std::max(first_samples_, most_samples(plan));
        most_passes_ = std::countr_zero(most_samples_) - std::countr_zero(first_samples_);
        const int margin = most_passes_ + 1 + (begins_with_middles() ? rounds_of_waking_by_samples + margin_of_edges : 0);
        if (!region_.is_empty()) area_ = around_region(margin);
    }
}

bool Passes::is_stopped() const { return is_cancelled() || is_time_up(); }

// ---- the passes ------------------------------------------------------------------------------------------------------

RenderReport Passes::run() {
    if (!region_.is_empty()) {
        const int threads =
            options_.threads > 0 ? options_.threads : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
        // The number asked for, even where the machine has fewer.
        const tbb::global_control allow(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
        tbb::task_arena arena(threads);
        arena.execute([this] { render_all(); });
    }
    return report();
}

void Passes::render_all() {
    if (options_.preview || options_.time) preview();
    // Of a large picture these are hundreds of megabytes, which a first view need not wait for.
    if (begins_with_middles())
        edges_.resize(area_), greatest_moves_.resize(tiles_of(picture_).size());
    else if (!finishes_tiles_at_once())
        pixels_.resize(area_, filter_.has_negative_lobes());
    restless_.resize(tiles_of(picture_).size());
    wake_all();
    if (plan_.samples > 0)
        sample_uniformly(plan_.samples);
    else if (plan_.refine_until_time_is_up)
        sample_until_time_is_up();
    else
        sample_adaptively();
}

void Passes::sample_uniformly(int samples) {
    if (finishes_tiles_at_once()) {
        expected_samples_ = pixel_count(region_) * static_cast<std::size_t>(samples);
        if (frame_.has(Layer::error))  // of what will not be reached
            for (int y = region_.y0; y < region_.y1; ++y)
                for (int x = region_.x0; x < region_.x1; ++x) frame_.pixel(Layer::error, x, y)[0] = static_cast<float>(infinity);
        for_each_tile(region_, [&](const PixelRegion& tile) {
            if (samples == 1)
                sample_middles(tile, workers_.local());
            else
                sample_tile(tile, samples, workers_.local());
            taken_samples_ += pixel_count(tile) * static_cast<std::size_t>(samples);
            report_progress();
            if (!is_stopped()) frame_.count_finished(pixel_count(tile));
            announce(tile);
        });
        return;
    }
    expected_samples_ = pixel_count(area_) * static_cast<std::size_t>(samples);
    trace_pixels(region_, static_cast<std::uint32_t>(samples));
}

void Passes::sample_adaptively() {
    expected_samples_ = guessed_refinement * pixel_count(area_) * (begins_with_middles() ? 1 : first_samples_);
    if (begins_with_middles()) {
        follow_edges();
        if (!sample_left_over()) return;
    } else {
        trace_pixels(around_region(most_passes_ + 1), first_samples_);
    }
    for (int pass = 1; pass <= most_passes_ + 1 && !is_stopped(); ++pass) {
        const PixelRegion taking_part = around_region(most_passes_ - pass + 1);
        if (!look_at_errors(taking_part, plan_.error)) break;
        trace_pixels(taking_part, std::nullopt);
    }
}

void Passes::sample_until_time_is_up() {
    // Something everywhere first, then the samples that estimates need.
    for (const std::uint32_t goal : {1u, first_samples_}) trace_pixels(region_, goal);
    // Each tolerance starts from what the one before it left.
    for (double tolerance = coarsest_tolerance; tolerance > finest_tolerance && !is_stopped(); tolerance /= 2) {
        wake_all();
        while (!is_stopped() && look_at_errors(region_, tolerance)) trace_pixels(region_, std::nullopt);
    }
}

void Passes::trace_pixels(const PixelRegion& region, std::optional<std::uint32_t> goal) {
    for_each_tile(region, [&](const PixelRegion& tile) {
        const std::uint64_t samples = trace_tile(tile, goal, workers_.local());
        if (samples == 0) return;
        taken_samples_ += samples;
        report_progress();
        const PixelRegion shown = intersection(tile, region_);
        if (shown.is_empty()) return;
        if (plan_.samples > 0 && !is_stopped()) frame_.count_finished(pixel_count(shown));
        announce(shown);
    });
}

// ---- rays ------------------------------------------------------------------------------------------------------------

// The number of samples that were to be taken.
std::uint64_t Passes::trace_tile(const PixelRegion& tile, std::optional<std::uint32_t> goal, Worker& worker) {
    worker.doublings.clear();
    worker.batch->size = 0;
    std::uint64_t samples = 0;
    restless_pixels_of(tile).for_each(tile, [&](PixelPlace place) {
        const std::size_t index = pixels_.index_of(place);
        Pixel& pixel = pixels_[index];
        const std::uint32_t to_have = goal_of(pixel, goal);
        if (to_have <= pixel.taken) return;
        if (samples == 0) begin_tile(tile, worker);
        samples += to_have - pixel.taken;
        worker.doublings.push_back({place, pixels_.colour_of(index), pixel.taken > first_samples_ ? pixel.moves : no_moves});
        if (!is_stopped()) take_samples(place, pixel, to_have, worker);
    });
    flush(worker);

    for (const Worker::Doubling& doubling : worker.doublings) {
        const std::size_t index = pixels_.index_of(doubling.place);
        Pixel& pixel = pixels_[index];
        if (pixel.taken == 0) continue;
        const Colour colour = pixels_.colour_of(index);
        pixel.variance = pixel.estimate.variance();
        pixel.moves = to_float(remembered_moves(doubling.earlier_moves, contrast(doubling.before, colour)));
        if (is_in(doubling.place, region_)) write_pixel(doubling.place, pixel, colour);
    }
    return samples;
}

// All there is to do about a tile at once, so that its pixels need to be remembered only until the next tile: of a large
// picture that is hundreds of megabytes that are never touched.
void Passes::sample_tile(const PixelRegion& tile, int samples, Worker& worker) {
    begin_tile(tile, worker);
    worker.tile.assign(tile_size * tile_size, Pixel{});
    const auto pixel_at = [&](int x, int y) -> Pixel& {
        return worker.tile[static_cast<std::size_t>(y - tile.y0) * tile_size + static_cast<std::size_t>(x - tile.x0)];
    };
    worker.batch->size = 0;
    restless_pixels_of(tile).for_each(tile, [&](PixelPlace place) {
        if (!is_stopped()) take_samples(place, pixel_at(place.x, place.y), static_cast<std::uint32_t>(samples), worker);
    });
    flush(worker);

    for (int y = tile.y0; y < tile.y1; ++y)
        for (int x = tile.x0; x < tile.x1; ++x) {
            const Pixel& pixel = pixel_at(x, y);
            if (pixel.taken == 0) continue;
            write_pixel({x, y}, pixel, pixel.estimate.mean());
            const auto error = static_cast<float>(own_error(pixel));
            if (frame_.has(Layer::error)) frame_.pixel(Layer::error, x, y)[0] = error;
            worker.report.samples += pixel.taken;
            worker.report.within_error += error <= plan_.error;
            ++worker.report.pixels;
        }
}

// A single sample is the middle of its pixel, and tells nothing of its error: there is nothing to remember of it.
void Passes::sample_middles(const PixelRegion& tile, Worker& worker) {
    begin_tile(tile, worker);
    for (int y = tile.y0; y < tile.y1; y += part_size)
        for (int x = tile.x0; x < tile.x1 && !is_stopped(); x += part_size)
            sample_middles_of_part(intersection({x, y, x + part_size, y + part_size}, tile), worker);
}

void Passes::sample_middles_of_part(const PixelRegion& part, Worker& worker) {
    SampleBatch& batch = *worker.batch;
    const std::optional<Beam> beam = camera_.beam(part.x0 + 0.5, part.y0 + 0.5, part.x1 - 0.5, part.y1 - 0.5);
    ask_for_colours(part);
    if (const std::optional<Colour> known = spare(beam, pixel_count(part) == pixels_of_part, pixel_count(part), worker)) {
        if (edges_.is_empty() && shows_colours_only(part) && is_finite(*known)) {
            paint(part, *known);
            worker.report.samples += pixel_count(part), worker.report.pixels += pixel_count(part);
        } else {
            batch.fill(pixel_count(part), *known, wants_layers_);
            write_middles(part, worker);
        }
        return;
    }

    const bool keys_count = plan_.lights_are_sampled || camera_.has_lens();
    const std::size_t size = batch.place_in_middles(part, camera_, keys_count ? std::optional(options_.sequence) : std::nullopt);
    if (trace(worker, size, wants_layers_)) write_middles(part, worker);
}

// The samples of a part, one for each pixel, in the order of places_in_part.
void Passes::write_middles(const PixelRegion& part, Worker& worker) {
    if (pixel_count(part) == pixels_of_part && shows_colours_only(part) && write_colours(part, worker)) return;
    const SampleBatch& batch = *worker.batch;
    std::size_t i = 0;
    for (const PixelPlace& place : places_in_part) {
        const PixelPlace pixel{part.x0 + place.x, part.y0 + place.y};
        if (!is_in(pixel, part)) continue;
        const bool finite = is_finite(batch.colours[i]);
        const Colour colour = finite ? batch.colours[i] : Colour::black();
        worker.non_finite_samples += !finite;
        if (!edges_.is_empty()) edges_.keep_middle(pixel, to_floats(batch.colours[i]));
        if (is_in(pixel, region_)) {
            store(frame_.pixel(Layer::colour, pixel.x, pixel.y), colour.r, colour.g, colour.b);
            if (frame_.has(Layer::samples)) frame_.pixel(Layer::samples, pixel.x, pixel.y)[0] = 1;
            if (wants_layers_) write_layers(pixel, batch.faces[i]);
        }
        ++i;
    }
    if (edges_.is_empty()) worker.report.samples += pixel_count(part), worker.report.pixels += pixel_count(part);
}

// The colours of middles alone, which are most of what is ever written.
bool Passes::shows_colours_only(const PixelRegion& part) const {
    return !wants_layers_ && !frame_.has(Layer::samples) && pixel_count(intersection(part, region_)) == pixel_count(part);
}

// Of a whole part, whether all of them were finite; else nothing is written.
bool Passes::write_colours(const PixelRegion& part, Worker& worker) {
    ChannelsOfPart channels;
    if (!round_channels(&worker.batch->colours.front().r, channels)) return false;
    store_channels(channels, frame_.row(Layer::colour, part.x0, part.x1, part.y0).data(), row_of_colours());
    if (edges_.is_empty())
        worker.report.samples += pixels_of_part, worker.report.pixels += pixels_of_part;
    else
        store_channels(channels, &edges_.begin_middles(part)->r, std::ptrdiff_t{colour_channels} * edges_.row_of_middles());
    return true;
}

// Before they are written: memory that nothing was written to yet is far away.
void Passes::ask_for_colours(const PixelRegion& part) {
    constexpr std::ptrdiff_t cache_line = 64 / sizeof(float);
    float* row = frame_.row(Layer::colour, part.x0, part.x1, part.y0).data();
    for (int y = part.y0; y < part.y1; ++y, row += row_of_colours())
        for (std::ptrdiff_t i = 0; i < part.width() * std::ptrdiff_t{colour_channels}; i += cache_line)
            __builtin_prefetch(row + i, 1);
}

std::ptrdiff_t Passes::row_of_colours() const { return std::ptrdiff_t{colour_channels} * frame_.width(); }

// All of a part in one colour.
void Passes::paint(const PixelRegion& part, const Colour& colour) {
    for (int y = part.y0; y < part.y1; ++y)
        for (std::span row = frame_.row(Layer::colour, part.x0, part.x1, y); !row.empty(); row = row.subspan(3))
            store(row, colour.r, colour.g, colour.b);
}

// All of its rays, which filters may send beyond its pixels, lie in one beam.
void Passes::begin_tile(const PixelRegion& tile, Worker& worker) const {
    begin_tile(tile, std::max(0.5, filter_.radius()), worker);
}

// `reach`: how far from the middles of its pixels rays go.
void Passes::begin_tile(const PixelRegion& tile, double reach, Worker& worker) const {
    const std::optional<Beam> beam =
        camera_.beam(tile.x0 + 0.5 - reach, tile.y0 + 0.5 - reach, tile.x1 - 0.5 + reach, tile.y1 - 0.5 + reach);
    worker.integrand->begin_tile(beam ? &*beam : nullptr);
}

// Begins a part of a tile. Where it is known what its rays bring back, that is the answer: no ray has to be sent.
std::optional<Colour> Passes::spare(const std::optional<Beam>& beam, bool in_quarters, std::size_t size, Worker& worker) {
    const std::optional<Colour> known = worker.integrand->begin_part(beam ? &*beam : nullptr, in_quarters);
    if (known) worker.spared_samples += size;
    return known;
}

// The first places of a batch. False where that was cancelled: paths may have ended on their way.
bool Passes::trace(Worker& worker, std::size_t size, bool layers) const {
    SampleBatch& batch = *worker.batch;
    worker.integrand->trace(batch.rays_of(size, camera_), std::span(batch.colours).first(size),
                            std::span(batch.faces).first(layers ? size : 0));
    return !is_cancelled();
}

void Passes::take_samples(PixelPlace place, Pixel& pixel, std::uint32_t goal, Worker& worker) {
    using Purpose = SampleBatch::Purpose;
    SampleBatch& batch = *worker.batch;
    const auto add = [&](std::uint32_t number, Purpose purpose) {
        batch.add(place, number, &pixel, purpose);
        if (batch.size == SampleBatch::most) flush(worker);
    };
    if (wants_layers_ && pixel.rays() == 0 && is_in(place, region_)) {
        batch.has_layers = true;
        add(0, Purpose::layers);
    }
    for (std::uint32_t number = pixel.taken; number < goal; ++number) {
        if (batch.size == 0 && is_stopped()) return;
        add(number, Purpose::colour);
    }
}

void Passes::flush(Worker& worker) {
    using Purpose = SampleBatch::Purpose;
    SampleBatch& batch = *worker.batch;
    const std::size_t size = std::exchange(batch.size, 0);
    if (size == 0 || is_stopped()) return;
    batch.place(size, camera_, filter_, options_.sequence);
    const bool layers = std::exchange(batch.has_layers, false);
    if (const std::optional<Colour> known = spare(batch.beam(size, camera_), false, size, worker))
        batch.fill(size, *known, layers);
    else if (!trace(worker, size, layers))
        return;

    // In the order of the samples, whatever the batches were.
    for (std::size_t i = 0; i < size; ++i) {
        if (batch.purpose[i] == Purpose::layers) {
            write_layers({batch.x[i], batch.y[i]}, batch.faces[i]);
            continue;
        }
        Pixel& pixel = *batch.pixel[i];
        ++pixel.taken;
        PixelEstimate& estimate = batch.purpose[i] == Purpose::colour ? pixel.estimate : pixels_.negative_of(pixel);
        if (!estimate.add(batch.colours[i])) ++worker.non_finite_samples;
    }
}

// ---- preview ---------------------------------------------------------------------------------------------------------

void Passes::preview() {
    is_previewing_ = true;
    for (const int block : preview_blocks) {
        for_each_tile(region_, [&](const PixelRegion& tile) { preview_tile(tile, block, workers_.local()); });
        is_previewing_ = false;
        if (!first_view_ && !is_stopped()) first_view_ = elapsed().count();
    }
}

// One ray in the middle of each block paints all of it.
void Passes::preview_tile(const PixelRegion& tile, int block, Worker& worker) {
    worker.integrand->begin_tile(nullptr);
    for (int y = tile.y0; y < tile.y1 && !is_stopped(); y += block)
        for (int x = tile.x0; x < tile.x1; x += block) {
            const PixelRegion painted = intersection({x, y, x + block, y + block}, tile);
            Ray ray = camera_.ray((painted.x0 + painted.x1) / 2.0, (painted.y0 + painted.y1) / 2.0);
            ray.key = sample_key(x, y, 0, options_.sequence);
            RayPacket packet;
            packet.add(ray);
            packet.fill_up();
            Colour colour;
            worker.integrand->trace({&packet, 1}, {&colour, 1}, {});
            if (is_cancelled()) return;
            if (is_finite(colour)) paint(painted, colour);
        }
    announce(tile);
}

// ---- estimates -------------------------------------------------------------------------------------------------------

// Of a fixed number of samples, every pixel by itself; a single sample does not tell how far it is off.
double Passes::own_error(const Pixel& pixel) const {
    const auto count = pixel.estimate.count();
    if (count < 2) return infinity;
    return error_from_spread(pixel.estimate.spread(), count) / brightness_scale(pixel.estimate.mean());
}

void Passes::wake_all() {
    for (PixelSet& pixels : restless_) pixels.fill();
}

std::uint32_t Passes::goal_of(const Pixel& pixel, std::optional<std::uint32_t> goal) const {
    if (goal) return *goal;
    if (pixel.taken == 0) return first_samples_;
    return may_go_on(pixel) ? 2 * pixel.taken : pixel.taken;
}

bool Passes::may_go_on(const Pixel& pixel) const {
    // A pixel of which hardly any sample is finite will not come to rest.
    const bool hopeless = pixel.estimate.count() < pixel.taken / 16;
    return pixel.taken < most_samples_ && !hopeless;
}

// The first samples alone cannot move. Where small errors matter, no pixel is believed before it had the chance to. (A filter
// with negative lobes begins with many samples.)
bool Passes::may_not_rest(const Pixel& pixel, double tolerance) const {
    return tolerance < least_coarse_error && pixel.taken == first_samples_ && !filter_.has_negative_lobes();
}

bool Passes::look_at_errors(const PixelRegion& region, double tolerance) {
    std::atomic<std::uint64_t> to_come{0};
    std::atomic<std::size_t> going_on{0}, going_on_in_region{0};
    for_each_tile(region, [&](const PixelRegion& tile) {
        std::uint64_t samples = 0;
        std::size_t pixels = 0, pixels_in_region = 0;
        PixelField::BlockErrors errors;
        // The estimates of others look at a pixel's samples, which stay as they are meanwhile, not at its error.
        const auto estimate = [&](PixelPlace block) { pixels_.estimate_errors(block, first_samples_, errors); };
        const auto rests = [&](PixelPlace place, std::size_t in_block) {
            Pixel& pixel = pixels_[place];
            if (pixel.error > tolerance) pixel.error = to_float(errors[in_block]);
            const bool too_early = may_not_rest(pixel, tolerance);
            if (pixel.error <= tolerance && !too_early) return true;
            if (!may_go_on(pixel)) return false;
            const std::uint32_t next = goal_of(pixel, std::nullopt);
            samples += samples_to_come(pixel, next, tolerance, most_samples_);
            if (too_early) pixel.error = std::numeric_limits<float>::infinity();  // look again, whatever it seems now
            pixels += 1;
            pixels_in_region += is_in(place, region_);
            return false;
        };
        restless_pixels_of(tile).remove_if(tile, estimate, rests);
        to_come += samples, going_on += pixels, going_on_in_region += pixels_in_region;
    });
    if (is_stopped()) return false;

    expected_samples_ = taken_samples_ + to_come;
    if (!plan_.refine_until_time_is_up) frame_.count_finished(pixel_count(region_) - going_on_in_region - frame_.finished());
    return going_on > 0;
}

// ---- the frame -------------------------------------------------------------------------------------------------------

void Passes::write_pixel(PixelPlace place, const Pixel& pixel, const Colour& colour) {
    const auto [x, y] = place;
    store(frame_.pixel(Layer::colour, x, y), colour.r, colour.g, colour.b);
    if (frame_.has(Layer::samples)) frame_.pixel(Layer::samples, x, y)[0] = static_cast<float>(pixel.rays());
}

void Passes::write_layers(PixelPlace place, const FirstFace& face) {
    const auto [x, y] = place;
    if (frame_.has(Layer::depth)) frame_.pixel(Layer::depth, x, y)[0] = static_cast<float>(face.depth);
    if (frame_.has(Layer::normal)) store(frame_.pixel(Layer::normal, x, y), face.normal.x, face.normal.y, face.normal.z);
    if (frame_.has(Layer::position))
        store(frame_.pixel(Layer::position, x, y), face.position.x, face.position.y, face.position.z);
    if (frame_.has(Layer::object)) frame_.pixel(Layer::object, x, y)[0] = static_cast<float>(face.object);
    if (frame_.has(Layer::material)) frame_.pixel(Layer::material, x, y)[0] = static_cast<float>(face.material);
}

void Passes::announce(const PixelRegion& tile) {
    if (!options_.on_tile) return;
    const std::lock_guard lock(announcing_);
    options_.on_tile(frame_, tile);
}

void Passes::report_progress() {
    if (plan_.refine_until_time_is_up)
        frame_.raise_progress(elapsed() / *options_.time);
    else
        frame_.raise_progress(static_cast<double>(taken_samples_) / static_cast<double>(expected_samples_));
}

// Pixels that were stopped before they were looked at again have something to tell, too.
void Passes::estimate_what_was_stopped() {
    if (pixels_.is_empty()) return;
    PixelField::BlockErrors errors;
    for (const PixelRegion& tile : tiles_of(region_))
        restless_pixels_of(tile).remove_if(
            tile, [&](PixelPlace block) { pixels_.estimate_errors(block, first_samples_, errors); },
            [&](PixelPlace place, std::size_t in_block) {
                Pixel& pixel = pixels_[place];
                if (plan_.samples > 0)
                    pixel.error = static_cast<float>(own_error(pixel));
                else if (pixel.taken >= first_samples_ && std::isinf(pixel.error))
                    pixel.error = static_cast<float>(errors[in_block]);
                return false;
            });
}

RenderReport Passes::report() {
    RenderReport report;
    report.pixels = pixel_count(region_);
    std::size_t sampled = 0;
    estimate_what_was_stopped();
    for (const Worker& worker : workers_) {
        report.samples += worker.report.samples, report.within_error += worker.report.within_error;
        sampled += worker.report.pixels;
    }
    for (int y = region_.y0; y < region_.y1 && !pixels_.is_empty(); ++y)
        for (int x = region_.x0; x < region_.x1; ++x) {
            const Pixel& pixel = pixels_[PixelPlace{x, y}];
            if (frame_.has(Layer::error)) frame_.pixel(Layer::error, x, y)[0] = pixel.error;
            report.samples += pixel.rays();
            report.within_error += pixel.error <= plan_.error;
            sampled += pixel.rays() > 0;
        }
    if (pixels_.is_empty() && !edges_.is_empty()) report_of_edges(report, sampled);

    report.complete = !is_cancelled() && sampled == report.pixels;
    if (report.complete) frame_.count_finished(report.pixels - frame_.finished());
    report.finished = frame_.finished();
    frame_.set_complete(report.complete);
    if (report.complete) frame_.raise_progress(1);

    for (const Worker& worker : workers_) {
        report.trace += worker.integrand->statistics();
        report.trace.non_finite_samples += worker.non_finite_samples;
        report.trace.camera_rays += worker.spared_samples;
        report.trace.camera_rays_skipped += worker.spared_samples;
    }
    report.seconds = elapsed().count();
    report.processor_seconds = processor_seconds_;
    report.first_view = first_view_;
    return report;
}

SamplingPlan plan_sampling(const Scene& scene, const RenderOptions& options) {
    SamplingPlan plan;
    plan.error = options.error.value_or(scene.render.error);
    if (options.samples)
        plan.samples = std::max(1, *options.samples);
    else if (!options.error && !options.time && scene.camera.rays)
        plan.samples = std::max(1, *scene.camera.rays);
    plan.refine_until_time_is_up = options.time.has_value() && !options.error && plan.samples == 0;
    return plan;
}

RenderReport render_passes(const IntegrandMaker& make_integrand, const CameraRays& camera, const PixelFilter& filter,
                           const SamplingPlan& plan, Frame& frame, const RenderOptions& options) {
    return Passes(make_integrand, camera, filter, plan, frame, options).run();
}

}  // namespace lapidary
