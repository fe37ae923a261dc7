// SPDX-License-Identifier: MIT
//
// Coincident faces: solids that share a face, or all of themselves, give exactly the picture of the closed form of what they are
// together. Each also with the second copy placed through another chain of rotations, so that no two numbers need be equal.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "kernel/prepare/world.h"
#include "kernel/render/tracer.h"
#include "support/catch.h"
#include "support/scenes.h"

namespace lapidary {
namespace {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr int width = 96, height = 72;
#else
constexpr int width = 640, height = 480;
#endif

// What stands in the way of the shade: only geometry is asked for here.
constexpr const char* surroundings = "lights { ambient { intensity(1); } }\n";

struct Picture {
    std::vector<Ray> rays;
    std::vector<RaySample> samples;
};

// A camera that looks at the origin from above, the left and the front.
Picture trace(const std::string& objects) {
    const auto built = test::build(std::string(surroundings) + "objects {\n" + objects + "\n}\n");
    INFO(objects);
    REQUIRE(built->scene);
    const auto world = prepare_world(*built->scene, built->messages);
    Picture picture;
    picture.rays.resize(static_cast<std::size_t>(width * height));
    const Point eye{-2.6, 3.1, -5.7};
    const Vector forward = normalize(Point{} - eye), right = normalize(cross({0, 1, 0}, forward)), up = cross(forward, right);
    for (int i = 0; i < width * height; ++i) {
        const double x = (i % width + 0.5) / width - 0.5, y = 0.5 - (i / width + 0.5) / height;
        Ray& ray = picture.rays[static_cast<std::size_t>(i)];
        ray.origin = eye;
        ray.direction = normalize(forward + 0.96 * x * right + 0.72 * y * up);
    }
    picture.samples.resize(picture.rays.size());
    Tracer tracer(*world, built->scene->render, 0);
    tracer.trace(picture.rays, picture.samples);
    return picture;
}

// How many pixels of one picture show something else than the other: hit or miss, distance, normal or colour.
std::size_t count_differences(const Picture& a, const Picture& b) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < a.samples.size(); ++i) {
        const RaySample &p = a.samples[i], &q = b.samples[i];
        const bool hit = p.object > 0;
        const Vector bend = to_vector(p.normal) - to_vector(q.normal);
        const bool same = hit == (q.object > 0) &&
                          (!hit || (std::fabs(p.depth - q.depth) < 1e-9 && length(bend) < 1e-6 && p.colour == q.colour));
        count += !same;
    }
    return count;
}

std::size_t count_hits(const Picture& picture) {
    return static_cast<std::size_t>(
        std::count_if(picture.samples.begin(), picture.samples.end(), [](const RaySample& s) { return s.object > 0; }));
}

// Chains that are all one rotation, in exact arithmetic: in one, two, three and five steps.
const std::vector<std::string> chains{
    "rotx(0.3); roty(0.7);",
    "rotx(0.1); rotx(0.2); roty(0.7);",
    "rotx(0.9); rotx(-0.6); roty(0.1); roty(0.6);",
    "inverse { roty(-0.7); rotx(-0.3); }",
    "rotx(0.3); rotate(0, 1, 0, 0.7);",
    "scale(3); rotx(0.3); scale(1/3); translate(0.1, 0.2, 0.3); translate(-0.1, -0.2, -0.3); roty(0.2); roty(0.5);",
};

std::string place(const std::string& object, const std::string& chain) {
    return "union { " + object + " transform { " + chain + " } }";
}

const std::vector<std::string> primitives{
    "sphere { }",
    "cube { size(1, 0.8, 1.2); }",
    "plane { thickness(0.7); }",
    "cylinder { radius(0.7); }",
    "cylinder { radius(0.9); height(1.6); }",
    "halfspace { }",
    "cone { }",
    "cone { radii(1, 0.5); height(1.4); }",
    "torus { radii(1, 0.35); }",
};

TEST_CASE("A minus A is nothing, A and A is A, A symdiff A is nothing, A or A is A") {
    for (const std::string& primitive : primitives) {
        const std::string a = place(primitive, chains[0]);
        const Picture alone = trace(a);
        REQUIRE(count_hits(alone) > 1000 * static_cast<std::size_t>(width) / 640);
        for (const std::string& chain : chains) {
            INFO(primitive << " against itself through " << chain);
            const std::string b = place(primitive, chain);
            CHECK(count_hits(trace("subtraction { " + a + b + " }")) == 0);
            CHECK(count_hits(trace("symdiff { " + a + b + " }")) == 0);
            CHECK(count_differences(trace("intersection { " + a + b + " }"), alone) == 0);
            CHECK(count_differences(trace("union { " + a + b + " }"), alone) == 0);
            CHECK(count_differences(trace("merge { " + a + b + " }"), alone) == 0);
        }
    }
}

// The closed form of a box that is turned by the one rotation that all chains are: the slab test in its own axes.
struct TurnedBox {
    Point low, high;
};

struct BoxHit {
    double t = infinity;
    Vector normal;
};

