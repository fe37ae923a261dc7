// SPDX-License-Identifier: MIT
//
// Memory that is needed soon is asked for while there is something else to do.
#pragma once

#include <cstddef>

namespace lapidary {

// Inline, as g++ 12 takes calls of functions that do nothing but this for superfluous.
template <class T>
[[gnu::always_inline]] inline void ask_for(const T* object) {
    constexpr std::size_t cache_line = 64;
    for (std::size_t i = 0; i < sizeof(T); i += cache_line) __builtin_prefetch(reinterpret_cast<const char*>(object) + i);
}

}  // namespace lapidary
