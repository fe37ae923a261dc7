// SPDX-License-Identifier: MIT
//
// The interface of a light: what it sends toward a point, before shadow.
#pragma once

#include "kernel/export.h"
#include "kernel/math/colour.h"
#include "kernel/math/vector.h"

namespace lapidary {

struct Illumination {
    Vector direction;            // unit vector from the point toward the light; zero for light from everywhere
    double distance = infinity;  // to the light along it
    Colour radiance;             // black means: no light reaches the point, no shadow ray is needed
};

// A pair of numbers in [0, 1) that picks a place on a light with extent; (1/2, 1/2) is its middle.
struct LightSample {
    double u = 0.5, v = 0.5;
};

class LAPIDARY_API Light {
public:
    Light() = default;
    Light(const Light&) = delete;
    Light& operator=(const Light&) = delete;
    virtual ~Light();

    virtual Illumination toward(const Point& point, const LightSample& sample) const = 0;

    // Light from everywhere, without direction or shadow.
    virtual bool is_ambient() const { return false; }
    // A light with extent wants a sample of its own for every ray.
    virtual bool has_extent() const { return false; }
};

}  // namespace lapidary
