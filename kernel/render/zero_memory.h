// SPDX-License-Identifier: MIT
//
// Memory for what there is one of for every pixel.
//
// It is zero because the system gives it so: pages that nothing is written to are never made, and the others by the threads that
// write to them. Of much memory the pages are large where the system has such: making and finding small ones is up to a tenth of
// the time that a simple picture takes, be it large or small.
#pragma once

#include <cstddef>
#include <limits>
#include <new>

#include "kernel/export.h"

namespace lapidary {

LAPIDARY_API void* allocate_zero(std::size_t bytes);  // throws std::bad_alloc
LAPIDARY_API void free_zero(void* memory, std::size_t bytes);

// For containers that make their elements.
template <class T>
struct PixelMemory {
    using value_type = T;
    PixelMemory() = default;
    template <class U>
    explicit PixelMemory(const PixelMemory<U>&) {}

    T* allocate(std::size_t count) {
        if (count > std::numeric_limits<std::size_t>::max() / sizeof(T)) throw std::bad_alloc();
        return static_cast<T*>(allocate_zero(count * sizeof(T)));
    }
    void deallocate(T* memory, std::size_t count) { free_zero(memory, count * sizeof(T)); }
    bool operator==(const PixelMemory&) const = default;
};

// For containers of numbers that are to be zero.
template <class T>
struct ZeroMemory : PixelMemory<T> {
    template <class U>
    void construct(U*) {}  // it is zero already
};

}  // namespace lapidary
