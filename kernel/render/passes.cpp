// SPDX-License-Identifier: MIT
#include "kernel/render/passes.h"

#include <oneapi/tbb/enumerable_thread_specific.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <mutex>
#include <thread>
#include <utility>

#include "kernel/render/pixel_estimate.h"

namespace lapidary {

namespace {

using Seconds = std::chrono::duration<double>;

constexpr int tile_size = 32;
// So few that a cancellation is noticed within 50 ms even where a ray takes half a millisecond.
constexpr std::size_t most_rays = 64;
constexpr int block_size = 8;  // most_rays pixels in a square
constexpr std::array<int, 4> preview_blocks{32, 16, 8, 4};

constexpr std::uint32_t first_samples = 4;
// Neighbours reveal edges to two samples as well as to four; only what is smaller than a pixel, and matters to small errors,
// takes four, and so does a lens, through which everything is spread thin.
constexpr std::uint32_t first_samples_of_coarse_picture = 2;
constexpr double least_coarse_error = 0.01;
constexpr std::uint32_t first_samples_of_signed_filter = 16;  // so that negative lobes cannot outweigh the rest
constexpr std::uint32_t fewest_at_most = 64, most_at_most = 65536;
constexpr std::uint32_t guessed_refinement = 4;                        // all samples for one of the first, until more is known
constexpr double coarsest_tolerance = 0.064, finest_tolerance = 1e-6;  // against the clock

struct Pixel {
    PixelEstimate estimate;
    Colour before;                                         // the colour before its samples were doubled last
    std::uint32_t taken = 0;                               // samples traced, also those that were not finite
    std::uint32_t goal = 0;                                // samples to have after the next pass
    float earlier_moves = no_moves;                        // those before the last one, as remembered_moves() keeps them
    float error = std::numeric_limits<float>::infinity();  // as estimated last
};

struct Place {
    int x = 0, y = 0;
};

PixelRegion intersection(const PixelRegion& a, const PixelRegion& b) {
    return {std::max(a.x0, b.x0), std::max(a.y0, b.y0), std::min(a.x1, b.x1), std::min(a.y1, b.y1)};
}

PixelRegion grown(const PixelRegion& region, int margin) {
    return {region.x0 - margin, region.y0 - margin, region.x1 + margin, region.y1 + margin};
}

std::size_t pixel_count(const PixelRegion& region) {
    if (region.is_empty()) return 0;
    return static_cast<std::size_t>(region.width()) * static_cast<std::size_t>(region.height());
}

// Parts of the squares that the whole picture is divided into.
std::vector<PixelRegion> tiles_of(const PixelRegion& region) {
    std::vector<PixelRegion> tiles;
    if (region.is_empty()) return tiles;
    for (int y = region.y0 / tile_size * tile_size; y < region.y1; y += tile_size)
        for (int x = region.x0 / tile_size * tile_size; x < region.x1; x += tile_size)
            tiles.push_back(intersection({x, y, x + tile_size, y + tile_size}, region));
    return tiles;
}

// The even bits of a number, drawn together.
constexpr int even_bits(unsigned x) {
    x &= 0x5555u;
    x = (x | (x >> 1)) & 0x3333u;
    x = (x | (x >> 2)) & 0x0f0fu;
    return static_cast<int>((x | (x >> 4)) & 0x00ffu);
}

// The pixels of a block along the Z-shaped curve of Morton: those that stand next to each other in a packet are close together.
constexpr std::array<Place, most_rays> pixels_of_block = [] {
    std::array<Place, most_rays> pixels;
    for (unsigned code = 0; code < most_rays; ++code) pixels[code] = {even_bits(code), even_bits(code >> 1)};
    return pixels;
}();

bool is_in_block(Place place, const PixelRegion& block) { return place.x < block.width() && place.y < block.height(); }

// Visits a tile's pixels along the Z-shaped curve of Morton.
template <typename Visit>
void for_each_pixel(const PixelRegion& tile, Visit&& visit) {
    for (unsigned code = 0; code < tile_size * tile_size; ++code) {
        const int x = tile.x0 + even_bits(code);
        const int y = tile.y0 + even_bits(code >> 1);
        if (x < tile.x1 && y < tile.y1) visit(x, y);
    }
}

float to_float(double value) {
    constexpr double largest_float = std::numeric_limits<float>::max();
    const double from_below = value < largest_float ? value : largest_float;
    return static_cast<float>(from_below > -largest_float ? from_below : -largest_float);
}

// How many samples a pixel will still take if its error falls as it should.
std::uint64_t samples_to_come(const Pixel& pixel, double tolerance, std::uint32_t most) {
    std::uint64_t taken = pixel.taken;
    for (double error = pixel.error; error > tolerance && taken < most; error *= error_after_doubling) taken *= 2;
    return taken - pixel.taken;
}

void store(std::span<float> channels, double x, double y, double z) {
    channels[0] = to_float(x), channels[1] = to_float(y), channels[2] = to_float(z);
}

// Rays that wait to be traced together, and what each is for.
struct Batch {
    struct Purpose {
        Pixel* pixel = nullptr;
        PixelEstimate* estimate = nullptr;  // that the colour counts for; none where only the other layers are wanted
        bool layers = false;                // fills the other layers
        Place place;
    };
    std::array<CameraRays::Places, most_rays / batch_size> places;
    std::array<RayPacket, most_rays / batch_size> rays;
    std::array<RaySample, most_rays> samples;
    std::array<Purpose, most_rays> purposes;
    std::size_t size = 0;
    bool layers = false;  // some sample fills the other layers
};

// What a thread has for itself.
struct Worker {
    explicit Worker(std::unique_ptr<Integrand> i) : integrand(std::move(i)) {}

