// SPDX-License-Identifier: MIT
//
// Departure from a surface without a minimum distance: the surface's own root is known to be at 0, so it is set there or
// dropped, and which side the ray goes to is known from its direction and the normal.
#pragma once

#include <cmath>

#include "kernel/interfaces/object.h"

namespace lapidary {

// Takes the root of departure out of the spans of a leaf whose face the ray departs from. Going inward, the entry nearest to
// 0 is the place of departure: it becomes 0 exactly, and what lies before it is gone. Going outward, the nearest exit is, and
// all up to it is gone. Returns how many spans remain.
inline int remove_departure_root(Span* spans, int count, bool inward) {
    int departed = -1;
    double least = infinity, extent = 0;
    for (int i = 0; i < count; ++i) {
        const double distance = std::fabs(inward ? spans[i].in : spans[i].out);
        if (distance < least) least = distance, departed = i;
        if (distance < infinity) extent = std::fmax(extent, distance);
    }
    if (departed < 0) return count;
    // A convex solid has one entry and one exit: no doubt which one it is. Where there are several, rounding may have lost the
    // pair that the ray touches: then nothing is near 0, and nothing is to be removed.
    if (count > 1 && least > 1e-6 * extent) return count;

    int kept = 0;
    for (int i = inward ? departed : departed + 1; i < count; ++i) {
        if (i == departed) spans[i].in = 0;
        if (!spans[i].is_empty()) spans[kept++] = spans[i];
    }
    return kept;
}

// Turns sorted spans into the gaps between them, at most count + 1. Returns how many.
inline int complement(Span* spans, int count) {
    int kept = 0;
    double from = -infinity;
    for (int i = 0; i <= count; ++i) {
        const Span next = i < count ? spans[i] : Span{infinity, infinity};
        if (from < next.in) spans[kept++] = {from, next.in};
        from = next.out;
    }
    return kept;
}

}  // namespace lapidary
