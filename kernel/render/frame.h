// SPDX-License-Identifier: MIT
//
// The picture under way: pixels in layers of linear floats, from the top left, row by row.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "kernel/export.h"
#include "kernel/render/zero_memory.h"

namespace lapidary {

enum class Layer : std::uint8_t {
    colour,    // 3 channels, linear Rec. 709
    depth,     // 1: distance along the ray to the first face, infinity where nothing is met
    normal,    // 3: unit shading normal in the world, toward the viewer
    position,  // 3: in the world
    object,    // 1: index of the solid (from 1, in the order of writing), 0 where nothing is met
    material,  // 1: index of the material (from 1), 0 where nothing is met
    samples,   // 1: rays spent on the pixel
    error      // 1: estimated error of the pixel
};
inline constexpr int layer_count = 8;

LAPIDARY_API std::string_view name_of(Layer layer);
constexpr int channels_of(Layer layer) {
    return layer == Layer::colour || layer == Layer::normal || layer == Layer::position ? 3 : 1;
}

class LayerSet {
public:
    LayerSet() = default;
    LayerSet(std::initializer_list<Layer> layers) {
        for (Layer layer : layers) add(layer);
    }
    void add(Layer layer) { bits_ |= 1u << static_cast<unsigned>(layer); }
    void add(LayerSet other) { bits_ |= other.bits_; }
    bool has(Layer layer) const { return (bits_ >> static_cast<unsigned>(layer)) & 1u; }
    bool is_empty() const { return bits_ == 0; }

private:
    std::uint32_t bits_ = 0;
};

class LAPIDARY_API Frame {
public:
    // Colour is always kept; other layers only where asked for.
    Frame(int width, int height, LayerSet layers);

    int width() const { return width_; }
    int height() const { return height_; }
    bool has(Layer layer) const { return !data_[static_cast<std::size_t>(layer)].empty(); }

    // The channels of one pixel of a layer that is kept.
    std::span<float> pixel(Layer layer, int x, int y) { return row(layer, x, x + 1, y); }
    std::span<const float> pixel(Layer layer, int x, int y) const { return row(layer, x, x + 1, y); }
    // The channels of pixels x0 <= x < x1 of a row.
    std::span<float> row(Layer layer, int x0, int x1, int y) {
        return std::span(data_[static_cast<std::size_t>(layer)]).subspan(place_of(layer, x0, y), floats_of(layer, x1 - x0));
    }
    std::span<const float> row(Layer layer, int x0, int x1, int y) const {
        return std::span(data_[static_cast<std::size_t>(layer)]).subspan(place_of(layer, x0, y), floats_of(layer, x1 - x0));
    }
    // A whole layer: width * height * channels_of(layer) floats.
    std::span<const float> layer(Layer layer) const;

    // How many pixels of the region to be rendered are final.
    void count_finished(std::size_t pixels) { finished_.fetch_add(pixels, std::memory_order_relaxed); }
    std::size_t finished() const { return finished_.load(std::memory_order_relaxed); }
    // How much of the expected work is done, 0 to 1. It never falls; what is still to come is estimated from the errors.
    void raise_progress(double progress);
    double progress() const { return progress_.load(std::memory_order_relaxed); }
    void set_complete(bool complete) { complete_ = complete; }
    bool is_complete() const { return complete_; }

private:
    static constexpr std::size_t floats_of(Layer layer, int pixels) {
        return static_cast<std::size_t>(pixels) * static_cast<std::size_t>(channels_of(layer));
    }
    std::size_t place_of(Layer layer, int x, int y) const {
        return static_cast<std::size_t>(y) * floats_of(layer, width_) + floats_of(layer, x);
    }

    int width_, height_;
    std::array<std::vector<float, ZeroMemory<float>>, layer_count> data_;
    std::atomic<std::size_t> finished_{0};
    std::atomic<double> progress_{0};
    bool complete_ = false;
};

}  // namespace lapidary
