// SPDX-License-Identifier: MIT
#include "kernel/render/frame.h"

#include <algorithm>
#include <cassert>

namespace lapidary {

namespace {

// In the order of the enumeration.
constexpr std::array<std::string_view, layer_count> names{"colour", "depth",    "normal",  "position",
                                                          "object", "material", "samples", "error"};

}  // namespace

std::string_view name_of(Layer layer) { return names[static_cast<std::size_t>(layer)]; }

Frame::Frame(int width, int height, LayerSet layers) : width_(width), height_(height) {
    assert(width > 0 && height > 0);
    layers.add(Layer::colour);
    const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    for (std::size_t i = 0; i < data_.size(); ++i) {
        const auto layer = static_cast<Layer>(i);
        if (layers.has(layer)) data_[i].resize(pixels * static_cast<std::size_t>(channels_of(layer)));
    }
}

std::span<const float> Frame::layer(Layer layer) const { return data_[static_cast<std::size_t>(layer)]; }

void Frame::raise_progress(double progress) {
    progress = std::min(progress, 1.0);
    double before = progress_.load(std::memory_order_relaxed);
    while (progress > before && !progress_.compare_exchange_weak(before, progress, std::memory_order_relaxed)) {
    }
}

}  // namespace lapidary
