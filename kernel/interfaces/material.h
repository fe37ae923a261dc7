// SPDX-License-Identifier: MIT
//
// The interface of matter: what any point of space would be made of.
#pragma once

#include <cstdint>
#include <memory>

#include "kernel/export.h"
#include "kernel/interfaces/object.h"
#include "kernel/math/colour.h"
#include "kernel/math/transform.h"
#include "kernel/math/vector.h"

namespace lapidary {

// Where matter is asked for, in the material's own space.
struct Site {
    Point point;
    double footprint = 0;  // about how wide a pixel is there, in the material's units; 0: infinitely sharp
};

struct Matter {
    Colour colour = Colour::white();  // diffuse; in a transparent medium what is left of white light after `depth`
    double reflection = 0;            // part of the result that is mirrored, 0 to 1
    double refraction = 0;            // refractive index; 0: opaque
    double shininess = 10;            // exponent of the highlight
    double opacity = 0;               // with refraction: part of the surface that is lit like an opaque one
    double depth = 1;                 // with refraction: the length over which colour is reached
    Vector relief;                    // bump times the gradient of the relief at the point

    bool is_transparent() const { return refraction > 0; }
};

// The same for a batch of places at once.
struct alignas(64) SiteBatch {
    PointBatch points;
    double footprint[batch_size];

    Site site(int lane) const { return {points.point(lane), footprint[lane]}; }
};

struct alignas(64) MatterBatch {
    double r[batch_size], g[batch_size], b[batch_size];  // colour
    double reflection[batch_size], refraction[batch_size], shininess[batch_size], opacity[batch_size], depth[batch_size];
    double relief_x[batch_size], relief_y[batch_size], relief_z[batch_size];

    Matter matter(int lane) const {
        return {{r[lane], g[lane], b[lane]},
                reflection[lane],
                refraction[lane],
                shininess[lane],
                opacity[lane],
                depth[lane],
                relief(lane)};
    }
    Vector relief(int lane) const { return {relief_x[lane], relief_y[lane], relief_z[lane]}; }
    void set(int lane, const Matter& m) {
        r[lane] = m.colour.r, g[lane] = m.colour.g, b[lane] = m.colour.b;
        reflection[lane] = m.reflection, refraction[lane] = m.refraction, shininess[lane] = m.shininess;
        opacity[lane] = m.opacity, depth[lane] = m.depth;
        set_relief(lane, m.relief);
    }
    void set_relief(int lane, const Vector& v) { relief_x[lane] = v.x, relief_y[lane] = v.y, relief_z[lane] = v.z; }
};

// A straight line through matter, in the material's own space: origin + t direction. The direction has any length.
struct MaterialLine {
    Point origin;
    Vector direction;

    Point at(double t) const { return origin + t * direction; }
};

// Where along a line matter changes abruptly, and the direction that stands on the boundary there (of any length and
// either sign).
struct Crossing {
    double t = infinity;  // infinity: nowhere
    Normal normal;
};

class LAPIDARY_API Material {
public:
    Material() = default;
    Material(const Material&) = delete;
    Material& operator=(const Material&) = delete;
    virtual ~Material();

    virtual Matter evaluate(const Site& site) const = 0;

    // The same for those lanes of a batch that are asked for, bit i of `lanes` for lane i and at least one of them; the others
    // are left as they are. The sites of all lanes may be read. The default asks evaluate() for each lane, and once where the
    // material is uniform.
    virtual void evaluate_batch(const SiteBatch& sites, unsigned lanes, MatterBatch& matter) const;

    // The first boundary with from < t < to between regions of different matter; boundaries of children count where the
    // child is in effect. A texture without abrupt changes has none: the default.
    virtual Crossing next_boundary(const MaterialLine& line, double from, double to) const;
    // Names the region that a point lies in: equal numbers on both sides of a point of a line mean that there is no
    // boundary between. For textures that look at their child through a warp.
    virtual std::uint64_t region(const Point& point) const;
    // A distance within which there is surely no boundary; may be smaller than the true one. The default: infinity.
    virtual double clearance(const Point& point) const;

    // Constant in space, relief included: lets the kernel skip the march and sample once.
    virtual bool is_uniform() const { return false; }
    // Whether matter changes abruptly anywhere: lets the kernel skip the march.
    virtual bool has_boundaries() const { return false; }
    // Whether any point of it may be transparent, mirror, or carry relief: what no material of a scene does is left
    // out of the inner loop.
    virtual bool may_be_transparent() const = 0;
    virtual bool may_reflect() const = 0;
    virtual bool may_have_relief() const = 0;
};

// For the statistics: a texture calls it where it takes the mean of so many octaves that are too fine to be seen.
LAPIDARY_API void count_faded_octaves(int octaves);
// All that the calling thread has counted.
LAPIDARY_API std::uint64_t octaves_faded_by_thread();

using MaterialPtr = std::shared_ptr<const Material>;

}  // namespace lapidary