// Rows: where the axes go under rotx(0.3) roty(0.7).
struct Axes {
    Vector x, y, z;
};
Axes turned_axes() {
    const double cx = std::cos(0.3), sx = std::sin(0.3), cy = std::cos(0.7), sy = std::sin(0.7);
    const auto turn = [&](const Vector& v) {
        const Vector u{v.x, v.y * cx - v.z * sx, v.y * sx + v.z * cx};
        return Vector{u.x * cy + u.z * sy, u.y, -u.x * sy + u.z * cy};
    };
    return {turn({1, 0, 0}), turn({0, 1, 0}), turn({0, 0, 1})};
}

BoxHit meet(const TurnedBox& box, const Ray& ray) {
    const Axes axes = turned_axes();
    const Point eye = ray.origin.rounded();
    double in = 0, out = infinity;
    Vector normal;
    const auto slab = [&](const Vector& axis, double low, double high) {
        const double o = dot(eye, axis), d = dot(ray.direction, axis);
        const double near = ((d > 0 ? low : high) - o) / d, far = ((d > 0 ? high : low) - o) / d;
        if (near > in) in = near, normal = d > 0 ? -axis : axis;
        out = std::min(out, far);
    };
    slab(axes.x, box.low.x, box.high.x);
    slab(axes.y, box.low.y, box.high.y);
    slab(axes.z, box.low.z, box.high.z);
    return in < out ? BoxHit{in, normal} : BoxHit{};
}

// Pixels that differ from the nearest of some boxes. A pixel within 1e-9 of an edge may go either way.
std::size_t count_wrong(const Picture& picture, const std::vector<TurnedBox>& boxes) {
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < picture.rays.size(); ++i) {
        BoxHit first;
        for (const TurnedBox& box : boxes) {
            const BoxHit hit = meet(box, picture.rays[i]);
            if (hit.t < first.t) first = hit;
        }
        const RaySample& sample = picture.samples[i];
        const bool same = (first.t < infinity) == (sample.object > 0) &&
                          (sample.object == 0 ||
                           (std::fabs(sample.depth - first.t) < 1e-9 && length(to_vector(sample.normal) - first.normal) < 1e-6));
        wrong += !same;
    }
    return wrong;
}

std::string cube(double x, double y, double z, double half, const std::string& chain, const std::string& colour = "1, 1, 1") {
    return fmt::format("cube {{ size({0}, {0}, {0}); colour({1}); transform {{ translate({2}, {3}, {4}); {5} }} }}\n", half,
                       colour, x, y, z, chain);
}

TEST_CASE("abutting cubes join without a face") {
    for (const char* operation : {"union", "merge", "symdiff"}) {
        for (const std::string& chain : chains) {
            INFO(operation << " through " << chain);
            const Picture picture =
                trace(std::string(operation) + " { " + cube(-0.5, 0, 0, 0.5, chains[0]) + cube(0.5, 0, 0, 0.5, chain) + " }");
            CHECK(count_wrong(picture, {{{-1, -0.5, -0.5}, {1, 0.5, 0.5}}}) == 0);
        }
    }
}

TEST_CASE("a cube of 27 cubes is one cube") {
    std::string objects;
    for (int i = 0; i < 27; ++i)
        objects += cube(0.6 * (i % 3 - 1), 0.6 * (i / 3 % 3 - 1), 0.6 * (i / 9 - 1), 0.3,
                        chains[static_cast<std::size_t>(i) % chains.size()]);
    CHECK(count_wrong(trace("union { " + objects + " }"), {{{-0.9, -0.9, -0.9}, {0.9, 0.9, 0.9}}}) == 0);
}

TEST_CASE("a cube cut from a cube leaves shared faces open") {
    for (const std::string& chain : chains) {
        INFO(chain);
        // The upper right quarter toward the camera is cut out along three shared faces; two boxes and a block remain.
        const Picture picture = trace("subtraction { " + cube(0, 0, 0, 1, chains[0]) + cube(0.5, 0.5, -0.5, 0.5, chain) + " }");
        CHECK(count_wrong(picture, {{{-1, -1, -1}, {1, 0, 1}}, {{-1, -1, -1}, {0, 1, 1}}, {{-1, -1, 0}, {1, 1, 1}}}) == 0);
        // Half of it is cut away along five shared faces.
        const std::string right_half = "cube { size(0.5, 1, 1); transform { translate(0.5, 0, 0); " + chain + " } }";
        CHECK(count_wrong(trace("subtraction { " + cube(0, 0, 0, 1, chains[0]) + right_half + " }"),
                          {{{-1, -1, -1}, {0, 1, 1}}}) == 0);
    }
}

TEST_CASE("where faces coincide the left operand's shows") {
    for (const std::string& chain : chains) {
        INFO(chain);
        const Picture picture =
            trace("union { " + cube(0, 0, 0, 1, chains[0], "1, 0, 0") + cube(0, 0, 0, 1, chain, "0, 1, 0") + " }");
        std::size_t other = 0;
        for (const RaySample& sample : picture.samples) other += sample.object > 0 && !(sample.colour == Colour{1, 0, 0});
        CHECK(count_hits(picture) > 0);
        CHECK(other == 0);
    }
}

}  // namespace
}  // namespace lapidary
