// SPDX-License-Identifier: MIT
//
// Rays that start where others ended: under a contact (T47), inside a ball (T48), between mirrors (T49, T50), and toward lights
// that stand on or in solids (T51). There is no minimum distance anywhere.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "kernel/csg/ray_through_world.h"
#include "kernel/render/optics.h"
#include "stress/exact.h"
#include "support/measurement.h"
#include "support/solids.h"
#include "support/traced_scene.h"

using namespace lapidary;
using namespace lapidary::test;

namespace {

// A World from text, and rays that go on from face to face as the renderer's do.
class Walk {
public:
    explicit Walk(const std::string& text) : scene_(text), through_(scene_.world(), statistics_) {}

    // The first face on the ray; nothing is wrong with none but that `leaf` is -1.
    FaceHit next(const Ray& ray) {
        through_.start(ray);
        boundary_ = through_.next(0, {});
        if (boundary_.t == infinity) return {};
        return through_.face(boundary_);
    }
    double distance() const { return boundary_.t; }
    bool is_blocked(const Ray& ray, double distance) {
        through_.start(ray);
        return through_.is_blocked(distance);
    }

private:
    TracedScene scene_;
    TraceStatistics statistics_;
    RayThroughWorld through_;
    Boundary boundary_;
};

// A place in a space that is scaled by `size` and then moved by `offset` along all axes.
struct Setting {
    double size = 1, offset = 0;

