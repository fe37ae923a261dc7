// SPDX-License-Identifier: MIT
//
// What the passes of passes.h share.
#pragma once

#include <oneapi/tbb/enumerable_thread_specific.h>
#include <oneapi/tbb/parallel_for.h>

#include <atomic>
#include <chrono>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "kernel/render/edge_field.h"
#include "kernel/render/edge_grid.h"
#include "kernel/render/passes.h"
#include "kernel/render/pixel_field.h"
#include "kernel/render/sample_batch.h"

namespace lapidary {

using Seconds = std::chrono::duration<double>;

inline void store(std::span<float> channels, double x, double y, double z) {
    channels[0] = to_float(x), channels[1] = to_float(y), channels[2] = to_float(z);
}

// What a thread has for itself.
struct Worker {
    explicit Worker(std::unique_ptr<Integrand> i) : integrand(std::move(i)) {}

    std::unique_ptr<Integrand> integrand;
    std::unique_ptr<SampleBatch> batch = std::make_unique<SampleBatch>();
    std::unique_ptr<EdgeGrid> grid;  // where edges are followed
    std::vector<Pixel> tile;         // where pixels need no memory beyond their tile
    RenderReport report;             // of those
    struct Doubling {
        PixelPlace place;
        Colour before;        // the pixel's colour until now
        float earlier_moves;  // of it
    };
    std::vector<Doubling> doublings;  // of a tile's pixels, in this pass
    std::uint64_t non_finite_samples = 0, spared_samples = 0;
};

// What the calling thread has used of a processor, in seconds.
double processor_time();

class Passes {
public:
    static constexpr int margin_of_edges = 3;              // how far around a pixel there is anything that its edges depend on
    static constexpr int rounds_of_waking_by_samples = 6;  // each comes a pixel further

    Passes(const IntegrandMaker& make_integrand, const CameraRays& camera, const PixelFilter& filter, const SamplingPlan& plan,
           Frame& frame, const RenderOptions& options);

    RenderReport run();

private:
    void render_all();
    void preview();
    void sample_uniformly(int samples);
    void sample_adaptively();
    void sample_until_time_is_up();

    // A coarse picture, before any samples are taken (passes_along_edges.cpp).
    void follow_edges();
    void sample_all_middles();
    void follow_edges_of_tile(const PixelRegion& tile, bool is_first);
    void follow_between_middles(const PixelRegion& tile, PixelSet& restless, Worker& worker);
    void look_beside_middles(const PixelRegion& tile, PixelSet& restless, Worker& worker);
    void look_beside(std::span<const PixelPlace> pixels, PixelSet& restless, Worker& worker);
    void follow_in_finer_grid(const PixelRegion& tile, int fineness, PixelSet& restless, Worker& worker);
    SamplePairs sample_places(PixelPlace pixel) const;
    void probe(PixelPlace pixel, EdgeGrid& grid) const;
    bool trace_grid(const PixelRegion& tile, Worker& worker);
    bool trace_places(std::span<const EdgeGrid::Place> places, Worker& worker);
    void keep_estimate(PixelPlace place, const EdgeGrid::Estimate& estimate, int fineness);
    void note_move(PixelPlace place, double move);
    void write_followed(PixelPlace place);
    void wake_beside_moves(const PixelRegion& tile);
    bool sample_left_over();
    bool has_left_over(const PixelRegion& region);
    void begin_with_left_over(const PixelRegion& region);
    bool wake_beside_samples(const PixelRegion& region);
    void find_pixels_beside_samples(const PixelRegion& tile, PixelSet& woken);
    void report_of_edges(RenderReport& report, std::size_t& sampled);
    void show(const PixelRegion& tile);

