// SPDX-License-Identifier: MIT
//
// The shortest way to a light that answers for a batch of points at once: the author writes two scalar functions,
//
//     Illumination from_middle(const Point& point) const;                              a light without extent
//     Illumination from_sample(const Point& point, const LightSample& sample) const;   a place on one that has it
//
// the second only where has_extent() may be true, and gets both forms of Light::toward from them. Kept inline and without calls,
// the compiler turns the loop over the points into vector instructions. (What is the same for all points belongs to
// schema.derive().)
#pragma once

#include "kernel/interfaces/light.h"

namespace lapidary {

template <class Kind>
class BatchedLight : public Light {
public:
    Illumination toward(const Point& point, const LightSample& sample) const final {
        if constexpr (may_have_extent())
            if (light().has_extent()) return light().from_sample(point, sample);
        return light().from_middle(point);
    }

    // All lanes are computed, whether asked for or not. `out` is promised to overlap neither the light nor the points.
    void toward_batch(const PointBatch& points, const LightSampleBatch& samples, int count,
                      IlluminationBatch* __restrict out) const final {
        if constexpr (may_have_extent())
            if (light().has_extent()) {
                for (int lane = 0; lane < count; ++lane)
                    out->set(lane, light().from_sample(points.point(lane), samples.sample(lane)));
                return;
            }
        for (int lane = 0; lane < batch_size; ++lane) out->set(lane, light().from_middle(points.point(lane)));
    }

private:
    static constexpr bool may_have_extent() {
        return requires(const Kind& kind, const Point& point, const LightSample& sample) { kind.from_sample(point, sample); };
    }
    const Kind& light() const { return static_cast<const Kind&>(*this); }
};

}  // namespace lapidary