    std::string transform() const { return fmt::format("transform {{ scale({0}); translate({1}, {1}, {1}); }} ", size, offset); }
    Point world(const Vector& p) const { return Point{offset, offset, offset} + size * p; }
};

void check_contact_shadow(int rays) {
    const Setting setting = GENERATE(Setting{1, 0}, Setting{1e-6, 0}, Setting{1e6, 0}, Setting{1, 1e3});
    const double gap = GENERATE(1e-3, 1e-6, 1e-9, 1e-12, 0.0);
    CAPTURE(setting.size, setting.offset, gap);
    const Point light = setting.world({0, 10, 0});
    const std::string text = fmt::format(
        "lights {{ point {{ location({}, {}, {}); intensity({}); }} }} objects {{ halfspace {{ }} "
        "sphere {{ transform {{ translate(0, 1, 0); translate(0, {}, 0); }} }} {} }}",
        light.x, light.y, light.z, 100 * setting.size * setting.size, gap, setting.transform());
    Walk walk(text);
    TracedScene scene(text);
    Random random(47);
    Measurement blocked({"T47", "shadow rays under a contact", "", 0}), shaded({"T47", "the contact seen from the side", "", 0}),
        light_beyond({"T47", "light beyond the shadow", "", 0});
    int on_plane = 0;
    for (int i = 0; i < rays; ++i) {
        // The shadow of the ball reaches to 10 tan(asin(1/9)) = 1.118.
        const double distance = i == 0 ? 0 : i % 2 == 0 ? random.uniform(0, 1.1) : random.magnitude(-12, 0);
        const double angle = random.uniform(0, 7);
        const Vector out{std::cos(angle), 0, std::sin(angle)};

        // A place of the plane, reached from inside the ground; from there, straight to the light.
        const FaceHit from_below = walk.next(ray_from(setting.world(distance * out + Vector{0.3, -1, 0.2}), {-0.3, 1, -0.2}));
        REQUIRE(from_below.leaf >= 0);
        const Vector to_light = light - from_below.point.rounded();
        blocked.expect(walk.is_blocked(ray_off(from_below, normalize(to_light)), length(to_light)));

        // The same place looked at from the side, below the ball's equator.
        const double elevation = std::min(distance / 8, 0.2);
        const Vector from =
            distance * out + 3 * Vector{std::cos(elevation) * out.x, std::sin(elevation), std::cos(elevation) * out.z};
        const RaySample seen = scene.sample(setting.world(from), distance * out - from);
        on_plane += seen.object == 1;
        shaded.expect(seen.object != 1 || seen.colour == Colour::black());

        // Beyond the shadow there is light.
        const Vector beyond = random.uniform(1.2, 5) * out;
        light_beyond.expect(!(scene.colour(setting.world(beyond + Vector{1, 3, 0}), {-1, -3, 0}) == Colour::black()));
    }
    CHECK(on_plane > rays / 4);
}

void check_exits(int rays) {
    const double offset = GENERATE(0.0, 1e3, 1e6, 1e9);
    CAPTURE(offset);
    Walk walk(
        fmt::format("lights {{ ambient {{ }} }} objects {{ sphere {{ transform {{ translate({0}, {0}, {0}); }} }} }}", offset));
    Random random(48);
    Measurement measured({"T48", fmt::format("way out of a ball at {:g}", offset), "radius", 2e-15});
    for (int i = 0; i < rays; ++i) {
        const Vector d = random.direction();
        const Vector beside = random.uniform(0, 0.99) * normalize(cross(d, random.direction()));
        const Ray ray = ray_from(Point{offset, offset, offset} + (beside - 10 * d), d);
        const FaceHit entry = walk.next(ray);
        if (entry.leaf < 0) continue;  // far from the origin the ray itself is rounded
        const Refraction inward = refract(d, entry.normal, 1 / 1.5);
        REQUIRE_FALSE(inward.is_total);
        const FaceHit exit = walk.next(ray_off(entry, inward.direction));
        measured.expect(exit.leaf >= 0);
        if (exit.leaf < 0) continue;
        // From p on the unit sphere along w, the way out is -2 p.w / w.w.
        const TwoPartPoint& point = entry.point;
        const ExactVector p{Exact(point.anchor.x) + point.offset.x - offset, Exact(point.anchor.y) + point.offset.y - offset,
                            Exact(point.anchor.z) + point.offset.z - offset};
        const ExactVector w = inward.direction;
        const Exact expected = -2 * dot(p, w) / dot(w, w);
        measured.record(std::fabs(static_cast<double>(walk.distance() - expected)));
    }
}

// Between the mirrors y = 0 and y = 1, at 45 degrees: each bounce is one unit further.
void check_mirror_room(int bounces) {
    Walk walk(
        "lights { ambient { } } objects { halfspace { } halfspace { transform { scale(1, -1, 1); translate(0, 1, 0); } } }");
    Ray ray = ray_from({-0.5, 0.5, 0}, {1, -1, 0});
    Measurement drift({"T49", fmt::format("drift in {} bounces", bounces), "distance", 1e-9}),
        stretch({"T49", "length of the direction less 1", "u", 4});
    for (int i = 0; i < bounces; ++i) {
        const FaceHit face = walk.next(ray);
        REQUIRE(face.leaf >= 0);
        const ExactVector d = ray.direction;
        const Exact x = Exact(face.point.anchor.x) + face.point.offset.x, y = Exact(face.point.anchor.y) + face.point.offset.y;
        drift.record(std::fabs(static_cast<double>(x - i)));
        drift.record(std::fabs(static_cast<double>(y - i % 2)));
        stretch.record(std::fabs(static_cast<double>(sqrt(dot(d, d)) - 1)) / u);
        const Normal toward = dot(face.normal, ray.direction) > 0 ? -face.normal : face.normal;
        ray = ray_off(face, mirror(ray.direction, toward));
    }
}

void check_corner(int rays) {
    const bool turned = GENERATE(false, true);
    CAPTURE(turned);
    const std::string mirror_of = "material { solid { reflection(1); } } ";
    TracedScene scene("render { depth(8); } lights { ambient { } } objects { " + wall + "union { halfspace { " + mirror_of +
                      "} halfspace { " + mirror_of + "transform { matrix(0,1,0, 1,0,0, 0,0,1, 0,0,0); } } halfspace { " +
                      mirror_of + "transform { matrix(1,0,0, 0,0,1, 0,1,0, 0,0,0); } } " +
                      (turned ? "transform { rotate(1, 2, 3, 0.7); } " : "") + "} }");
    Random random(50);
    const double c = std::cos(0.7), s = std::sin(0.7);
    const Vector k = normalize(Vector{1, 2, 3});
    const auto turn = [&](const Vector& v) { return turned ? c * v + s * cross(k, v) + (1 - c) * dot(k, v) * k : v; };
    Measurement measured({"T50", "way back from a corner of mirrors", "u", 8});
    for (int i = 0; i < rays; ++i) {
        const Vector from{random.uniform(0.1, 2), random.uniform(0.1, 2), random.uniform(0.1, 2)};
        // Steep enough to meet the third mirror before the wall.
        const Vector d = normalize(turn(Vector{-random.uniform(0.06, 1), -random.uniform(0.06, 1), -random.uniform(0.06, 1)}));
        const TracedRay traced = scene.trace(to_point(turn(from)), d);
        REQUIRE_FALSE(traced.events.empty());
        // Three mirrors, then the wall.
        measured.expect(traced.events.size() == 4);
        measured.record(length(traced.events.back().direction + d) / u);
    }
}

// What is seen of the ground from above.
enum class Expected { light, darkness, anything };
void look_down(const std::string& what, const std::string& text, int rays, double height, Expected expected) {
    CAPTURE(text);
    TracedScene scene(text), again(text);
    Random random(51);
    Measurement measured({"T51", what, "", 0}), repeated({"T51", "the same again, in a packet and alone", "", 0});
    for (int i = 0; i < rays; ++i) {
        const Point eye{random.uniform(-4, 4), height, random.uniform(-4, 4)};
        const Vector d{random.uniform(-1, 1), -1, random.uniform(-1, 1)};
        const Colour colour = scene.colour(eye, d);
        const bool dark = colour == Colour::black();
        measured.expect(expected == Expected::anything || dark == (expected == Expected::darkness));
        measured.expect(is_finite(colour));
        repeated.expect(again.colour(eye, d) == colour && scene.trace(eye, d).sample.colour == colour);
    }
}

std::string lamp(double x, double y, double z) {
    return fmt::format("lights {{ point {{ location({}, {}, {}); intensity(10); }} }} ", x, y, z);
}

}  // namespace