    // One pass over the tiles of a region: every pixel that does not rest takes samples up to the goal, or else doubles them.
    void trace_pixels(const PixelRegion& region, std::optional<std::uint32_t> goal);
    std::uint64_t trace_tile(const PixelRegion& tile, std::optional<std::uint32_t> goal, Worker& worker);
    void take_samples(PixelPlace place, Pixel& pixel, std::uint32_t goal, Worker& worker);
    void sample_tile(const PixelRegion& tile, int samples, Worker& worker);
    void sample_middles(const PixelRegion& tile, Worker& worker);
    void sample_middles_of_part(const PixelRegion& part, Worker& worker);
    void write_middles(const PixelRegion& part, Worker& worker);
    bool shows_colours_only(const PixelRegion& part) const;
    bool write_colours(const PixelRegion& part, Worker& worker);
    void ask_for_colours(const PixelRegion& part);
    std::ptrdiff_t row_of_colours() const;
    void paint(const PixelRegion& part, const Colour& colour);
    void flush(Worker& worker);
    void begin_tile(const PixelRegion& tile, Worker& worker) const;
    void begin_tile(const PixelRegion& tile, double reach, Worker& worker) const;
    static std::optional<Colour> spare(const std::optional<Beam>& beam, bool in_quarters, std::size_t size, Worker& worker);
    bool trace(Worker& worker, std::size_t size, bool layers) const;
    void preview_tile(const PixelRegion& tile, int block, Worker& worker);

    // Between passes.
    // Lets pixels rest that are within the tolerance; false where no other one may take samples.
    bool look_at_errors(const PixelRegion& region, double tolerance);
    bool may_not_rest(const Pixel& pixel, double tolerance) const;
    bool may_go_on(const Pixel& pixel) const;
    std::uint32_t goal_of(const Pixel& pixel, std::optional<std::uint32_t> goal) const;
    void wake_all();
    double own_error(const Pixel& pixel) const;
    void estimate_what_was_stopped();

    void write_pixel(PixelPlace place, const Pixel& pixel, const Colour& colour);
    void write_layers(PixelPlace place, const FirstFace& face);
    void announce(const PixelRegion& tile);
    void report_progress();
    RenderReport report();

    template <typename Body>
    void for_each_tile(const PixelRegion& region, Body&& body);
    // Of the picture's tiles, the one that a place is in.
    std::size_t tile_number(PixelPlace place) const {
        const std::size_t in_row = (static_cast<std::size_t>(picture_.width()) + tile_size - 1) / tile_size;
        return static_cast<std::size_t>(place.y / tile_size) * in_row + static_cast<std::size_t>(place.x / tile_size);
    }
    // With a margin, as far as the picture goes.
    PixelRegion around_region(int margin) const { return intersection(grown(region_, margin), picture_); }
    PixelSet& restless_pixels_of(const PixelRegion& tile) { return restless_[tile_number({tile.x0, tile.y0})]; }
    float greatest_move_in(const PixelRegion& tile) const { return greatest_moves_[tile_number({tile.x0, tile.y0})]; }
    // For a coarse picture, the middles of the pixels reveal edges. They stand for the pixels where nothing else varies within
    // one.
    bool begins_with_middles() const { return begins_with_middles_; }
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
    std::uint32_t most_samples_ = 0;     // where their number is not fixed
    int most_passes_ = 0;                // after the first
    PixelRegion picture_;                // all of it
    PixelRegion region_;                 // what is asked for
    PixelRegion area_;                   // with the margin that its estimates need
    PixelField pixels_;                  // of the area, where samples are taken
    EdgeField edges_;                    // of the area, where edges are followed
    std::vector<float> greatest_moves_;  // of colours along edges, in each tile of the picture
    std::vector<PixelSet> restless_;     // of each tile of the picture: the pixels whose errors are not within the tolerance
    bool wants_layers_ = false;
    bool begins_with_middles_ = false;

    bool is_previewing_ = false;  // the first coarse picture is being made
    std::atomic<bool> has_begun_{false};
    std::atomic<std::uint64_t> taken_samples_{0};
    std::atomic<double> processor_seconds_{0};
    std::uint64_t expected_samples_ = 0;  // as far as is known between passes

    tbb::enumerable_thread_specific<Worker> workers_;
    std::mutex announcing_;
};

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

}  // namespace lapidary
