// SPDX-License-Identifier: MIT
//
// Camera -> rays: a place in the picture and a place on the lens become a ray in the world.
//
// The camera's space is left-handed: x right, y up, z into the picture. With the location L, the unit vectors
// right, up and forward, the screen's distance D and size w × h, a picture of W × H pixels and a place (x, y) in pixels
// from the top left, the view through a pinhole runs along
//
//     v = forward + ((x/W - ½) w/D) right + ((½ - y/H) h/D) up.
//
// A thin lens of radius a at L sends every ray of a place through the one point L + f v in the plane that is sharp:
// from the lens point o = a (lx right + ly up) the direction is f v - o. A ray's origin is kept as L + o in two parts.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "kernel/csg/ray_packet.h"
#include "kernel/export.h"
#include "kernel/math/beam.h"
#include "kernel/render/ray.h"
#include "kernel/render/sampler.h"
#include "kernel/scene/camera.h"

namespace lapidary {

class LAPIDARY_API CameraRays {
public:
    CameraRays(const Camera& camera, int width, int height);

    // A place in the picture, in pixels from the top left, seen through a place on the lens. The ray's key is not set.
    Ray ray(double x, double y, DiscPoint lens = {}) const;

    // The same for the first `count` lanes of a packet; lanes beyond it repeat the first one.
    struct Places {
        Lanes x, y;
        std::array<DiscPoint, batch_size> lens;
        std::array<SampleKey, batch_size> key;
    };
    void rays(const Places& places, int count, RayPacket& packet) const;

    // What holds the rays of all places x0 <= x <= x1, y0 <= y <= y1, whatever rounding does; nothing for a lens, and for
    // parallel rays.
    std::optional<Beam> beam(double x0, double y0, double x1, double y1) const;

    // Which place on the lens a sample of a pixel takes: the beforehand calculated ones in turn, or a new one for each.
    DiscPoint lens_point(SampleKey key) const;

    bool has_lens() const { return has_lens_; }
    // How many places on the lens were calculated beforehand; 1 without a lens, 0: a new one for every ray.
    int lens_points() const { return has_lens_ ? static_cast<int>(lens_points_.size()) : 1; }

    // The angle that a pixel subtends at the picture's centre; 0 where rays are parallel.
    double pixel_footprint() const { return pixel_footprint_; }

    const Vector& right() const { return view_.right; }
    const Vector& up() const { return view_.up; }
    const Vector& forward() const { return view_.forward; }

private:
    // What the rays of all places share.
    struct View {
        Vector right, up, forward;
        double middle_x = 0.5, middle_y = 0.5;     // of the picture, in pixels
        double pixel_width = 1, pixel_height = 1;  // perspective: on the screen at distance 1; orthographic: in world units

        // From the middle of the picture to one of its places, at distance 1.
        Vector aside(double x, double y) const { return to_right(x) * right + to_top(y) * up; }
        double to_right(double x) const { return (x - middle_x) * pixel_width; }
        double to_top(double y) const { return (middle_y - y) * pixel_height; }
    };

    template <bool is_moderate>
    void direct_through_pinhole(const Places& places, VectorLanes& direction) const;
    void rays_through_pinhole(const Places& places, RayPacket& packet) const;
    void orient(const Camera& camera);
    void measure_screen(const Camera& camera, double picture_width, double picture_height);

    Camera::Projection projection_;
    Point location_;
    View view_;
    double screen_distance_ = 1;
    double focus_, lens_radius_;
    bool has_lens_;
    std::vector<DiscPoint> lens_points_;
    double pixel_footprint_ = 0;
};

}  // namespace lapidary
