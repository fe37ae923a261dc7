// SPDX-License-Identifier: MIT
//
// T32: a ladder of gaps between two boxes. Gaps above what rounding leaves uncertain are seen, smaller ones are contact, and
// those within a thousand times of that are asked about.
#include <cmath>

#include "stress/exact.h"
#include "support/measurement.h"
#include "support/solids.h"

namespace lapidary::test {
namespace {

// Two unit boxes side by side at a coordinate, with a gap between them along x.
struct GapSeen {
    bool seen = false, asked_about = false;
};
GapSeen look_at_gap(double coordinate, double gap) {
    SolidMaker maker;
    const auto box = [&](double from, double shift) {
        return maker.leaf(
            "cube", {scale(0.5, 0.5, 0.5), translate(from + 0.5, 0, 0), translate(coordinate, 0, 0), translate(shift, 0, 0)});
    };
    SpansThrough spans(maker.combine(Operation::union_, {box(-1, 0), box(0, gap)}));
    const auto along = spans(ray_from({coordinate - 1.5, 0.1, 0.2}, {1, 0, 0}));
    return {along.size() == 2, spans.messages.warnings() > 0};
}

}  // namespace

TEST_CASE("T32: gaps down to rounding are seen, and those that may be mistakes are asked about") {
    for (const double coordinate : {1.0, 1e3, 1e6}) {
        CAPTURE(coordinate);
        Measurement ladder({"T32", "gaps between boxes", "", 0});
        const double size = coordinate + 2.5;  // distance and extent
        bool seen_before = true;
        double smallest_seen = infinity, largest_contact = 0;
        for (int k = 10; k <= 60; ++k) {
            const double gap = std::ldexp(1.0, -k);
            const GapSeen found = ladder.timed([&] { return look_at_gap(coordinate, gap); });
            ladder.expect(seen_before || !found.seen);  // what is seen is so from some size on
            // Asked about from contact up to a thousand times that.
            ladder.expect(found.asked_about == (found.seen && gap <= 1000 * 64 * u * size) ||
                          (gap > 500 * 64 * u * size && gap < 2000 * 64 * u * size));
            seen_before = found.seen;
            if (found.seen)
                smallest_seen = gap;
            else
                largest_contact = std::max(largest_contact, gap);
        }
        CHECK(smallest_seen > 32 * u * size);
        CHECK(largest_contact < 128 * u * size);
    }
}

}  // namespace lapidary::test
