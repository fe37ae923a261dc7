// SPDX-License-Identifier: MIT
//
// 200 random solids of 2 to 40 leaves under random rotations, unequal scales and translations, seen from random places: every
// pixel's hit, leaf, distance, normal and shade against the brute-force oracle.
#include "csg_oracle.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <random>

#include "kernel/prepare/world.h"
#include "kernel/render/tracer.h"
#include "kernel/scene/scene.h"
#include "support/catch.h"
#include "support/measurement.h"
#include "support/scenes.h"

namespace lapidary::test {
namespace {

// Sanitizers slow everything down by an order of magnitude.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr int scenes = 20;
#else
constexpr int scenes = 200;
#endif
constexpr int width = 48, height = 36;
constexpr double tolerance = 1e-6;

constexpr double ambient = 0.1;
constexpr double sun = 0.6;
constexpr double lamp = 40;
const WideTriple to_sun = unit({-1, 2, -1.5L});
const WideTriple lamp_place{6, 3, -5};
constexpr const char* surroundings =
    "background(0.1, 0.2, 0.3);\n"
    "lights { ambient { intensity(0.1); } direct { direction(1, -2, 1.5); intensity(0.6); }\n"
    "         point { location(6, 3, -5); intensity(40); } }\n";

// The shading of a white light of that strength in the scene language: (diffuse, specular) parts.
std::pair<Wide, Wide> lit(const OracleHit& hit, const WideTriple& view, const WideTriple& to_light, Wide strength) {
    const Wide facing = dot(hit.normal, to_light);
    if (facing <= 0) return {0, 0};
    const WideTriple mirrored = along({-to_light[0], -to_light[1], -to_light[2]}, hit.normal, 2 * facing);
    const Wide specular = std::pow(std::max(dot(mirrored, view), 0.0L), 10.0L);
    return {strength * std::max(facing - specular, 0.0L), strength * specular};
}

// The colour of a face, with shadows. Becomes doubtful where a shadow is.
Colour shade(const CsgOracle& oracle, OracleHit& hit, const WideTriple& direction) {
    const WideTriple view{-direction[0], -direction[1], -direction[2]};
    Wide diffuse = ambient, specular = 0;
    const auto add = [&](const WideTriple& to_light, Wide distance, Wide strength) {
        const Wide facing = dot(hit.normal, to_light);
        if (std::fabs(facing) < 1e-6L) hit.doubtful = hit.doubtful || facing > -1e-9L;
        if (facing <= 0 || oracle.is_blocked(hit.point, to_light, distance, hit.doubtful)) return;
        const auto [d, s] = lit(hit, view, to_light, strength);
        diffuse += d;
        specular += s;
    };
    add(to_sun, std::numeric_limits<Wide>::infinity(), sun);
    const WideTriple way = along(lamp_place, hit.point, -1);
    const Wide distance = std::sqrt(dot(way, way));
    add(unit(way), distance, lamp / (distance * distance));
    return static_cast<double>(diffuse) * oracle.colour(hit.material) + Colour::grey(static_cast<double>(specular));
}

struct Tally {
    std::size_t pixels = 0, hits = 0, excused = 0, wrong = 0;
    std::string first_wrong;
};

bool close(const Colour& a, const Colour& b) {
    return std::fabs(a.r - b.r) < tolerance && std::fabs(a.g - b.g) < tolerance && std::fabs(a.b - b.b) < tolerance;
}

// What is wrong about a pixel; nothing: all is right.
std::string compare(const CsgOracle& oracle, const Ray& ray, const RaySample& sample, Tally& tally) {
    const WideTriple origin{ray.origin.anchor.x, ray.origin.anchor.y, ray.origin.anchor.z};
    const WideTriple direction{ray.direction.x, ray.direction.y, ray.direction.z};
    OracleHit hit = oracle.first_hit(origin, direction);
    const Colour colour = hit.hit ? shade(oracle, hit, direction) : Colour{0.1, 0.2, 0.3};
    ++tally.pixels;
    tally.hits += hit.hit;
    if (hit.doubtful) {
        ++tally.excused;
        return {};
    }
    if (hit.hit != (sample.object > 0)) return fmt::format("hit {} instead of {}", sample.object > 0, hit.hit);
    if (!hit.hit) return close(colour, sample.colour) ? "" : "not the background";
    if (sample.object != hit.leaf + 1) return fmt::format("leaf {} instead of {}", sample.object, hit.leaf + 1);
    if (std::fabs(static_cast<double>(hit.t) - sample.depth) > tolerance)
        return fmt::format("distance {} instead of {}", sample.depth, static_cast<double>(hit.t));
    const WideTriple normal{sample.normal.x, sample.normal.y, sample.normal.z};
    const WideTriple off = along(hit.normal, normal, -1);
    if (dot(off, off) > Wide(tolerance) * tolerance)
        return fmt::format("normal off by {}", std::sqrt(static_cast<double>(dot(off, off))));
    if (!close(colour, sample.colour))
        return fmt::format("colour ({}, {}, {}) instead of ({}, {}, {})", sample.colour.r, sample.colour.g, sample.colour.b,
                           colour.r, colour.g, colour.b);
    return {};
}

// Rays of a pinhole camera at a random place outside, toward the middle.
std::vector<Ray> camera_rays(const CsgOracle& oracle, std::mt19937_64& random) {
    std::normal_distribution<> normal;
    for (int attempt = 0; attempt < 100; ++attempt) {
        const Vector out = normalize(Vector{normal(random), normal(random), normal(random)});
        const Point eye = to_point(7 * out);
        if (oracle.contains({eye.x, eye.y, eye.z})) continue;
        const Vector right = normalize(cross(out, {0.3, 1, 0.2})), up = cross(right, out);
        std::vector<Ray> rays(static_cast<std::size_t>(width * height));
        for (int i = 0; i < width * height; ++i) {
            const double x = (i % width + 0.5) / width - 0.5, y = 0.5 - (i / width + 0.5) / height;
            rays[static_cast<std::size_t>(i)].origin = eye;
            rays[static_cast<std::size_t>(i)].direction = normalize(-out + 0.8 * x * right + 0.6 * y * up);
        }
        return rays;
    }
    return {};
}

TEST_CASE("every pixel of random solids is what brute force says") {
    std::mt19937_64 random(20050401);
    Tally tally;
    test::Measurement pixels({"T24", "pixels of random solids", "", 0});
    for (int scene = 0; scene < scenes;) {
        const int leaves = 2 + scene % 39;
        const CsgOracle oracle(leaves, random);
        const std::vector<Ray> rays = camera_rays(oracle, random);
        if (rays.empty()) continue;  // its matter is everywhere
        ++scene;

        const std::string text = surroundings + ("objects {\n" + oracle.text() + "}\n");
        const auto built = build(text);
        INFO(text);
        REQUIRE(built->headlines() == std::vector<std::string>{});
        const auto world = prepare_world(*built->scene, built->messages);
        Tracer tracer(*world, built->scene->render, 0);
        std::vector<RaySample> samples(rays.size());
        pixels.timed([&] { return tracer.trace(rays, samples), 0; }, rays.size());

        for (std::size_t i = 0; i < rays.size(); ++i) {
            const std::string what = compare(oracle, rays[i], samples[i], tally);
            pixels.expect(what.empty());
            if (what.empty()) continue;
            ++tally.wrong;
            if (tally.first_wrong.empty()) tally.first_wrong = fmt::format("scene {}, pixel {}: {}", scene, i, what);
            UNSCOPED_INFO(fmt::format("scene {}, pixel {}: {}", scene, i, what));
        }
        CHECK(tally.wrong == 0);
        if (tally.wrong > 0) break;
    }
    CAPTURE(tally.pixels, tally.hits, tally.excused);
    CHECK(tally.hits > tally.pixels / 10);
    CHECK(tally.excused <= tally.pixels / 100000);
}

}  // namespace
}  // namespace lapidary::test
