// SPDX-License-Identifier: MIT
//
// Coincidence by the hundred (T23, T97): a box cut into boxes along random planes, each piece placed by another chain of
// rotations and scales. Whatever the ray: the union of the pieces is one span, the box minus the pieces is nothing, the even
// pieces and the odd ones have nothing in common.
#include <algorithm>
#include <array>
#include <functional>
#include <numbers>
#include <string>

#include "stress/exact.h"
#include "support/measurement.h"
#include "support/solids.h"

using namespace lapidary;

namespace {

struct Box {
    std::array<double, 3> low, high;
};

// Cuts at multiples of 1/4 along random axes.
std::vector<Box> cut(std::mt19937_64& random, int pieces) {
    std::vector<Box> boxes{{{0, 0, 0}, {8, 8, 8}}};
    for (int tries = 0; static_cast<int>(boxes.size()) < pieces && tries < 1000; ++tries) {
        const std::size_t which = random() % boxes.size();
        const std::size_t axis = random() % 3;
        Box& box = boxes[which];
        const int steps = static_cast<int>((box.high[axis] - box.low[axis]) * 4);
        if (steps < 4) continue;
        const double at = box.low[axis] + 0.25 * (1 + static_cast<double>(random() % static_cast<unsigned>(steps - 1)));
        Box other = box;
        box.high[axis] = at;
        other.low[axis] = at;
        boxes.push_back(other);
    }
    return boxes;
}

struct Setting {
    double size, offset;
};

class Tiling {
public:
    Tiling(unsigned seed, const Setting& setting) : maker_(seed), setting_(setting), boxes_(cut(maker_.random, 41)) {}

    const std::vector<Box>& boxes() const { return boxes_; }
    std::mt19937_64& random() { return maker_.random; }

    Point world(const std::array<double, 3>& p) const {
        return {setting_.offset + setting_.size * p[0], setting_.offset + setting_.size * p[1],
                setting_.offset + setting_.size * p[2]};
    }

    SceneNodePtr piece(const Box& box) {
        Factors factors = maker_.there_and_back(3);
        std::array<double, 3> half{}, middle{};
        for (std::size_t i = 0; i < 3; ++i) {
            half[i] = setting_.size * (box.high[i] - box.low[i]) / 2;
            middle[i] = setting_.size * (box.high[i] + box.low[i]) / 2;
        }
        factors.push_back(scale(half[0], half[1], half[2]));
        factors.push_back(translate(middle[0], middle[1], middle[2]));
        factors.push_back(translate(setting_.offset, setting_.offset, setting_.offset));
        return maker_.leaf("cube", factors);
    }
    SceneNodePtr all(Operation operation) {
        std::vector<SceneNodePtr> pieces;
        for (const Box& box : boxes_) pieces.push_back(piece(box));
        return maker_.combine(operation, std::move(pieces));
    }
    SceneNodePtr whole() { return piece({{0, 0, 0}, {8, 8, 8}}); }
    SceneNodePtr every_second(std::size_t first) {
        std::vector<SceneNodePtr> pieces;
        for (std::size_t i = first; i < boxes_.size(); i += 2) pieces.push_back(piece(boxes_[i]));
        return maker_.combine(Operation::union_, std::move(pieces));
    }
    SceneNodePtr difference() { return maker_.combine(Operation::subtraction, {whole(), all(Operation::union_)}); }
    SceneNodePtr common() { return maker_.combine(Operation::intersection, {every_second(0), every_second(1)}); }

    // From outside through the middle part of the box, at random, through an edge or a vertex of a piece, within the plane of
    // a face, or along an edge.
    Ray ray(int kind) {
        std::uniform_real_distribution<double> uniform(0, 1);
        const auto number = [&] { return uniform(random()); };
        const Box& box = boxes_[random()() % boxes_.size()];
        std::array<double, 3> through{8 * number(), 8 * number(), 8 * number()};
        std::array<double, 3> direction{2 * number() - 1, 2 * number() - 1, 2 * number() - 1};
        const std::size_t axis = random()() % 3, next = (axis + 1) % 3, last = (axis + 2) % 3;
        const auto inner = [](double v) { return v == 0 || v == 8 ? 4 : v; };
        if (kind >= 1) through[axis] = inner(box.low[axis]);
        if (kind == 1 || kind == 2 || kind == 4) through[next] = inner(box.low[next]);
        if (kind == 2) through[last] = inner(box.low[last]);
        if (kind == 3) direction[axis] = 0;
        if (kind == 4) direction[axis] = direction[next] = 0;
        std::array<double, 3> origin{};
        for (std::size_t i = 0; i < 3; ++i) origin[i] = through[i] - 20 * direction[i];
        return ray_from(world(origin), {direction[0], direction[1], direction[2]});
    }

