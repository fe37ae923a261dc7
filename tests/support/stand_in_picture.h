// SPDX-License-Identifier: MIT
//
// A picture that is a formula, to test sampling without a tracer: balls before a checkered floor that runs to the horizon.
#pragma once

#include <atomic>
#include <cmath>
#include <cstdint>
#include <memory>
#include <vector>

#include "kernel/render/passes.h"

namespace lapidary {

// Parallel rays along z, where a pixel is a unit of the world.
inline CameraRays camera_of_unit_pixels(int width, int height) {
    Camera description;
    description.projection = Camera::Projection::orthographic;
    description.screen_height = height;
    return CameraRays(description, width, height);
}

struct StandInPicture {
    int width = 96, height = 72;
    bool soft_shadow = false;
    std::atomic<std::int64_t>* traced = nullptr;  // counts the rays, if given

    // `light` picks a place on the light; it matters to the soft shadow only.
    Colour at(double x, double y, SamplePair light = {}) const {
        for (int i = 0; i < 6; ++i) {
            const double radius = 4 + 3 * (i % 4);
            const double dx = (x - width * std::fmod(0.13 + 0.37 * i, 1)) / radius,
                         dy = (y - height * std::fmod(0.2 + 0.29 * i, 0.6)) / radius;
            const double r2 = dx * dx + dy * dy;
            if (r2 < 1) return (0.1 + 0.9 * std::fmax(0, 0.7 * std::sqrt(1 - r2) - 0.5 * dx - 0.5 * dy)) * tint(i);
        }
        const double below = y - 0.65 * height;
        if (below <= 0) return {0.2, 0.3, 0.5};
        const double away = 40 / (below + 1);
        const bool even = std::fmod(std::floor((x - width / 2.0) * away / 20) + std::floor(8 * away) + 1000, 2) == 0;
        return shadow(x, y, light) * Colour::grey(even ? 0.8 : 0.1);
    }

    Frame frame(LayerSet layers = {}) const { return Frame(width, height, layers); }

    RenderReport render(Frame& frame, SamplingPlan plan, const RenderOptions& options = {},
                        const PixelFilter& filter = {RenderSettings::Filter::box, 0.5}) const {
        const CameraRays camera = camera_of_unit_pixels(width, height);
        plan.lights_are_sampled = soft_shadow;
        return render_passes([this] { return std::make_unique<Rays>(*this); }, camera, filter, plan, frame, options);
    }

private:
    class Rays final : public Integrand {
    public:
        explicit Rays(const StandInPicture& picture) : picture_(picture) {}
        void trace(std::span<const RayPacket> rays, std::span<Colour> colours, std::span<FirstFace> faces) override {
            if (picture_.traced) *picture_.traced += std::ssize(colours);
            for (std::size_t i = 0; i < colours.size(); ++i) {
                const Ray ray = rays[i / batch_size].ray(static_cast<int>(i % batch_size));
                const Point p = ray.origin.rounded();
                const double x = p.x + picture_.width / 2.0, y = picture_.height / 2.0 - p.y;
                colours[i] = picture_.at(x, y, sample_pair(ray.key, dimension_pair::first_light));
                if (faces.empty()) continue;
                faces[i].position = {x, y, 0};
                faces[i].object = static_cast<int>(x) + 1;
            }
        }

    private:
        const StandInPicture& picture_;
    };

    static Colour tint(int i) { return {0.3 + 0.05 * i, 0.9 - 0.06 * i, 0.5}; }

    double shadow(double x, double y, SamplePair light) const {
        if (!soft_shadow) return 1;
        const double dx = x + 20 * (light.u - 0.5) - 0.4 * width, dy = 2 * (y + 10 * (light.v - 0.5) - 0.8 * height);
        return dx * dx + dy * dy < 400 ? 0.2 : 1;
    }
};

}  // namespace lapidary
