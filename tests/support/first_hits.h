// SPDX-License-Identifier: MIT
//
// Where rays first meet a World, as a picture would see it: through the hierarchy, once in packets and once one by one.
#pragma once

#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "kernel/prepare/world.h"
#include "kernel/render/tracer.h"
#include "support/measurement.h"

namespace lapidary::test {

class FirstHits {
public:
    explicit FirstHits(const World& world) : tracer_(world, settings_, 0) {}

    // The distance of each ray's first face; infinity where there is none.
    std::vector<double> distances(std::span<const Ray> rays, bool one_by_one) {
        std::vector<RaySample> samples(rays.size());
        tracer_.trace_one_by_one(one_by_one);
        tracer_.trace(rays, samples);
        std::vector<double> found;
        for (const RaySample& sample : samples) found.push_back(sample.depth);
        return found;
    }

    // Expects of all rays that they meet first, one by one and in packets, what their spans say: not a bit may differ. What is
    // met from inside may be a face between two solids, which spans do not tell of. A span that rounding has left without any
    // length may be seen or not, alike by both.
    void expect(Measurement& measured, std::span<const Ray> rays, std::span<const std::vector<Span>> spans) {
        const std::vector<double> single = distances(rays, true), packets = distances(rays, false);
        for (std::size_t i = 0; i < rays.size(); ++i) {
            const bool outside = spans[i].empty() || spans[i][0].in > 0;
            measured.expect(same_bits(single[i], packets[i]) && (!outside || is_first(single[i], spans[i])));
        }
    }

private:
    static bool is_first(double t, const std::vector<Span>& spans) {
        for (const Span& span : spans) {
            if (same_bits(t, span.in)) return true;
            if (span.in < span.out) return false;
        }
        return same_bits(t, infinity);
    }
    static bool same_bits(double a, double b) { return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b); }

    RenderSettings settings_;
    Tracer tracer_;
};

}  // namespace lapidary::test
