// SPDX-License-Identifier: MIT
#include "kernel/prepare/large_pages.h"

#include <sys/mman.h>
#include <unistd.h>

#include <memory>

namespace lapidary {

void ask_for_large_pages(void* memory, std::size_t bytes) {
    constexpr std::size_t worth_asking = std::size_t{4} << 20;
    const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
    if (bytes < worth_asking || !std::align(page, worth_asking / 2, memory, bytes)) return;
    madvise(memory, bytes - bytes % page, MADV_HUGEPAGE);
}

}  // namespace lapidary