TEST_CASE("T47 the shadow under a contact is closed") { check_contact_shadow(60); }
TEST_CASE("T47 the shadow under a contact, in a million rays", "[.long]") { check_contact_shadow(17000); }

TEST_CASE("T48 the way out of a ball is exact at any distance from the origin") { check_exits(2500); }
TEST_CASE("T48 the way out of a ball, in a million rays", "[.long]") { check_exits(250000); }

TEST_CASE("T49 a path between mirrors keeps its course for ten thousand bounces") { check_mirror_room(10000); }
TEST_CASE("T49 a path between mirrors keeps its course for a million bounces", "[.long]") { check_mirror_room(1000000); }

TEST_CASE("T50 three mirrors in a corner send light back where it came from") { check_corner(5000); }
TEST_CASE("T50 three mirrors in a corner, in a million rays", "[.long]") { check_corner(500000); }

TEST_CASE("T51 a lamp that stands on a face lights what the face's front sees") {
    for (const double offset : {0.0, 0.1, 1.0 / 3, 1e3 + 0.1}) {
        CAPTURE(offset);
        const std::string moved = fmt::format("transform {{ translate({0}, 0, {0}); }} ", offset);
        const double height = 3 + offset;
        // On a ceiling.
        look_down("lamp on a ceiling",
                  lamp(0.3, height, 0.7) + fmt::format("objects {{ halfspace {{ {} }} halfspace {{ transform {{ scale(1, -1, 1); "
                                                       "translate(0, {}, 0); }} }} }}",
                                                       moved, height),
                  1000, 2.9, Expected::light);
        // On the underside of a ball, of a box turned by a chain, of a slab, and on a sheet.
        for (const char* body :
             {"sphere {{ transform {{ translate(0.3, 1, 0.7); translate(0, {}, 0); }} }}",
              "cube {{ transform {{ roty(1); rotz(0.5); rotz(-0.5); translate(0.3, 1, 0.7); translate(0, {}, 0); }} }}",
              "plane {{ thickness(2); transform {{ translate(0, 1, 0); translate(0, {}, 0); }} }}",
              "plane {{ transform {{ translate(0, {}, 0); }} }}"})
            look_down("lamp under a solid",
                      lamp(0.3, height, 0.7) + "objects { halfspace { } " + fmt::format(fmt::runtime(body), height) + " }", 1000,
                      2.9, Expected::light);
    }
    // Within a ball, and below the ground.
    look_down("lamp in a solid",
              lamp(0, 2, 0) + "objects { halfspace { } sphere { radius(1.5); transform { translate(0, 2, 0); } } }", 1000, 0.4,
              Expected::darkness);
    look_down("lamp in a solid", lamp(0, -1, 0) + "objects { halfspace { } sphere { transform { translate(0, 9, 0); } } }", 1000,
              0.4, Expected::darkness);
    // In the plane of the ground itself, where light only grazes; at the very place that is looked at.
    for (const std::string& light : {lamp(0, 0, 0), lamp(0.1, 0, 0.3)})
        look_down("lamp in the ground's face", light + "objects { halfspace { } }", 1000, 1, Expected::anything);
    TracedScene at_lamp(lamp(0, 0, 0) + "objects { halfspace { } }");
    CHECK(is_finite(at_lamp.colour({0, 1, 0}, {0, -1, 0})));
}
