// SPDX-License-Identifier: MIT
//
// Memory for lists of many megabytes. The system hands out memory page by page, as it is touched first, and processors keep
// the places of few pages at hand: large pages are handed out in a third of the time, and to look something up here and there
// in them is quicker, too. A virtual machine, though, that has to ask for them itself takes up to four times as long as for small
// ones: what is made in a tenth of a second does without.
#pragma once

#include <cstddef>

#include "kernel/export.h"

namespace lapidary {

// Asks the system to back memory that was not touched yet by large pages. No matter if it cannot.
LAPIDARY_API void ask_for_large_pages(void* memory, std::size_t bytes);

}  // namespace lapidary
