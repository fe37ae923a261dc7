// SPDX-License-Identifier: MIT
//
// Scenes from text that are traced ray by ray, with every face that a path meets.
#pragma once

#include <bit>
#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "kernel/prepare/world.h"
#include "kernel/render/tracer.h"
#include "support/catch.h"
#include "support/scenes.h"

namespace lapidary::test {

// What one camera ray returned, and the faces that its paths met.
struct TracedRay {
    RaySample sample;
    std::vector<PathEvent> events;

    bool has_branch(std::uint64_t branch) const {
        for (const PathEvent& event : events)
            if (event.branch == branch) return true;
        return false;
    }

    // The faces on the way that goes through wherever it can and is mirrored where all light is. In a scene that is closed
    // by a wall: nothing escapes unseen.
    std::vector<PathEvent> main_path() const {
        std::vector<PathEvent> path;
        for (std::uint64_t branch = 1;;) {
            for (const PathEvent& event : events)
                if (event.branch == branch) path.push_back(event);
            if (has_branch(2 * branch + 1))
                branch = 2 * branch + 1;
            else if (has_branch(2 * branch))
                branch = 2 * branch;
            else
                return path;
        }
    }
};

class TracedScene {
public:
    explicit TracedScene(const std::string& text, double pixel_footprint = 0) : built_(build(text)) {
        for (const std::string& headline : built_->headlines()) UNSCOPED_INFO(headline);
        REQUIRE(built_->scene);
        world_ = prepare_world(*built_->scene, built_->messages);
        tracer_ = std::make_unique<Tracer>(*world_, built_->scene->render, pixel_footprint);
    }

    TracedRay trace(const Point& origin, const Vector& direction) {
        TracedRay traced;
        tracer_->observe([&](const PathEvent& event) { traced.events.push_back(event); });
        traced.sample = sample(origin, direction);
        tracer_->observe(nullptr);
        return traced;
    }

    RaySample sample(const Point& origin, const Vector& direction) {
        const Ray ray{origin, normalize(direction), {}, {}};
        RaySample result;
        tracer_->trace({&ray, 1}, {&result, 1});
        return result;
    }
    Colour colour(const Point& origin, const Vector& direction) { return sample(origin, direction).colour; }

    const World& world() const { return *world_; }
    const TraceStatistics& statistics() const { return tracer_->statistics(); }

private:
    std::unique_ptr<BuiltScene> built_;
    std::shared_ptr<const World> world_;
    std::unique_ptr<Tracer> tracer_;
};

// Clear matter of an index, as a scene writes it.
inline std::string glass(double index) { return "material { solid { refraction(" + std::to_string(index) + "); } } "; }

// A wall around everything within 50 units of the origin.
inline const std::string wall = "subtraction { sphere { radius(60); } } with { sphere { radius(50); } } ";

inline double largest_difference(const Colour& a, const Colour& b) {
    return std::max({std::fabs(a.r - b.r), std::fabs(a.g - b.g), std::fabs(a.b - b.b)});
}

}  // namespace lapidary::test