    std::unique_ptr<Integrand> integrand;
    std::unique_ptr<Batch> batch = std::make_unique<Batch>();
    std::vector<Pixel> tile;  // where pixels need no memory beyond their tile
    RenderReport report;      // of those
    std::uint64_t non_finite_samples = 0, spared_samples = 0;
};

// What the calling thread has used of a processor, in seconds.
double processor_time() {
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

// The middles of the pixels of a packet, and the keys of their first samples.
void set_middles(std::span<const Place, batch_size> pixels, std::uint32_t sequence, CameraRays::Places& places) {
    std::array<std::uint32_t, batch_size> x, y, key;
    for (std::size_t i = 0; i < batch_size; ++i) {
        x[i] = static_cast<std::uint32_t>(pixels[i].x), y[i] = static_cast<std::uint32_t>(pixels[i].y);
        places.x.v[i] = pixels[i].x + 0.5, places.y.v[i] = pixels[i].y + 0.5;
    }
    for (std::size_t i = 0; i < batch_size; ++i) key[i] = pixel_key(x[i], y[i], sequence);
    for (std::size_t i = 0; i < batch_size; ++i) places.key[i] = {key[i], 0};
}

class Passes {
public:
    Passes(const IntegrandMaker& make_integrand, const CameraRays& camera, const PixelFilter& filter, const SamplingPlan& plan,
           Frame& frame, const RenderOptions& options);

    RenderReport run();

private:
    void render_all();
    void preview();
    void sample_uniformly(int samples);
    void sample_adaptively();
    void sample_until_time_is_up();

    // One pass over the tiles of a region: every pixel takes samples up to its goal.
    void trace_goals(const PixelRegion& region);
    void trace_tile(const PixelRegion& tile, Worker& worker);
    void trace_samples(Place place, Pixel& pixel, PixelEstimate* negative, Worker& worker);
    void sample_tile(const PixelRegion& tile, int samples, Worker& worker);
    void sample_middles(const PixelRegion& tile, Worker& worker);
    void sample_middles_of_block(const PixelRegion& block, Worker& worker);
    void write_middles(const PixelRegion& block, Worker& worker);
    void flush(Worker& worker);
    void begin_tile(const PixelRegion& tile, Worker& worker) const;
    std::optional<Beam> beam_of_batch(const Batch& batch, std::size_t size) const;
    static bool spare(const std::optional<Beam>& beam, std::size_t size, Worker& worker);
    bool trace(Worker& worker, std::size_t size, bool layers) const;
    void preview_tile(const PixelRegion& tile, int block, Worker& worker);

    // Between passes.
    void set_goals(std::uint32_t goal);
    // Doubles the samples of pixels above the tolerance; false where there are none.
    bool refine_goals(const PixelRegion& region, double tolerance);
    bool may_go_on(const Pixel& pixel) const;
    bool may_not_rest(const Pixel& pixel, double tolerance) const;
    double estimated_error(int x, int y) const;
    double own_error(const Pixel& pixel) const;
    double error_around(int x, int y) const;
    double change_around(int x, int y) const;
    double moves_of(std::size_t pixel) const;
    Colour colour_of(std::size_t pixel) const;

    void write_pixels(const PixelRegion& tile);
    void write_pixel(Place place, const Pixel& pixel, const Colour& colour);
    void write_layers(Place place, const RaySample& sample);
    void announce(const PixelRegion& tile);
    void report_progress();
    RenderReport report();

    template <typename Body>
    void for_each_tile(const PixelRegion& region, Body&& body);
    std::size_t index_of(int x, int y) const {
        return static_cast<std::size_t>(y - area_.y0) * static_cast<std::size_t>(area_.width()) +
               static_cast<std::size_t>(x - area_.x0);
    }
    std::size_t tile_of(const PixelRegion& tile) const {
        const std::size_t in_row = (static_cast<std::size_t>(picture_.width()) + tile_size - 1) / tile_size;
        return static_cast<std::size_t>(tile.y0 / tile_size) * in_row + static_cast<std::size_t>(tile.x0 / tile_size);
    }
    bool is_in_region(int x, int y) const { return x >= region_.x0 && x < region_.x1 && y >= region_.y0 && y < region_.y1; }
    bool finishes_tiles_at_once() const { return plan_.samples == 1 || (plan_.samples > 1 && !filter_.has_negative_lobes()); }
    bool is_stopped() const;
    bool is_cancelled() const { return options_.cancel && options_.cancel->load(std::memory_order_relaxed); }
    bool is_time_up() const { return options_.time && elapsed() >= *options_.time; }
    Seconds now() const { return options_.clock ? options_.clock() : std::chrono::steady_clock::now().time_since_epoch(); }
    Seconds elapsed() const { return now() - begin_; }

    const CameraRays& camera_;
    const PixelFilter& filter_;
    const SamplingPlan& plan_;
    Frame& frame_;
    const RenderOptions& options_;

    Seconds begin_;
    std::optional<double> first_view_;
    std::uint32_t first_samples_ = 0;
    std::uint32_t most_samples_ = 0;             // where their number is not fixed
    int most_passes_ = 0;                        // after the first
    PixelRegion picture_;                        // all of it
    PixelRegion region_;                         // what is asked for
    PixelRegion area_;                           // with the margin that its estimates need
    std::vector<Pixel> pixels_;                  // of the area
    std::vector<PixelEstimate> negative_lobes_;  // of the area, for filters that have them
    std::vector<std::uint8_t> rests_;            // of each tile of the picture: whether all errors are within the tolerance
    bool wants_layers_ = false;

    bool is_previewing_ = false;  // the first coarse picture is being made
    std::atomic<bool> has_begun_{false};
    std::atomic<std::uint64_t> taken_samples_{0};
    std::atomic<double> processor_seconds_{0};
    std::uint64_t expected_samples_ = 0;  // as far as is known between passes

    tbb::enumerable_thread_specific<Worker> workers_;
    std::mutex announcing_;
};

// Enough even for a pixel of black and white noise, in which the error falls no faster than 1/2 n^-1/2.
std::uint32_t most_samples(const SamplingPlan& plan) {
    const double needed = std::pow(0.5 / plan.error, 2);
    if (plan.refine_until_time_is_up || !(needed < most_at_most)) return most_at_most;
    return std::max(fewest_at_most, std::bit_ceil(static_cast<std::uint32_t>(needed)));
}

std::uint32_t first_samples_of(const SamplingPlan& plan, const CameraRays& camera, const PixelFilter& filter) {
    const bool coarse = plan.error >= least_coarse_error && !plan.refine_until_time_is_up && !camera.has_lens();
    const std::uint32_t samples = filter.has_negative_lobes() ? first_samples_of_signed_filter
                                  : coarse                    ? first_samples_of_coarse_picture
                                                              : first_samples;
    // Every lens point has its turn.
    return std::max(samples, std::bit_ceil(static_cast<std::uint32_t>(camera.lens_points())));
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

    area_ = region_;
    if (plan.samples == 0) {
        most_samples_ = std::max(first_samples_, most_samples(plan));
        most_passes_ = std::countr_zero(most_samples_) - std::countr_zero(first_samples_);
        if (!region_.is_empty()) area_ = intersection(grown(region_, most_passes_ + 1), picture_);
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
    if (!finishes_tiles_at_once()) pixels_.resize(pixel_count(area_));
    rests_.resize(tiles_of(picture_).size());
    if (filter_.has_negative_lobes()) negative_lobes_.resize(pixels_.size());
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
    set_goals(static_cast<std::uint32_t>(samples));
    expected_samples_ = pixels_.size() * static_cast<std::size_t>(samples);
    trace_goals(region_);
}

void Passes::sample_adaptively() {
    set_goals(first_samples_);
    expected_samples_ = guessed_refinement * pixels_.size() * first_samples_;
    trace_goals(area_);

    for (int pass = 1; pass <= most_passes_ + 1 && !is_stopped(); ++pass) {
        const PixelRegion taking_part = intersection(grown(region_, most_passes_ - pass + 1), picture_);
        if (!refine_goals(taking_part, plan_.error)) break;
        trace_goals(taking_part);
    }
}

void Passes::sample_until_time_is_up() {
    // Something everywhere first, then the samples that estimates need.
    for (const std::uint32_t goal : {1u, first_samples_}) {
        set_goals(goal);
        trace_goals(region_);
    }
    // Each tolerance starts from what the one before it left.
    for (double tolerance = coarsest_tolerance; tolerance > finest_tolerance && !is_stopped(); tolerance /= 2) {
        std::fill(rests_.begin(), rests_.end(), std::uint8_t{0});
        while (!is_stopped() && refine_goals(region_, tolerance)) trace_goals(region_);
    }
}

template <typename Body>
void Passes::for_each_tile(const PixelRegion& region, Body&& body) {
    const std::vector<PixelRegion> tiles = tiles_of(region);
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, tiles.size(), 1),
        [&](const tbb::blocked_range<std::size_t>& range) {
            const double begin = processor_time();
            if (options_.on_begin && !is_previewing_ && !has_begun_.exchange(true)) options_.on_begin();
            for (std::size_t i = range.begin(); i != range.end() && !is_stopped(); ++i) body(tiles[i]);
            processor_seconds_ += processor_time() - begin;
        },
        tbb::simple_partitioner());
}

void Passes::trace_goals(const PixelRegion& region) {
    for_each_tile(region, [&](const PixelRegion& tile) {
        if (rests_[tile_of(tile)] != 0) return;
        std::uint64_t samples = 0;
        for_each_pixel(tile, [&](int x, int y) {
            const Pixel& pixel = pixels_[index_of(x, y)];
            samples += pixel.goal - pixel.taken;
        });
        if (samples == 0) return;

        trace_tile(tile, workers_.local());
        taken_samples_ += samples;
        report_progress();
        const PixelRegion shown = intersection(tile, region_);
        if (shown.is_empty()) return;
        write_pixels(shown);
        if (plan_.samples > 0 && !is_stopped()) frame_.count_finished(pixel_count(shown));
        announce(shown);
    });
}

// ---- rays ------------------------------------------------------------------------------------------------------------

void Passes::trace_tile(const PixelRegion& tile, Worker& worker) {
    begin_tile(tile, worker);
    worker.batch->size = 0;
    for_each_pixel(tile, [&](int x, int y) {
        const std::size_t index = index_of(x, y);
        PixelEstimate* negative = negative_lobes_.empty() ? nullptr : &negative_lobes_[index];
        if (!is_stopped()) trace_samples({x, y}, pixels_[index], negative, worker);
    });
    flush(worker);
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
    for_each_pixel(tile, [&](int x, int y) {
        Pixel& pixel = pixel_at(x, y);
        pixel.goal = static_cast<std::uint32_t>(samples);
        if (!is_stopped()) trace_samples({x, y}, pixel, nullptr, worker);
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
    for (int y = tile.y0; y < tile.y1; y += block_size)
        for (int x = tile.x0; x < tile.x1 && !is_stopped(); x += block_size)
            sample_middles_of_block(intersection({x, y, x + block_size, y + block_size}, tile), worker);
}

void Passes::sample_middles_of_block(const PixelRegion& block, Worker& worker) {
    Batch& batch = *worker.batch;
    if (spare(camera_.beam(block.x0 + 0.5, block.y0 + 0.5, block.x1 - 0.5, block.y1 - 0.5), pixel_count(block), worker)) {
        write_middles(block, worker);
        return;
    }

    std::array<Place, most_rays> pixels;
    std::size_t size = 0;
    pixels.fill({block.x0, block.y0});
    for (const Place& place : pixels_of_block)
        if (is_in_block(place, block)) pixels[size++] = {block.x0 + place.x, block.y0 + place.y};

    for (std::size_t begin = 0; begin < size; begin += batch_size) {
        CameraRays::Places& places = batch.places[begin / batch_size];
        set_middles(std::span(pixels).subspan(begin).first<batch_size>(), options_.sequence, places);
        if (camera_.has_lens())
            for (std::size_t i = 0; i < batch_size; ++i) places.lens[i] = camera_.lens_point(places.key[i]);
    }
    if (trace(worker, size, wants_layers_)) write_middles(block, worker);
}

// The samples of a block, one for each pixel, in the order of pixels_of_block.
void Passes::write_middles(const PixelRegion& block, Worker& worker) {
    const RaySample* sample = worker.batch->samples.data();
    for (const Place& place : pixels_of_block) {
        if (!is_in_block(place, block)) continue;
        const Place pixel{block.x0 + place.x, block.y0 + place.y};
        const bool finite = is_finite(sample->colour);
        const Colour colour = finite ? sample->colour : Colour::black();
        worker.non_finite_samples += !finite;
        store(frame_.pixel(Layer::colour, pixel.x, pixel.y), colour.r, colour.g, colour.b);
        if (frame_.has(Layer::samples)) frame_.pixel(Layer::samples, pixel.x, pixel.y)[0] = 1;
        if (wants_layers_) write_layers(pixel, *sample);
        ++sample;
    }
    worker.report.samples += pixel_count(block), worker.report.pixels += pixel_count(block);
}

// All of its rays, which filters may send beyond its pixels, lie in one beam.
void Passes::begin_tile(const PixelRegion& tile, Worker& worker) const {
    const double reach = std::max(0.5, filter_.radius());
    const std::optional<Beam> beam =
        camera_.beam(tile.x0 + 0.5 - reach, tile.y0 + 0.5 - reach, tile.x1 - 0.5 + reach, tile.y1 - 0.5 + reach);
    worker.integrand->begin_tile(beam ? &*beam : nullptr);
}

std::optional<Beam> Passes::beam_of_batch(const Batch& batch, std::size_t size) const {
    double x0 = infinity, x1 = -infinity, y0 = infinity, y1 = -infinity;
    for (std::size_t i = 0; i < size; ++i) {
        const CameraRays::Places& places = batch.places[i / batch_size];
        const double x = places.x.v[i % batch_size], y = places.y.v[i % batch_size];
        x0 = std::min(x0, x), x1 = std::max(x1, x), y0 = std::min(y0, y), y1 = std::max(y1, y);
    }
    return camera_.beam(x0, y0, x1, y1);
}

// Begins a part of a tile. Where it is known what its rays bring back, that becomes the batch's first samples: no ray is sent.
bool Passes::spare(const std::optional<Beam>& beam, std::size_t size, Worker& worker) {
    const std::optional<RaySample> known = worker.integrand->begin_part(beam ? &*beam : nullptr);
    if (!known) return false;
    std::fill_n(worker.batch->samples.begin(), size, *known);
    worker.spared_samples += size;
    return true;
}

// The first places of a batch. False where that was cancelled: paths may have ended on their way.
bool Passes::trace(Worker& worker, std::size_t size, bool layers) const {
    Batch& batch = *worker.batch;
    const std::size_t packets = (size + batch_size - 1) / batch_size;
    for (std::size_t p = 0; p < packets; ++p)
        camera_.rays(batch.places[p], static_cast<int>(std::min<std::size_t>(batch_size, size - p * batch_size)), batch.rays[p]);
    worker.integrand->trace(std::span(batch.rays).first(packets), std::span(batch.samples).first(size), layers);
    return !is_cancelled();
}

void Passes::trace_samples(Place place, Pixel& pixel, PixelEstimate* negative, Worker& worker) {
    const auto [x, y] = place;
    const auto queue = [this, &worker](double film_x, double film_y, DiscPoint lens, const SampleKey& key,
                                       const Batch::Purpose& purpose) {
        Batch& batch = *worker.batch;
        CameraRays::Places& places = batch.places[batch.size / batch_size];
        const std::size_t lane = batch.size % batch_size;
        places.x.v[lane] = film_x, places.y.v[lane] = film_y;
        places.lens[lane] = lens, places.key[lane] = key;
        batch.purposes[batch.size] = purpose;
        batch.layers |= purpose.layers;
        if (++batch.size == most_rays) flush(worker);
    };

    // The layers beside colour come from the pixel's centre.
    if (wants_layers_ && pixel.taken == 0 && is_in_region(x, y))
        queue(x + 0.5, y + 0.5, {}, sample_key(x, y, 0, options_.sequence), {&pixel, nullptr, true, place});

    const SampleKey first = sample_key(x, y, 0, options_.sequence);
    const SamplePairs in_pixel(first.pixel, dimension_pair::pixel);
    for (std::uint32_t sample = pixel.taken; sample < pixel.goal; ++sample) {
        if (worker.batch->size == 0 && is_stopped()) return;
        const SampleKey key{first.pixel, sample};
        const PixelFilter::Placement at = filter_.place(in_pixel[sample]);
        queue(x + 0.5 + at.x, y + 0.5 + at.y, camera_.lens_point(key), key,
              {&pixel, at.negative ? negative : &pixel.estimate, false, place});
    }
}

void Passes::flush(Worker& worker) {
    Batch& batch = *worker.batch;
    const std::size_t size = std::exchange(batch.size, 0);
    if (size == 0 || is_stopped()) return;
    const bool layers = std::exchange(batch.layers, false);
    if (!spare(beam_of_batch(batch, size), size, worker) && !trace(worker, size, layers)) return;

    // In the order of the samples, whatever the batches were.
    for (std::size_t i = 0; i < size; ++i) {
        const Batch::Purpose& purpose = batch.purposes[i];
        const RaySample& sample = batch.samples[i];
        if (purpose.layers) write_layers(purpose.place, sample);
        if (!purpose.estimate) continue;
        ++purpose.pixel->taken;
        if (!purpose.estimate->add(sample.colour)) ++worker.non_finite_samples;
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
            RaySample sample;
            worker.integrand->trace({&packet, 1}, {&sample, 1}, false);
            if (is_cancelled()) return;
            if (!is_finite(sample.colour)) continue;
            for (int py = painted.y0; py < painted.y1; ++py) {
                std::span<float> row = frame_.row(Layer::colour, painted.x0, painted.x1, py);
                for (; !row.empty(); row = row.subspan(3)) store(row, sample.colour.r, sample.colour.g, sample.colour.b);
            }
        }
    announce(tile);
}

// ---- estimates -------------------------------------------------------------------------------------------------------

Colour Passes::colour_of(std::size_t pixel) const {
    const PixelEstimate& estimate = pixels_[pixel].estimate;
    if (negative_lobes_.empty()) return estimate.mean();
    // (p·positive - n·negative) / (p - n), exact where both are equal.
    const PixelEstimate& negative = negative_lobes_[pixel];
    if (negative.count() == 0 || 2 * negative.count() > estimate.count()) return estimate.mean();
    const double weight = static_cast<double>(negative.count()) / (estimate.count() - negative.count());
    return estimate.mean() + weight * (estimate.mean() - negative.mean());
}

double Passes::estimated_error(int x, int y) const {
    const Pixel& pixel = pixels_[index_of(x, y)];
    const auto count = pixel.estimate.count();
    if (count == 0) return infinity;
    const double scale = brightness_scale(pixel.estimate.mean());
    if (plan_.samples > 0) return own_error(pixel);
    return std::max({error_from_spread(pixel.estimate.spread(), count), error_around(x, y), change_around(x, y)}) / scale;
}

// Of a fixed number of samples, every pixel by itself; a single sample does not tell how far it is off.
double Passes::own_error(const Pixel& pixel) const {
    const auto count = pixel.estimate.count();
    if (count < 2) return infinity;
    return error_from_spread(pixel.estimate.spread(), count) / brightness_scale(pixel.estimate.mean());
}

double Passes::error_around(int x, int y) const {
    const std::size_t index = index_of(x, y);
    const Colour colour = colour_of(index);
    double greatest_variance = 0, greatest_contrast = 0;  // the contrast squared
    const PixelRegion around = intersection({x - 1, y - 1, x + 2, y + 2}, area_);
    for (int ny = around.y0; ny < around.y1; ++ny)
        for (int nx = around.x0; nx < around.x1; ++nx) {
            const std::size_t neighbour = index_of(nx, ny);
            if (neighbour == index || pixels_[neighbour].estimate.count() == 0) continue;
            greatest_variance = std::max(greatest_variance, pixels_[neighbour].estimate.variance());
            greatest_contrast = std::max(greatest_contrast, squared_contrast(colour, colour_of(neighbour)));
        }
    return error_from_around(std::sqrt(greatest_variance), std::sqrt(greatest_contrast), pixels_[index].estimate.count());
}

double Passes::change_around(int x, int y) const {
    const std::uint32_t taken = pixels_[index_of(x, y)].taken;
    if (taken <= first_samples_) return 0;
    double squares = 0;
    int count = 0;
    const PixelRegion around = intersection({x - 1, y - 1, x + 2, y + 2}, area_);
    for (int ny = around.y0; ny < around.y1; ++ny)
        for (int nx = around.x0; nx < around.x1; ++nx) {
            const std::size_t index = index_of(nx, ny);
            if (pixels_[index].taken != taken) continue;
            squares += moves_of(index);
            ++count;
        }
    return std::sqrt(squares / count);
}

double Passes::moves_of(std::size_t pixel) const {
    return remembered_moves(pixels_[pixel].earlier_moves, contrast(pixels_[pixel].before, colour_of(pixel)));
}

void Passes::set_goals(std::uint32_t goal) {
    for (Pixel& pixel : pixels_) pixel.goal = goal;
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

bool Passes::refine_goals(const PixelRegion& region, double tolerance) {
    // All estimates first: they look at the neighbours' samples, which stay as they are meanwhile.
    for_each_tile(region, [&](const PixelRegion& tile) {
        if (rests_[tile_of(tile)] != 0) return;
        for_each_pixel(tile, [&](int x, int y) {
            Pixel& pixel = pixels_[index_of(x, y)];
            if (pixel.error > tolerance) pixel.error = to_float(estimated_error(x, y));
        });
    });

    std::atomic<std::uint64_t> to_come{0};
    std::atomic<std::size_t> going_on{0}, going_on_in_region{0};
    for_each_tile(region, [&](const PixelRegion& tile) {
        if (rests_[tile_of(tile)] != 0) return;
        std::uint64_t samples = 0;
        std::size_t pixels = 0, pixels_in_region = 0;
        bool rests = true;
        for_each_pixel(tile, [&](int x, int y) {
            Pixel& pixel = pixels_[index_of(x, y)];
            const bool too_early = may_not_rest(pixel, tolerance);
            const bool is_good = pixel.error <= tolerance && !too_early;
            rests &= is_good;
            if (is_good || !may_go_on(pixel)) return;
            samples += std::max<std::uint64_t>(pixel.taken, samples_to_come(pixel, tolerance, most_samples_));
            if (too_early) pixel.error = std::numeric_limits<float>::infinity();  // look again, whatever it seems now
            if (pixel.taken > first_samples_) pixel.earlier_moves = to_float(moves_of(index_of(x, y)));
            pixel.before = colour_of(index_of(x, y));
            pixel.goal = 2 * pixel.taken;
            pixels += 1;
            pixels_in_region += is_in_region(x, y);
        });
        rests_[tile_of(tile)] = rests ? 1 : 0;
        to_come += samples, going_on += pixels, going_on_in_region += pixels_in_region;
    });
    if (is_stopped()) return false;

    expected_samples_ = taken_samples_ + to_come;
    if (!plan_.refine_until_time_is_up) frame_.count_finished(pixel_count(region_) - going_on_in_region - frame_.finished());
    return going_on > 0;
}

// ---- the frame -------------------------------------------------------------------------------------------------------

void Passes::write_pixels(const PixelRegion& tile) {
    for (int y = tile.y0; y < tile.y1; ++y)
        for (int x = tile.x0; x < tile.x1; ++x) {
            const std::size_t index = index_of(x, y);
            if (pixels_[index].taken > 0) write_pixel({x, y}, pixels_[index], colour_of(index));
        }
}

void Passes::write_pixel(Place place, const Pixel& pixel, const Colour& colour) {
    const auto [x, y] = place;
    store(frame_.pixel(Layer::colour, x, y), colour.r, colour.g, colour.b);
    if (frame_.has(Layer::samples)) frame_.pixel(Layer::samples, x, y)[0] = static_cast<float>(pixel.taken);
}

void Passes::write_layers(Place place, const RaySample& sample) {
    const auto [x, y] = place;
    if (frame_.has(Layer::depth)) frame_.pixel(Layer::depth, x, y)[0] = static_cast<float>(sample.depth);
    if (frame_.has(Layer::normal)) store(frame_.pixel(Layer::normal, x, y), sample.normal.x, sample.normal.y, sample.normal.z);
    if (frame_.has(Layer::position))
        store(frame_.pixel(Layer::position, x, y), sample.position.x, sample.position.y, sample.position.z);
    if (frame_.has(Layer::object)) frame_.pixel(Layer::object, x, y)[0] = static_cast<float>(sample.object);
    if (frame_.has(Layer::material)) frame_.pixel(Layer::material, x, y)[0] = static_cast<float>(sample.material);
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

RenderReport Passes::report() {
    RenderReport report;
    report.pixels = pixel_count(region_);
    std::size_t sampled = 0;
    for (const Worker& worker : workers_) {
        report.samples += worker.report.samples, report.within_error += worker.report.within_error;
        sampled += worker.report.pixels;
    }
    for (int y = region_.y0; y < region_.y1 && !pixels_.empty(); ++y)
        for (int x = region_.x0; x < region_.x1; ++x) {
            Pixel& pixel = pixels_[index_of(x, y)];
            // Pixels that were stopped before they were looked at again have something to tell, too.
            const bool tells = plan_.samples > 0 ? pixel.taken > 0 : pixel.taken >= first_samples_ && std::isinf(pixel.error);
            if (tells) pixel.error = static_cast<float>(estimated_error(x, y));
            if (frame_.has(Layer::error)) frame_.pixel(Layer::error, x, y)[0] = pixel.error;
            report.samples += pixel.taken;
            report.within_error += pixel.error <= plan_.error;
            sampled += pixel.taken > 0;
        }

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

}  // namespace

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