    // How long the ray runs inside the whole box, in the box's units, and how far it passes its outer edges at least.
    double chord(const Ray& ray) const {
        const Point low = world({0, 0, 0}), high = world({8, 8, 8}), o = ray.origin.anchor;
        double in = 0, out = infinity;
        const std::array<double, 3> from{o.x, o.y, o.z}, along{ray.direction.x, ray.direction.y, ray.direction.z};
        const std::array<double, 3> lows{low.x, low.y, low.z}, highs{high.x, high.y, high.z};
        for (std::size_t i = 0; i < 3; ++i) {
            if (along[i] == 0) {
                if (!(from[i] > lows[i] && from[i] < highs[i])) return 0;
                continue;
            }
            const double a = (lows[i] - from[i]) / along[i], b = (highs[i] - from[i]) / along[i];
            in = std::max(in, std::min(a, b));
            out = std::min(out, std::max(a, b));
        }
        return (out - in) / setting_.size;
    }

    // The cosine with which the ray meets the whole box at t; on an edge, the lesser one.
    double steepness(const Ray& ray, double t) const {
        const Point low = world({0, 0, 0}), high = world({8, 8, 8}), p = ray.origin.anchor + t * ray.direction;
        const std::array<double, 3> at{p.x, p.y, p.z}, along{ray.direction.x, ray.direction.y, ray.direction.z};
        const std::array<double, 3> lows{low.x, low.y, low.z}, highs{high.x, high.y, high.z};
        double least = 1;
        for (std::size_t i = 0; i < 3; ++i)
            if (along[i] != 0 && std::min(std::fabs(at[i] - lows[i]), std::fabs(at[i] - highs[i])) < 1e-3 * setting_.size)
                least = std::min(least, std::fabs(along[i]));
        return least;
    }

private:
    SolidMaker maker_;
    Setting setting_;
    std::vector<Box> boxes_;
};

// What a tiling is asked about.
struct Trio {
    SpansThrough united, difference, common;
};

void check_tilings(int tilings, int rays) {
    const Setting setting =
        GENERATE(Setting{1, 0}, Setting{1, 1e3}, Setting{1, 1e6}, Setting{1, 1e9}, Setting{1e-6, 0}, Setting{1e-6, 1e3},
                 Setting{1e6, 0}, Setting{1e6, 1e3}, Setting{1e6, 1e6}, Setting{1e6, 1e9});
    CAPTURE(setting.size, setting.offset);
    test::Measurement whole({"T23", "union of the pieces of a box", "", 0}), nothing({"T23", "box minus its pieces", "", 0}),
        apart({"T23", "even and odd pieces of a box", "", 0}),
        mirrored({"T40", "a box of pieces, backward", "u (t + place) / cos", 8});
    const auto check = [&](Trio& trio, const Ray& ray) {
        const std::vector<Span> spans = whole.timed([&] { return trio.united(ray); });
        whole.expect(spans.size() == 1);
        nothing.expect(nothing.timed([&] { return trio.difference(ray).empty(); }));
        apart.expect(apart.timed([&] { return trio.common(ray).empty(); }));
        return spans;
    };
    int checked = 0;
    for (int tiling_number = 0; tiling_number < tilings; ++tiling_number) {
        Tiling tiling(static_cast<unsigned>(100 + tiling_number), setting);
        Trio trio{SpansThrough(tiling.all(Operation::union_)), SpansThrough(tiling.difference()), SpansThrough(tiling.common())};
        for (int kind = 0; kind < 5; ++kind)
            for (int i = 0; i < rays; ++i) {
                const Ray ray = tiling.ray(kind);
                // Leave out rays that all but miss the whole box: there the sum of the pieces is decided by rounding.
                if (tiling.chord(ray) < 1e-3) continue;
                ++checked;
                const double distance = 64 * setting.size;
                const std::vector<Span> there = check(trio, ray), back = check(trio, reversed(ray, distance));
                const bool begins_outside = there.size() == 1 && back.size() == 1 && there[0].in > 0;
                if (!begins_outside) continue;
                const double rounding = test::u * (distance + setting.offset);
                mirrored.record((there[0].in + back[0].out - distance) * tiling.steepness(ray, there[0].in) / rounding);
                mirrored.record((there[0].out + back[0].in - distance) * tiling.steepness(ray, there[0].out) / rounding);
            }
    }
    CHECK(checked > tilings * rays);
}

// Disjoint solids that share a line or a point: every second of them, and the rest, have nothing in common, and together they
// leave no gap. Rays are aimed at `shared`, forward and backward.
void check_neighbours(const std::string& what, SolidMaker& maker, const std::vector<SceneNodePtr>& all, int rays,
                      const std::function<Point()>& shared) {
    std::vector<SceneNodePtr> even, odd;
    for (std::size_t i = 0; i < all.size(); ++i) (i % 2 == 0 ? even : odd).push_back(all[i]);
    SpansThrough common(
        maker.combine(Operation::intersection, {maker.combine(Operation::union_, even), maker.combine(Operation::union_, odd)}));
    SpansThrough united(maker.combine(Operation::merge, all));  // one solid: rule S knows no gaps between solids
    test::Measurement slivers({"T97", what + ", even and odd", "", 0}), gaps({"T97", what + ", all of them", "", 0});
    std::uniform_real_distribution<double> uniform(-1, 1);
    for (int i = 0; i < rays; ++i) {
        const Vector direction{uniform(maker.random), uniform(maker.random), uniform(maker.random)};
        const Ray there = ray_from(shared() - 6 * direction, direction);
        for (const Ray& ray : {there, reversed(there, 16)}) {
            slivers.expect(slivers.timed([&] { return common(ray).empty(); }));
            gaps.expect(gaps.timed([&] { return united(ray).size() <= 1; }));
        }
    }
}

void check_wedges(int rays) {
    const int planes = GENERATE(3, 5, 8, 13, 24);
    CAPTURE(planes);
    SolidMaker maker(7);
    // Sectors between half-planes at equal angles: a wedge is where two half-spaces through the axis overlap.
    const auto half_space = [&](double angle) {
        return maker.leaf("halfspace", {rotate({0, 0, 1}, angle)});  // y <= 0, turned about z
    };
    std::vector<SceneNodePtr> wedges;
    for (int i = 0; i < 2 * planes; ++i) {
        const double from = std::numbers::pi * i / planes, to = std::numbers::pi * (i + 1) / planes;
        wedges.push_back(maker.combine(Operation::intersection, {half_space(from + std::numbers::pi), half_space(to),
                                                                 maker.leaf("sphere", {scale(3, 3, 3)})}));
    }
    std::uniform_real_distribution<double> uniform(-1, 1);
    check_neighbours("wedges", maker, wedges, rays, [&] { return Point{0, 0, uniform(maker.random)}; });
}

// Cones of one apex and one base, each less the next narrower one; rays through the apex.
void check_cones(int rays) {
    const int cones = GENERATE(2, 5, 12);
    CAPTURE(cones);
    SolidMaker maker(8);
    const auto cone = [&](int i) {
        return maker.leaf("cone", maker.there_and_back(2), {{"radii", {3.0 * (cones - i) / cones, 0}}, {"height", {4}}});
    };
    std::vector<SceneNodePtr> shells;
    for (int i = 0; i < cones; ++i)
        shells.push_back(i + 1 < cones ? maker.combine(Operation::subtraction, {cone(i), cone(i + 1)}) : cone(i));
    check_neighbours("cones of one apex", maker, shells, rays, [] { return Point{0, 2, 0}; });
}

}  // namespace

TEST_CASE("T23 A box cut into pieces is whole, whatever the ray") { check_tilings(4, 120); }

TEST_CASE("T23 A box cut into pieces is whole, in a million rays", "[.long]") { check_tilings(40, 250); }

TEST_CASE("T97 Disjoint wedges about one axis have nothing in common and leave no gap") { check_wedges(1000); }
TEST_CASE("T97 Disjoint wedges about one axis, in a million rays", "[.long]") { check_wedges(100000); }

TEST_CASE("T97 Cones of one apex have nothing in common and leave no gap") { check_cones(500); }
TEST_CASE("T97 Cones of one apex, in a million rays", "[.long]") { check_cones(170000); }
