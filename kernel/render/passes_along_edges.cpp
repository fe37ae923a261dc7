// SPDX-License-Identifier: MIT
//
// A coarse picture from the middles of its pixels and from edges that are followed between them (edge_grid.h), finer and finer
// where that does not tell enough. What a finer grid finds wakes the pixels beside it, of which a coarser one told all seemed
// well. What even the finest does not tell takes samples, which wake those beside them in turn: so is followed what is thinner
// than a pixel, like a wire, once some pixel has found it.
#include <algorithm>
#include <array>
#include <bit>
#include <utility>

#include "kernel/math/vector.h"
#include "kernel/render/passes_implementation.h"

namespace lapidary {

namespace {

// Changes that are too small to matter are not looked into. Those within a finer cell are of a smaller part of the pixel.
constexpr double least_part = 0.5;
// What moved a neighbour's colour when it was looked at more closely may reach into a pixel.
constexpr double part_of_move_around = 0.5;
constexpr double part_left_after_surprise = 1.0 / 3;
// A tangled pixel is followed further where the finest grid might leave out no more than this part of the error asked for, as
// patterns leave out as much of smaller cells. Others take samples at once: glass, textures and crowds of small solids reach an
// error in a tenth to a fifth less time by that.
constexpr double least_part_to_give_up = 0.5;
// For smaller errors, what is smaller than a pixel and lies between all middles matters. With one look beside each of them, as
// much of it is found as by two samples.
constexpr double least_error_by_middles_alone = 0.02;
constexpr int rounds_of_waking = Passes::margin_of_edges - 1;

}  // namespace

void Passes::follow_edges() {
    sample_all_middles();
    const auto taking_part = [&](int passes_done) {
        return around_region(most_passes_ + rounds_of_waking_by_samples + margin_of_edges - passes_done);
    };
    for_each_tile(taking_part(0), [&](const PixelRegion& tile) { follow_edges_of_tile(tile, true); });
    for (int round = 1; round <= rounds_of_waking && !is_stopped(); ++round) {
        for_each_tile(taking_part(round), [&](const PixelRegion& tile) { wake_beside_moves(tile); });
        for_each_tile(taking_part(round), [&](const PixelRegion& tile) { follow_edges_of_tile(tile, false); });
    }
}

void Passes::sample_all_middles() {
    for_each_tile(area_, [&](const PixelRegion& tile) {
        sample_middles(tile, workers_.local());
        taken_samples_ += pixel_count(tile);
        report_progress();
        show(tile);
    });
}

void Passes::show(const PixelRegion& tile) {
    const PixelRegion shown = intersection(tile, region_);
    if (!shown.is_empty()) announce(shown);
}

// ---- grids -----------------------------------------------------------------------------------------------------------

// All there is to follow at once, as far as no neighbour has anything to say in it.
void Passes::follow_edges_of_tile(const PixelRegion& tile, bool is_first) {
    Worker& worker = workers_.local();
    if (!worker.grid) worker.grid = std::make_unique<EdgeGrid>();
    PixelSet& restless = restless_pixels_of(tile);
    if (is_first) follow_between_middles(tile, restless, worker);
    if (is_first && plan_.error < least_error_by_middles_alone) look_beside_middles(tile, restless, worker);
    if (restless.is_empty()) return;
    for (int fineness = 2; fineness <= EdgeGrid::greatest_fineness && !is_stopped(); fineness *= 2)
        follow_in_finer_grid(tile, fineness, restless, worker);
    report_progress();
    show(tile);
}

void Passes::follow_between_middles(const PixelRegion& tile, PixelSet& restless, Worker& worker) {
    EdgeGrid& grid = *worker.grid;
    grid.begin({tile.x0, tile.y0}, 1, least_part * plan_.error);
    // Beyond the picture's border everything is as at it.
    const int left = std::max(tile.x0 - 1, 0), right = std::min(tile.x1, picture_.x1 - 1);
    for (int y = tile.y0 - 1; y <= tile.y1; ++y) {
        const int row = std::clamp(y, 0, picture_.y1 - 1);
        grid.know_middles({left, y}, edges_.middles_from({left, row}, right - left + 1));
        if (left == tile.x0) grid.know_middle({left - 1, y}, edges_.middle_of({left, row}));
        if (right < tile.x1) grid.know_middle({right + 1, y}, edges_.middle_of({right, row}));
    }
    grid.want_all(tile);
    if (!trace_grid(tile, worker)) return;
    restless.clear();
    for (int y = tile.y0; y < tile.y1; ++y)
        for (std::uint64_t left_of_row = grid.changes_in_row(y); left_of_row != 0; left_of_row &= left_of_row - 1) {
            const PixelPlace place{tile.x0 + std::countr_zero(left_of_row), y};
            keep_estimate(place, grid.estimate(place), 1);
            if (!(edges_[place].error <= plan_.error)) restless.add(place);
        }
}

// In pixels around whose middles nothing changes.
void Passes::look_beside_middles(const PixelRegion& tile, PixelSet& restless, Worker& worker) {
    PixelSet calm;
    for (int y = tile.y0; y < tile.y1; ++y)
        for (int x = tile.x0; x < tile.x1; ++x)
            if ((worker.grid->changes_in_row(y) >> (x - tile.x0) & 1) == 0) calm.add({x, y});
    if (calm.is_empty() || is_stopped()) return;

    begin_tile(tile, worker);
    std::array<PixelPlace, SampleBatch::most> pixels;
    std::size_t count = 0;
    const auto look = [&] { look_beside(std::span(pixels).first(std::exchange(count, 0)), restless, worker); };
    calm.for_each(tile, [&](PixelPlace pixel) {
        pixels[count++] = pixel;
        if (count == pixels.size()) look();
    });
    if (count > 0) look();
}

void Passes::look_beside(std::span<const PixelPlace> pixels, PixelSet& restless, Worker& worker) {
    std::array<EdgeGrid::Place, SampleBatch::most> places;
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        const auto [u, v] = sample_places(pixels[i])[0];
        places[i] = {pixels[i].x + u, pixels[i].y + v};
    }
    if (!trace_places(std::span(places).first(pixels.size()), worker)) return;
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        const PixelPlace& pixel = pixels[i];
        const Colour middle = to_colour(edges_.middle_of(pixel)), found = worker.batch->colours[i];
        const double surprise = is_finite(found) ? contrast(found, middle) / brightness_scale(middle) : infinity;
        EdgeField::Followed& followed = edges_[pixel];
        ++followed.rays;
        if (frame_.has(Layer::samples) && is_in(pixel, region_)) write_followed(pixel);
        if (surprise <= plan_.error) continue;
        followed.error = to_float(surprise), followed.is_surprising = true;
        note_move(pixel, surprise);
        restless.add(pixel);
    }
}

