// SPDX-License-Identifier: MIT
//
// The interface of a light: what it sends toward a point, before shadow.
#pragma once

#include <optional>

#include "kernel/export.h"
#include "kernel/interfaces/object.h"
#include "kernel/math/bounds.h"
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

// The same for a batch of points at once.
struct alignas(64) LightSampleBatch {
    double u[batch_size], v[batch_size];

    LightSample sample(int lane) const { return {u[lane], v[lane]}; }
};

struct alignas(64) IlluminationBatch {
    double direction_x[batch_size], direction_y[batch_size], direction_z[batch_size];
    double distance[batch_size];
    double r[batch_size], g[batch_size], b[batch_size];  // radiance

    Vector direction(int lane) const { return {direction_x[lane], direction_y[lane], direction_z[lane]}; }
    void set(int lane, const Illumination& i) {
        direction_x[lane] = i.direction.x, direction_y[lane] = i.direction.y, direction_z[lane] = i.direction.z;
        distance[lane] = i.distance;
        r[lane] = i.radiance.r, g[lane] = i.radiance.g, b[lane] = i.radiance.b;
    }
};

class LAPIDARY_API Light {
public:
    Light() = default;
    Light(const Light&) = delete;
    Light& operator=(const Light&) = delete;
    virtual ~Light();

    virtual Illumination toward(const Point& point, const LightSample& sample) const = 0;

    // The same for the first `count` lanes of a batch. The default asks toward() for each lane.
    virtual void toward_batch(const PointBatch& points, const LightSampleBatch& samples, int count, IlluminationBatch* out) const;

    // Light from everywhere, without direction or shadow.
    virtual bool is_ambient() const { return false; }
    // The box that all of its light comes from; nothing for light from far away, or where that is not known. Where nothing stands
    // between it and a face, no shadow rays are sent.
    virtual std::optional<Bounds> place() const { return std::nullopt; }
    // Whether any of it may come to a point in a box, if nothing stands between; false only where that is certain. Faces that no
    // light reaches are not asked one by one.
    virtual bool may_reach(const Bounds&) const { return true; }
    // A light with extent wants a sample of its own for every ray.
    virtual bool has_extent() const { return false; }
};

}  // namespace lapidary
