// SPDX-License-Identifier: MIT
//
// The shortest way to a light that answers for a batch of points at once: the author writes two scalar functions,
//
//     Illumination from_middle(const Point& point) const;                              a light without extent
//     Illumination from_sample(const Point& point, const LightSample& sample) const;   a place on one that has it
//
// the second only where has_extent() may be true, and gets both forms of Light::toward from them. Kept inline and without calls,
// the compiler turns the loop over the points into vector instructions.
//
// What is the same for all points can be computed once for a batch: a light with a member function common() gets what that
// returns as last argument of both functions.
#pragma once

#include <type_traits>

#include "kernel/interfaces/light.h"

namespace lapidary {

template <class Kind>
class BatchedLight : public Light {
public:
    Illumination toward(const Point& point, const LightSample& sample) const final {
        const auto shared = common();
        if constexpr (may_have_extent())
            if (light().has_extent()) return sampled(point, sample, shared);
        return middle(point, shared);
    }

    // All lanes are computed, whether asked for or not. `out` is promised to overlap neither the light nor the points.
    void toward_batch(const PointBatch& points, const LightSampleBatch& samples, int count,
                      IlluminationBatch* __restrict out) const final {
        const auto shared = common();
        if constexpr (may_have_extent())
            if (light().has_extent()) {
                for (int lane = 0; lane < count; ++lane)
                    out->set(lane, sampled(points.point(lane), samples.sample(lane), shared));
                return;
            }
        for (int lane = 0; lane < batch_size; ++lane) out->set(lane, middle(points.point(lane), shared));
    }

private:
    struct Nothing {};

    auto common() const {
        if constexpr (requires(const Kind& kind) { kind.common(); })
            return light().common();
        else
            return Nothing{};
    }
    static constexpr bool may_have_extent() {
        return requires(const Kind& kind, const Point& point, const LightSample& sample) { kind.from_sample(point, sample); }
        || requires(const Kind& kind, const Point& point, const LightSample& sample) {
            kind.from_sample(point, sample, kind.common());
        };
    }
    template <class Shared>
    Illumination middle(const Point& point, const Shared& shared) const {
        if constexpr (std::is_same_v<Shared, Nothing>)
            return light().from_middle(point);
        else
            return light().from_middle(point, shared);
    }
    template <class Shared>
    Illumination sampled(const Point& point, const LightSample& sample, const Shared& shared) const {
        if constexpr (std::is_same_v<Shared, Nothing>)
            return light().from_sample(point, sample);
        else
            return light().from_sample(point, sample, shared);
    }
    const Kind& light() const { return static_cast<const Kind&>(*this); }
};

}  // namespace lapidary
