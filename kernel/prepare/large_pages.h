// SPDX-License-Identifier: MIT
//
// Memory for lists of many megabytes. The system hands out memory page by page, as it is touched first, and processors keep
// the places of few pages at hand: large pages are handed out in a third of the time, and to look something up here and there
// in them is quicker, too.
#pragma once

#include <cstddef>
#include <vector>

#include "kernel/export.h"

namespace lapidary {

// Asks the system to back memory that was not touched yet by large pages. No matter if it cannot.
LAPIDARY_API void ask_for_large_pages(void* memory, std::size_t bytes);

// Makes room in a list, in large pages where it is much.
template <class T>
void reserve_in_large_pages(std::vector<T>& list, std::size_t count) {
    if (count <= list.capacity()) return;
    list.reserve(count);
    ask_for_large_pages(list.data() + list.size(), (list.capacity() - list.size()) * sizeof(T));
}

}  // namespace lapidary
