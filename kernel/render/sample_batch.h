// SPDX-License-Identifier: MIT
//
// Samples that wait to be traced together: which pixel each belongs to, where its ray goes through the picture and the lens, and
// what it brings back.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "kernel/render/camera_rays.h"
#include "kernel/render/filter.h"
#include "kernel/render/pixel_field.h"
#include "kernel/render/tile.h"
#include "kernel/render/tracer.h"

namespace lapidary {

struct SampleBatch {
    static constexpr std::size_t most = pixels_of_part;

    // What a ray is for: the colour of its pixel, the same in a negative lobe of the filter, or the layers beside it, which come
    // from the pixel's middle.
    enum class Purpose : std::uint8_t { colour, negative_colour, layers };

    std::array<int, most> x, y;  // of the pixels
    std::array<std::uint32_t, most> number;
    std::array<Pixel*, most> pixel;
    std::array<Purpose, most> purpose;
    std::size_t size = 0;
    bool has_layers = false;  // some ray is for them

    std::array<CameraRays::Places, most / batch_size> places;
    std::array<RayPacket, most / batch_size> rays;
    std::array<Colour, most> colours;
    std::array<FirstFace, most> faces;

    void add(PixelPlace place, std::uint32_t number_of_sample, Pixel* its_pixel, Purpose its_purpose) {
        const std::size_t i = size++;
        x[i] = place.x, y[i] = place.y;
        number[i] = number_of_sample, pixel[i] = its_pixel, purpose[i] = its_purpose;
    }

    // All bring back this colour, and meet nothing.
    void fill(std::size_t count, const Colour& colour, bool with_faces) {
        std::fill_n(colours.begin(), count, colour);
        if (with_faces) std::fill_n(faces.begin(), count, FirstFace{});
    }

    // The middles of the pixels of a part, in the order of places_in_part; how many they are. Their keys are set where anything
    // asks for them.
    std::size_t place_in_middles(const PixelRegion& part, const CameraRays& camera, std::optional<std::uint32_t> sequence);
    // Sets the places of the first `count` samples.
    void place(std::size_t count, const CameraRays& camera, const PixelFilter& filter, std::uint32_t sequence);

    // The place of a sample that belongs to no pixel.
    void place_at(std::size_t i, double at_x, double at_y) {
        places[i / batch_size].x.v[i % batch_size] = at_x, places[i / batch_size].y.v[i % batch_size] = at_y;
    }
    // After the last of them: lanes without a ray repeat it.
    void repeat_last_place(std::size_t count);

    // What holds the rays of those places, and the rays.
    std::optional<Beam> beam(std::size_t count, const CameraRays& camera) const;
    std::span<const RayPacket> rays_of(std::size_t count, const CameraRays& camera);

private:
    std::size_t take_part(const PixelRegion& part);
    void repeat_last(std::size_t count);
    void set_keys(std::size_t packet, const CameraRays& camera, std::uint32_t sequence);
    void place_packet(std::size_t packet, const PixelFilter& filter);
};

}  // namespace lapidary