void Passes::follow_in_finer_grid(const PixelRegion& tile, int fineness, PixelSet& restless, Worker& worker) {
    EdgeGrid& grid = *worker.grid;
    grid.begin({tile.x0, tile.y0}, fineness, least_part * plan_.error * fineness);
    restless.for_each(tile, [&](PixelPlace place) {
        if (edges_[place].fineness >= fineness || edges_[place].is_given_up) return;
        grid.know_middle(place, edges_.middle_of(place));
        grid.want(place);
        if (fineness == 2) probe(place, grid);
    });
    if (!trace_grid(tile, worker)) return;
    restless.remove_if(
        tile, [](PixelPlace) {},
        [&](PixelPlace place, std::size_t) {
            if (edges_[place].fineness < fineness && !edges_[place].is_given_up)
                keep_estimate(place, grid.estimate(place), fineness);
            return edges_[place].error <= plan_.error;
        });
}

// Where in a pixel it would take its samples, one in each quarter first.
SamplePairs Passes::sample_places(PixelPlace pixel) const {
    return SamplePairs(sample_key(pixel.x, pixel.y, 0, options_.sequence).pixel, dimension_pair::pixel);
}

void Passes::probe(PixelPlace pixel, EdgeGrid& grid) const {
    const SamplePairs pairs = sample_places(pixel);
    for (std::uint32_t quarter = 0; quarter < 4; ++quarter) {
        const auto [u, v] = pairs[quarter];
        grid.probe({pixel.x + u, pixel.y + v});
    }
}

