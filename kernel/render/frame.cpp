// SPDX-License-Identifier: MIT
#include "kernel/render/frame.h"

#include <algorithm>
#include <cassert>

namespace lapidary {

namespace {

struct LayerTraits {
    std::string_view name;
    int channels;
};

// In the order of the enumeration.
constexpr std::array<LayerTraits, layer_count> layer_traits{{
    {"colour", 3},
    {"depth", 1},
    {"normal", 3},
    {"position", 3},
    {"object", 1},
    {"material", 1},
    {"samples", 1},
    {"error", 1},
}};

}  // namespace

std::string_view name_of(Layer layer) { return layer_traits[static_cast<std::size_t>(layer)].name; }

int channels_of(Layer layer) { return layer_traits[static_cast<std::size_t>(layer)].channels; }

Frame::Frame(int width, int height, LayerSet layers) : width_(width), height_(height) {
    assert(width > 0 && height > 0);
    layers.add(Layer::colour);
    const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    for (std::size_t i = 0; i < data_.size(); ++i) {
        const auto layer = static_cast<Layer>(i);
        if (layers.has(layer)) data_[i].resize(pixels * static_cast<std::size_t>(channels_of(layer)));
    }
}

std::span<float> Frame::row(Layer layer, int x0, int x1, int y) {
    const auto channels = static_cast<std::size_t>(channels_of(layer));
    return std::span(data_[static_cast<std::size_t>(layer)])
        .subspan(index_of(x0, y) * channels, static_cast<std::size_t>(x1 - x0) * channels);
}

std::span<const float> Frame::row(Layer layer, int x0, int x1, int y) const {
    const auto channels = static_cast<std::size_t>(channels_of(layer));
    return std::span(data_[static_cast<std::size_t>(layer)])
        .subspan(index_of(x0, y) * channels, static_cast<std::size_t>(x1 - x0) * channels);
}

std::span<float> Frame::pixel(Layer layer, int x, int y) { return row(layer, x, x + 1, y); }
std::span<const float> Frame::pixel(Layer layer, int x, int y) const { return row(layer, x, x + 1, y); }

std::span<const float> Frame::layer(Layer layer) const { return data_[static_cast<std::size_t>(layer)]; }

void Frame::raise_progress(double progress) {
    progress = std::min(progress, 1.0);
    double before = progress_.load(std::memory_order_relaxed);
    while (progress > before && !progress_.compare_exchange_weak(before, progress, std::memory_order_relaxed)) {
    }
}

}  // namespace lapidary
