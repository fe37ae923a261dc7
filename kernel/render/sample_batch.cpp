// SPDX-License-Identifier: MIT
#include "kernel/render/sample_batch.h"

#include <algorithm>

namespace lapidary {

std::size_t SampleBatch::take_part(const PixelRegion& part) {
    if (pixel_count(part) == pixels_of_part) {
        for (std::size_t i = 0; i < pixels_of_part; ++i) x[i] = part.x0 + places_in_part[i].x;
        for (std::size_t i = 0; i < pixels_of_part; ++i) y[i] = part.y0 + places_in_part[i].y;
        return pixels_of_part;
    }
    std::size_t count = 0;
    for (const PixelPlace& in_part : places_in_part) {
        const PixelPlace place{part.x0 + in_part.x, part.y0 + in_part.y};
        if (!is_in(place, part)) continue;
        x[count] = place.x, y[count] = place.y;
        ++count;
    }
    return count;
}

void SampleBatch::place(std::size_t count, const CameraRays& camera, const PixelFilter& filter, std::uint32_t sequence) {
    repeat_last(count);
    for (std::size_t p = 0; p * batch_size < count; ++p) {
        set_keys(p, camera, sequence);
        place_packet(p, filter);
    }
    if (!has_layers) return;
    for (std::size_t i = 0; i < count; ++i) {
        if (purpose[i] != Purpose::layers) continue;
        CameraRays::Places& of_packet = places[i / batch_size];
        const std::size_t lane = i % batch_size;
        of_packet.x.v[lane] = x[i] + 0.5, of_packet.y.v[lane] = y[i] + 0.5, of_packet.lens[lane] = {};
    }
}

std::size_t SampleBatch::place_in_middles(const PixelRegion& part, const CameraRays& camera,
                                          std::optional<std::uint32_t> sequence) {
    const std::size_t count = take_part(part);
    if (sequence) number.fill(0);
    repeat_last(count);
    for (std::size_t p = 0; p * batch_size < count; ++p) {
        if (sequence) set_keys(p, camera, *sequence);
        for (std::size_t i = 0; i < batch_size; ++i) {
            places[p].x.v[i] = x[p * batch_size + i] + 0.5;
            places[p].y.v[i] = y[p * batch_size + i] + 0.5;
        }
    }
    return count;
}

// In lanes without a ray.
void SampleBatch::repeat_last(std::size_t count) {
    for (std::size_t i = count; i % batch_size != 0; ++i)
        x[i] = x[count - 1], y[i] = y[count - 1], number[i] = number[count - 1], purpose[i] = purpose[count - 1];
}

void SampleBatch::repeat_last_place(std::size_t count) {
    const CameraRays::Places& last = places[(count - 1) / batch_size];
    const double last_x = last.x.v[(count - 1) % batch_size], last_y = last.y.v[(count - 1) % batch_size];
    for (std::size_t i = count; i % batch_size != 0; ++i) place_at(i, last_x, last_y);
}

void SampleBatch::set_keys(std::size_t packet, const CameraRays& camera, std::uint32_t sequence) {
    const std::size_t begin = packet * batch_size;
    std::array<std::uint32_t, batch_size> px, py, key;
    for (std::size_t i = 0; i < batch_size; ++i)
        px[i] = static_cast<std::uint32_t>(x[begin + i]), py[i] = static_cast<std::uint32_t>(y[begin + i]);
    for (std::size_t i = 0; i < batch_size; ++i) key[i] = pixel_key(px[i], py[i], sequence);
    CameraRays::Places& of_packet = places[packet];
    for (std::size_t i = 0; i < batch_size; ++i) of_packet.key[i] = {key[i], number[begin + i]};
    if (camera.has_lens())
        for (std::size_t i = 0; i < batch_size; ++i) of_packet.lens[i] = camera.lens_point(of_packet.key[i]);
}

void SampleBatch::place_packet(std::size_t packet, const PixelFilter& filter) {
    const std::size_t begin = packet * batch_size;
    CameraRays::Places& of_packet = places[packet];
    std::array<std::uint32_t, batch_size> key, sample;
    for (std::size_t i = 0; i < batch_size; ++i) key[i] = of_packet.key[i].pixel, sample[i] = of_packet.key[i].sample;
    std::array<SamplePair, batch_size> pairs;
    for (std::size_t i = 0; i < batch_size; ++i) pairs[i] = sample_pair({key[i], sample[i]}, dimension_pair::pixel);
    for (std::size_t i = 0; i < batch_size; ++i) {
        const PixelFilter::Placement at = filter.place(pairs[i]);
        of_packet.x.v[i] = x[begin + i] + 0.5 + at.x, of_packet.y.v[i] = y[begin + i] + 0.5 + at.y;
        if (at.negative && purpose[begin + i] == Purpose::colour) purpose[begin + i] = Purpose::negative_colour;
    }
}

std::optional<Beam> SampleBatch::beam(std::size_t count, const CameraRays& camera) const {
    Lanes x0, x1, y0, y1;
    x0.v.fill(infinity), y0.v.fill(infinity), x1.v.fill(-infinity), y1.v.fill(-infinity);
    for (std::size_t p = 0; p * batch_size < count; ++p)
        for (int i = 0; i < batch_size; ++i) {
            x0[i] = std::min(x0[i], places[p].x[i]), x1[i] = std::max(x1[i], places[p].x[i]);
            y0[i] = std::min(y0[i], places[p].y[i]), y1[i] = std::max(y1[i], places[p].y[i]);
        }
    return camera.beam(std::ranges::min(x0.v), std::ranges::min(y0.v), std::ranges::max(x1.v), std::ranges::max(y1.v));
}

std::span<const RayPacket> SampleBatch::rays_of(std::size_t count, const CameraRays& camera) {
    const std::size_t packets = (count + batch_size - 1) / batch_size;
    for (std::size_t p = 0; p < packets; ++p)
        camera.rays(places[p], static_cast<int>(std::min<std::size_t>(batch_size, count - p * batch_size)), rays[p]);
    return std::span(rays).first(packets);
}

}  // namespace lapidary