// False where that was stopped.
bool Passes::trace_grid(const PixelRegion& tile, Worker& worker) {
    constexpr double reach = 1;  // cells between middles begin at those of the pixels around
    bool has_begun = false;
    for (std::span places = worker.grid->ask(); !places.empty(); places = worker.grid->ask()) {
        if (!std::exchange(has_begun, true)) begin_tile(tile, reach, worker);
        for (std::size_t first = 0; first < places.size(); first += SampleBatch::most) {
            const std::span batch = places.subspan(first, std::min(SampleBatch::most, places.size() - first));
            if (!trace_places(batch, worker)) return false;
            for (std::size_t i = 0; i < batch.size(); ++i) worker.grid->tell(first + i, worker.batch->colours[i]);
        }
    }
    return !is_stopped();
}

// At most as many as a batch holds. False where that was stopped.
bool Passes::trace_places(std::span<const EdgeGrid::Place> places, Worker& worker) {
    SampleBatch& batch = *worker.batch;
    const std::size_t size = places.size();
    for (std::size_t i = 0; i < size; ++i) batch.place_at(i, places[i].x, places[i].y);
    batch.repeat_last_place(size);
    if (is_stopped()) return false;
    if (const std::optional<Colour> known = spare(batch.beam(size, camera_), false, size, worker))
        batch.fill(size, *known, false);
    else if (!trace(worker, size, false))
        return false;
    for (std::size_t i = 0; i < size; ++i) worker.non_finite_samples += !is_finite(batch.colours[i]);
    taken_samples_ += size;
    return true;
}

void Passes::keep_estimate(PixelPlace place, const EdgeGrid::Estimate& estimate, int fineness) {
    EdgeField::Followed& followed = edges_[place];
    const Colour before = to_colour(edges_.colour_of(place));
    const double move = fineness == 1 ? 0 : contrast(before, estimate.colour) / brightness_scale(estimate.colour);
    note_move(place, move);
    // A pattern can hide from grids that it fits: once it has shown, none is believed that knows nothing of it.
    const double left = followed.is_surprising ? part_left_after_surprise * followed.error : 0;
    followed.error = to_float(std::max(left, error_from_grid(estimate.error, move, fineness)));
    followed.is_surprising = estimate.is_surprising;
    followed.rays = static_cast<std::uint16_t>(followed.rays + estimate.rays);
    const double error_from_finest = followed.error * fineness / EdgeGrid::greatest_fineness;
    followed.is_given_up = estimate.is_tangled && error_from_finest > least_part_to_give_up * plan_.error;
    edges_.keep_colour(place, to_floats(estimate.colour), fineness);
    if (is_in(place, region_)) write_followed(place);
}

void Passes::note_move(PixelPlace place, double move) {
    float& greatest = edges_[place].move;
    greatest = std::max(greatest, to_float(move));
    float& in_tile = greatest_moves_[tile_number(place)];
    in_tile = std::max(in_tile, greatest);
}

void Passes::write_followed(PixelPlace place) {
    const Colour colour = to_colour(edges_.colour_of(place));
    const auto [r, g, b] = is_finite(colour) ? colour : Colour::black();
    store(frame_.pixel(Layer::colour, place.x, place.y), r, g, b);
    if (frame_.has(Layer::samples)) frame_.pixel(Layer::samples, place.x, place.y)[0] = edges_[place].rays;
}

// ---- waking ----------------------------------------------------------------------------------------------------------

void Passes::wake_beside_moves(const PixelRegion& tile) {
    const auto may_reach = [&](float move, int fineness) {
        return part_of_move_around * move / std::max(1, fineness) > plan_.error;
    };
    const PixelRegion around = intersection(grown(tile, 1), edges_.area());
    if (std::ranges::none_of(tiles_of(around), [&](const PixelRegion& part) { return may_reach(greatest_move_in(part), 1); }))
        return;
    for (int y = tile.y0; y < tile.y1; ++y)
        for (int x = tile.x0; x < tile.x1; ++x) {
            const int fineness = edges_[{x, y}].fineness;
            if (fineness == EdgeGrid::greatest_fineness) continue;
            const PixelRegion beside = intersection({x - 1, y - 1, x + 2, y + 2}, around);
            if (may_reach(edges_.greatest_move_in(beside), fineness)) restless_pixels_of(tile).add({x, y});
        }
}

// ---- what is left over -------------------------------------------------------------------------------------------------

