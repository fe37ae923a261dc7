// SPDX-License-Identifier: MIT
//
// T05: an eye close to a large surface. The root beside it is found to full relative precision, whatever the surface's size,
// against 200-bit arithmetic on the same doubles; by single rays and in packets with the same bits.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "stress/exact.h"
#include "support/measurement.h"
#include "support/solids.h"
#include "support/traced_scene.h"

namespace lapidary::test {
namespace {

// The ray's origin less a centre, exactly.
ExactVector from_centre(const Ray& ray, const Point& centre) {
    const auto part = [](double anchor, double offset, double c) { return Exact(anchor) + Exact(offset) - Exact(c); };
    return {part(ray.origin.anchor.x, ray.origin.offset.x, centre.x), part(ray.origin.anchor.y, ray.origin.offset.y, centre.y),
            part(ray.origin.anchor.z, ray.origin.offset.z, centre.z)};
}

double relative_error(double t, const Exact& truth) { return static_cast<double>(abs((Exact(t) - truth) / truth)); }

// An origin at an altitude above a place, as doubles have it: in one part, rounded, or in two.
Ray eye_above(const Point& place, const Vector& up, double altitude, const Vector& direction, bool two_parts) {
    const TwoPartPoint eye{place, altitude * up};
    return {two_parts ? eye : TwoPartPoint(eye.rounded()), direction, {}, {}};
}

// Of the spans of a ray, the first one's end that lies ahead first.
double first_end(const std::vector<Span>& spans) {
    if (spans.empty()) return infinity;
    return spans[0].in > 0 ? spans[0].in : spans[0].out;
}

// The smallest root above 0 of a polynomial of second degree.
Exact first_ahead(const Polynomial& p) {
    for (const Exact& root : quadratic_roots(p))
        if (root > 0) return root;
    return -1;
}

// Compares where the ray first meets something with what is true. One relative error is counted as `conditioning`.
void check_first_end(Measurement& measured, SpansThrough& spans, const Ray& ray, const Exact& truth, double conditioning = 1) {
    const double t = first_end(measured.timed([&] { return spans(ray); }));
    measured.expect(t < infinity);
    if (t < infinity) measured.record(relative_error(t, truth) * conditioning);
}

}  // namespace

TEST_CASE("T05: one unit above a ball of radius 1e12") {
    SolidMaker maker;
    SpansThrough spans(maker.leaf("sphere", {}, {{"radius", {1e12}}}));
    const auto met = spans(ray_from({0, 1e12 + 1, 0}, {0, -1, 0}));
    REQUIRE(met.size() == 1);
    CHECK(met[0].in == 1);
}

TEST_CASE("T05: the near root of a giant ball, from any altitude, above and below") {
    const double radius = GENERATE(1.0, 6371000.0, 1e12);
    const bool two_parts = GENERATE(true, false);
    // As wide by its radius or by its scale; at the origin or away from it.
    const bool scaled = GENERATE(true, false);
    const Point centre = GENERATE(Point{0, 0, 0}, Point{3e5, -7e4, 11});
    CAPTURE(radius, two_parts, scaled, centre.x);
    SolidMaker maker;
    const Factors shift{translate(centre.x, centre.y, centre.z)};
    Factors blow_up{scale(radius, radius, radius)};
    blow_up.insert(blow_up.end(), shift.begin(), shift.end());
    SpansThrough spans(scaled ? maker.leaf("sphere", blow_up) : maker.leaf("sphere", shift, {{"radius", {radius}}}));

    Random random(5);
    Measurement steep({"T05", "near root of a ball", "relative", 1e-13}),
        grazing({"T05", "the same toward grazing", "u R / cos", 4});
    for (int exponent = -6; exponent <= 3; ++exponent)
        for (int side : {1, -1})
            for (int i = 0; i < 60; ++i) {
                const double altitude = side * std::pow(10, exponent);
                if (altitude <= -radius) continue;
                const Vector up = random.direction();
                const Ray ray = eye_above(centre + radius * up, up, altitude, random.direction(), two_parts);
                const Exact truth = first_ahead(sphere_polynomial(from_centre(ray, centre), ray.direction, radius));
                if (truth < 0) continue;
                const ExactVector to_eye = from_centre(ray, centre);
                const double cosine =
                    std::fabs(static_cast<double>(dot(at(to_eye, ray.direction, truth), ray.direction))) / radius;
                if (cosine > 0.3)
                    check_first_end(steep, spans, ray, truth);
                else
                    check_first_end(grazing, spans, ray, truth, static_cast<double>(truth) * cosine / (u * radius));
            }
}

TEST_CASE("T05: the near root of a giant rod, cone, ring and box") {
    const double size = GENERATE(1.0, 6371000.0, 1e12);
    CAPTURE(size);
    SolidMaker maker;
    SpansThrough rod(maker.leaf("cylinder", {}, {{"radius", {size}}}));
    SpansThrough cone(maker.leaf("cone", {}, {{"radii", {size, 0}}, {"height", {size}}}));
    SpansThrough ring(maker.leaf("torus", {}, {{"radii", {size, size / 4}}}));
    SpansThrough box(maker.leaf("cube", {}, {{"size", {size, size, size}}}));

    Random random(6);
    Measurement of_rod({"T05", "near root of a rod", "relative", 1e-13}),
        of_cone({"T05", "near root of a cone", "relative", 1e-13}), of_ring({"T05", "near root of a ring", "relative", 1e-13}),
        of_box({"T05", "near root of a box", "relative", 1e-13});
    for (int exponent = -6; exponent <= 2; ++exponent)
        for (int i = 0; i < 40; ++i) {
            const double altitude = std::pow(10, exponent), angle = random.uniform(-3, 3), height = random.uniform(-0.3, 0.3);
            const Vector out{std::cos(angle), 0, std::sin(angle)};
            const Vector direction = random.direction();
            const auto eye = [&](double radius, double y, const Vector& up) {
                return eye_above({radius * out.x, y, radius * out.z}, up, altitude, direction, true);
            };
            const auto check = [&](Measurement& measured, SpansThrough& spans, const Ray& ray, const Vector& up,
                                   const Exact& truth) {
                // The point closest to the centre is not the eye itself: there, t is the leaf's own, precise as the leaf is
                // large.
                const bool is_shifted = std::fabs(dot(to_vector(ray.origin.anchor), direction)) > 0.1 * size;
                if (truth > 0 && dot(direction, up) < -0.3 && truth < size / 1000 && is_shifted)
                    check_first_end(measured, spans, ray, truth);
            };
            const Ray at_rod = eye(size, height * size, out);
            check(of_rod, rod, at_rod, out, first_ahead(cylinder_polynomial(from_centre(at_rod, {}), direction, size)));
            // The cone's slope is 1, its apex at half of its height.
            const Vector off_cone = normalize(out + Vector{0, 1, 0});
            const Ray at_cone = eye(size * (0.5 - height), height * size, off_cone);
            check(of_cone, cone, at_cone, off_cone,
                  first_ahead(cone_polynomial(from_centre(at_cone, {}), direction, 1, size / 2)));
            const Ray at_ring = eye(1.25 * size, 0, out);
            const auto roots = sign_changes(torus_polynomial(from_centre(at_ring, {}), direction, size, size / 4), 0, size / 100);
            if (!roots.empty()) check(of_ring, ring, at_ring, out, roots[0]);
            const Vector up{0, 1, 0};
            const Ray at_box = eye_above({height * size, size, random.uniform(-0.5, 0.5) * size}, up, altitude, direction, true);
            check(of_box, box, at_box, up, -(from_centre(at_box, {}).y - Exact(size)) / Exact(direction.y));
        }
}

TEST_CASE("T05: a plane that is shared is met beside it as precisely as one that is not") {
    // Two boxes side by side, their tops in one plane, far from both centres.
    SolidMaker maker;
    const double size = 1e9;
    SpansThrough spans(maker.combine(Operation::union_, {maker.leaf("cube", {scale(size, size, size), translate(-size, 0, 0)}),
                                                         maker.leaf("cube", {scale(size, size, size), translate(size, 0, 0)})}));
    REQUIRE(spans.world().features.shared_surfaces);
    Random random(7);
    Measurement measured({"T05", "near root of shared planes", "relative", 1e-13});
    for (int i = 0; i < 500; ++i) {
        Vector direction = random.direction();
        direction.y = -std::fabs(direction.y);
        if (direction.y > -0.05) continue;
        const double altitude = random.magnitude(-6, 2);
        const Ray ray = eye_above({random.uniform(-1, 1) * size, size, random.uniform(-0.5, 0.5) * size}, {0, 1, 0}, altitude,
                                  direction, true);
        check_first_end(measured, spans, ray, Exact(altitude) / -Exact(direction.y));
    }
}

TEST_CASE("T05: the place met beside a large surface is as precise as the way there is short") {
    const double radius = GENERATE(1e3, 6371000.0, 1e12);
    CAPTURE(radius);
    TracedScene scene(fmt::format("lights {{ ambient {{ }} }} objects {{ sphere {{ radius({}); }} }}", radius));
    Random random(8);
    Measurement measured({"T05", "place met beside a ball", "u (t + 16 u R)", 2}),
        repeated({"T05", "the same in a packet", "", 0});
    for (int i = 0; i < 2000; ++i) {
        const Vector up = random.direction();
        const Point eye = TwoPartPoint(to_point(radius * up), random.magnitude(-6, 0) * up).rounded();
        const Vector toward = random.direction();
        const Ray ray = ray_from(eye, dot(toward, up) > 0 ? -toward : toward);
        if (dot(ray.direction, up) > -0.3) continue;
        const Exact t = first_ahead(sphere_polynomial(from_centre(ray, {}), ray.direction, radius));
        if (t > radius / 100) continue;  // the eye was rounded into the ball
        const TracedRay traced = scene.trace(eye, ray.direction);
        REQUIRE(traced.events.size() == 1);
        const TwoPartPoint& met = traced.events[0].point;
        const ExactVector truth = at(from_centre(ray, {}), ray.direction, t);
        for (const Exact& off : {Exact(met.anchor.x) + met.offset.x - truth.x, Exact(met.anchor.y) + met.offset.y - truth.y,
                                 Exact(met.anchor.z) + met.offset.z - truth.z})
            measured.record(static_cast<double>(off / (t + 16 * u * radius)) / u);
        const RaySample in_packet = scene.sample(eye, ray.direction);
        repeated.expect(in_packet.position == traced.sample.position && in_packet.normal == traced.sample.normal &&
                        in_packet.depth == traced.sample.depth);
    }
}

}  // namespace lapidary::test
