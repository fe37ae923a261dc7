// SPDX-License-Identifier: MIT
//
// Anchors the vtable of Light in the kernel and answers for lights that know one point at a time.
#include "kernel/interfaces/light.h"

namespace lapidary {

Light::~Light() = default;

void Light::toward_batch(const PointBatch& points, const LightSampleBatch& samples, int count, IlluminationBatch* out) const {
    for (int lane = 0; lane < count; ++lane) out->set(lane, toward(points.point(lane), samples.sample(lane)));
}

}  // namespace lapidary
