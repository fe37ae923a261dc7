// SPDX-License-Identifier: MIT
//
// Boxes in a World, T09 to T11: rays at their edges and corners from near and far, rays in their faces, boxes thinner than the
// rounding of their place would let expect.

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "stress/exact.h"
#include "support/measurement.h"
#include "support/solids.h"

namespace lapidary::test {
namespace {

// How long a ray truly runs inside the cube of half-edge 1 about the origin; negative where it passes it, by how much.
double true_chord(const Ray& ray) {
    const ExactVector o(ray.origin.anchor), d(ray.direction);
    Exact in = -1e300, out = 1e300;
    const std::array<Exact, 3> from{o.x, o.y, o.z}, along{d.x, d.y, d.z};
    for (std::size_t k = 0; k < 3; ++k) {
        const Exact a = (-1 - from[k]) / along[k], b = (1 - from[k]) / along[k];
        in = std::max(in, std::min(a, b));
        out = std::min(out, std::max(a, b));
    }
    return static_cast<double>(out - in);
}

// A point of an edge or a corner of the cube.
Point on_an_edge(Random& random, bool corner) {
    std::array<double, 3> p{};
    for (double& x : p) x = random.uniform(0, 1) < 0.5 ? -1 : 1;
    if (!corner) p[static_cast<std::size_t>(random.uniform(0, 2.999))] = random.uniform(-1, 1);
    return {p[0], p[1], p[2]};
}

void check_edges(int rays) {
    SolidMaker maker;
    SpansThrough cube(maker.leaf("cube"));
    // Eight cubes that meet in the origin, each placed by another chain.
    std::vector<SceneNodePtr> eight;
    for (int i = 0; i < 8; ++i) {
        Factors factors = maker.there_and_back(2);
        factors.push_back(translate(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1));
        eight.push_back(maker.leaf("cube", factors));
    }
    SpansThrough together(maker.combine(Operation::union_, eight));
    Measurement edges({"T09", "edges and corners of a box, from 10 to 1e6", "", 0}),
        joints({"T09", "edges and corners where eight boxes meet", "", 0});
    Random random(9);
    int decided = 0;
    for (double distance : {10.0, 1e3, 1e6})
        for (bool corner : {false, true})
            for (int i = 0; i < rays; ++i) {
                const Vector d = random.direction();
                const Ray at_edge = ray_from(on_an_edge(random, corner) - distance * d, d);
                const bool hit = edges.timed([&] { return cube(at_edge).size(); }) == 1;
                // What rounding makes of a distance along the ray, at the face that it meets most slowly.
                const double slowest = std::min({std::fabs(d.x), std::fabs(d.y), std::fabs(d.z)});
                const double chord = true_chord(at_edge), rounding = 64 * u * (distance + 2) / slowest;
                if (std::fabs(chord) > rounding) {
                    edges.expect(hit == (chord > 0));
                    ++decided;
                }
                // Along one of the three planes in which the boxes meet, or all of them.
                const Point joint = corner ? Point{0, 0, 0} : Point{0, 0, random.uniform(-1.5, 1.5)};
                const Ray at_joint = ray_from(joint - distance * d, d);
                joints.expect(joints.timed([&] { return together(at_joint).size(); }) == 1);
            }
    CHECK(decided > rays);
}

}  // namespace

TEST_CASE("T09: edges and corners of boxes") { check_edges(1000); }
TEST_CASE("T09: edges and corners of boxes, in a million rays", "[.long]") { check_edges(170000); }

TEST_CASE("T10: a ray in the face that two boxes share") {
    SolidMaker maker;
    const SceneNodePtr left = maker.leaf("cube", {translate(-1, 0, 0)});
    Factors chain = maker.there_and_back(2);
    chain.push_back(translate(1, 0, 0));
    const SceneNodePtr right = maker.leaf("cube", chain);
    SpansThrough both(maker.combine(Operation::union_, {left, right})),
        common(maker.combine(Operation::intersection, {left, right})),
        without_right(maker.combine(Operation::subtraction, {left, right})),
        without_left(maker.combine(Operation::subtraction, {right, left}));
    Measurement in_face({"T10", "rays in the face of two boxes", "", 0}), ends({"T10", "where they enter and leave", "u t", 4});
    Random random(10);
    for (double zero : {0.0, -0.0})
        for (int i = 0; i < 500; ++i) {
            const Vector d = normalize(Vector{0, random.uniform(-1, 1), random.uniform(-1, 1)});
            const Point middle{0, random.uniform(-0.9, 0.9), random.uniform(-0.9, 0.9)};
            const Ray there{middle - 5 * d, {zero, d.y, d.z}, {}, {}}, back{middle + 5 * d, {-zero, -d.y, -d.z}, {}, {}};
            const auto spans = in_face.timed([&] { return both(there); }), reversed = both(back);
            in_face.expect(spans.size() == 1 && reversed.size() == 1);
            if (spans.size() != 1 || reversed.size() != 1) continue;
            ends.record((10 - reversed[0].out - spans[0].in) / (u * 10));
            ends.record((10 - reversed[0].in - spans[0].out) / (u * 10));
            in_face.expect(common(there).empty() && common(back).empty());
            // The face belongs to one of the two, from either side.
            in_face.expect(without_right(there).empty() != without_left(there).empty());
            in_face.expect(without_right(there).empty() == without_right(back).empty());
        }
}

TEST_CASE("T11: thin boxes in a World keep their thickness") {
    struct Case {
        double thickness, place;
    };
    Measurement thin({"T11", "boxes of 1e-13 at 1, 1e-7 at 1e6", "u (D + 1)", 4});
    for (const Case& c : {Case{1e-13, 1}, Case{1e-7, 1e6}}) {
        SolidMaker maker;
        SpansThrough box(maker.leaf("cube", {scale(c.thickness / 2, 1, 1), translate(c.place, 0, 0)}));
        for (const Ray& ray : {ray_from({0, 0.1, 0.2}, {1, 0, 0}), ray_from({2 * c.place, 0.1, 0.2}, {-1, 0, 0})}) {
            const auto spans = box(ray);
            thin.expect(spans.size() == 1);
            if (spans.size() != 1) continue;
            thin.expect(spans[0].in < spans[0].out);
            thin.record(((spans[0].out - spans[0].in) - c.thickness) / (u * (c.place + 1)));
        }
    }
}

}  // namespace lapidary::test