// Each round of waking comes a pixel further. False where nothing is left over, or that was stopped.
bool Passes::sample_left_over() {
    const auto taking_part = [&](int rounds_done) {
        return around_region(most_passes_ + 1 + rounds_of_waking_by_samples - rounds_done);
    };
    if (is_stopped() || !has_left_over(taking_part(0))) return false;
    begin_with_left_over(taking_part(0));
    trace_pixels(taking_part(0), first_samples_);
    for (int round = 1; round <= rounds_of_waking_by_samples && wake_beside_samples(taking_part(round)); ++round)
        trace_pixels(taking_part(round), first_samples_);
    return !is_stopped();
}

bool Passes::has_left_over(const PixelRegion& region) {
    return std::ranges::any_of(tiles_of(region), [&](const PixelRegion& tile) { return !restless_pixels_of(tile).is_empty(); });
}

void Passes::begin_with_left_over(const PixelRegion& region) {
    pixels_.resize(area_, false);
    for_each_tile(region, [&](const PixelRegion& tile) {
        const PixelSet& restless = restless_pixels_of(tile);
        for (int y = tile.y0; y < tile.y1; ++y)
            for (int x = tile.x0; x < tile.x1; ++x) {
                const EdgeField::Followed& followed = edges_[{x, y}];
                Pixel& pixel = pixels_[PixelPlace{x, y}];
                pixel.followed = followed.rays, pixel.error = followed.error;
                if (!restless.contains({x, y})) pixel.begin_with(to_colour(edges_.colour_of({x, y})));
            }
    });
}

// Pixels that edges told of, beside those of which samples tell something else: they take samples, too. False where there are
// none.
bool Passes::wake_beside_samples(const PixelRegion& region) {
    std::vector<PixelSet> woken(restless_.size());
    const auto woken_of = [&](const PixelRegion& tile) -> PixelSet& { return woken[tile_number({tile.x0, tile.y0})]; };
    for_each_tile(region, [&](const PixelRegion& tile) { find_pixels_beside_samples(tile, woken_of(tile)); });
    std::atomic<bool> any{false};
    for_each_tile(region, [&](const PixelRegion& tile) {
        if (woken_of(tile).is_empty()) return;
        any = true;
        woken_of(tile).for_each(tile, [&](PixelPlace place) {
            restless_pixels_of(tile).add(place);
            pixels_[place] = Pixel{};
            pixels_[place].followed = edges_[place].rays;
        });
    });
    return any && !is_stopped();
}

void Passes::find_pixels_beside_samples(const PixelRegion& tile, PixelSet& woken) {
    const PixelSet& sampled = restless_pixels_of(tile);
    for (const PixelRegion& part : tiles_of(intersection(grown(tile, 1), area_)))
        restless_pixels_of(part).for_each(part, [&](PixelPlace place) {
            const Pixel& pixel = pixels_[place];
            if (pixel.taken == 0) return;
            const Colour colour = pixel.estimate.mean();
            const double move = contrast(to_colour(edges_.colour_of(place)), colour) / brightness_scale(colour);
            if (!(part_of_move_around * move > plan_.error)) return;
            const PixelRegion beside = intersection({place.x - 1, place.y - 1, place.x + 2, place.y + 2}, tile);
            for (int y = beside.y0; y < beside.y1; ++y)
                for (int x = beside.x0; x < beside.x1; ++x)
                    if (!sampled.contains({x, y})) woken.add({x, y});
        });
}

void Passes::report_of_edges(RenderReport& report, std::size_t& sampled) {
    for (const PixelRegion& tile : tiles_of(region_)) {
        const PixelSet& restless = restless_pixels_of(tile);
        const bool all_rest = restless.is_empty();
        for (int y = tile.y0; y < tile.y1; ++y)
            for (int x = tile.x0; x < tile.x1; ++x) {
                const EdgeField::Followed& followed = edges_[{x, y}];
                // Nothing is known of pixels that were stopped before their edges were followed.
                const bool is_unknown = !all_rest && followed.fineness == 0 && restless.contains({x, y});
                const float error = is_unknown ? static_cast<float>(infinity) : followed.error;
                if (frame_.has(Layer::error)) frame_.pixel(Layer::error, x, y)[0] = error;
                report.samples += followed.rays;
                report.within_error += error <= plan_.error;
                sampled += followed.rays > 0;
            }
    }
}

}  // namespace lapidary
