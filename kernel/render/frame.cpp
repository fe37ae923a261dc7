// SPDX-License-Identifier: MIT
#include "kernel/render/frame.h"

#include <sys/mman.h>

#include <algorithm>
#include <cassert>
#include <cstdlib>

namespace lapidary {

namespace {

// In the order of the enumeration.
constexpr std::array<std::string_view, layer_count> names{"colour", "depth",    "normal",  "position",
                                                          "object", "material", "samples", "error"};

}  // namespace

namespace {

constexpr std::size_t large_page = std::size_t{2} << 20;

std::size_t in_large_pages(std::size_t bytes) { return (bytes + large_page - 1) / large_page * large_page; }

}  // namespace

// Large pages begin at multiples of their size: more is mapped, and what lies before and behind is given back.
void* allocate_zero(std::size_t bytes) {
    if (bytes < large_page) {
        if (void* const memory = std::calloc(bytes, 1)) return memory;
        throw std::bad_alloc();
    }
    if (bytes > std::numeric_limits<std::size_t>::max() - 2 * large_page) throw std::bad_alloc();
    const std::size_t size = in_large_pages(bytes), mapped = size + large_page;
    void* const mapping = mmap(nullptr, mapped, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (mapping == MAP_FAILED) throw std::bad_alloc();
    auto* const begin = static_cast<std::byte*>(mapping);
    const std::size_t before = (large_page - reinterpret_cast<std::uintptr_t>(begin) % large_page) % large_page;
    if (before > 0) munmap(begin, before);
    if (before < large_page) munmap(begin + before + size, large_page - before);
    madvise(begin + before, size, MADV_HUGEPAGE);  // without such pages the others do
    return begin + before;
}

void free_zero(void* memory, std::size_t bytes) {
    if (bytes < large_page)
        std::free(memory);
    else
        munmap(memory, in_large_pages(bytes));
}

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
