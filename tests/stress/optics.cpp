// SPDX-License-Identifier: MIT
//
// Paths of light through overlapping, nested and touching solids of clear matter, face by face against an oracle in 200-bit
// arithmetic that shares nothing with the code under test: it sorts the roots of all surfaces along a line, asks in the
// middle between neighbours what is there, and bends the ray by the vector form of Snell's law.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "stress/exact.h"
#include "support/catch.h"
#include "support/measurement.h"
#include "support/traced_scene.h"

using namespace lapidary;
using namespace lapidary::test;

namespace {

constexpr int depth = 8;  // turns of a path

ExactVector operator+(const ExactVector& a, const ExactVector& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
ExactVector operator*(const Exact& s, const ExactVector& v) { return {s * v.x, s * v.y, s * v.z}; }
ExactVector unit(const ExactVector& v) { return Exact(1 / sqrt(dot(v, v))) * v; }

// A ball, the side of a plane where normal . p < offset, or a torus about the y axis.
struct ExactSurface {
    enum class Kind { ball, plane, torus };
    Kind kind;
    ExactVector vector{Exact(0), Exact(0), Exact(0)};  // the ball's centre or the plane's normal
    double a = 0, b = 0;                               // radius or offset; the two radii of a torus

    static ExactSurface ball(const Point& centre, double radius) { return {Kind::ball, centre, radius, 0}; }
    static ExactSurface below(const ExactVector& normal, double offset) { return {Kind::plane, normal, offset, 0}; }
    static ExactSurface torus(double major, double minor) { return {Kind::torus, {Exact(0), Exact(0), Exact(0)}, major, minor}; }

    // Negative inside, as a polynomial in t along o + t d.
    Polynomial polynomial(const ExactVector& o, const ExactVector& d) const {
        if (kind == Kind::plane) return {dot(vector, o) - a, dot(vector, d)};
        if (kind == Kind::torus) return torus_polynomial(o, d, a, b);
        const ExactVector from_centre = o + Exact(-1) * vector;
        return {dot(from_centre, from_centre) - Exact(a) * a, 2 * dot(from_centre, d), dot(d, d)};
    }
    bool holds(const ExactVector& p) const { return polynomial(p, {Exact(1), Exact(0), Exact(0)})[0] < 0; }
    ExactVector normal(const ExactVector& p) const {
        if (kind == Kind::plane) return unit(vector);
        if (kind == Kind::ball) return unit(p + Exact(-1) * vector);
        const Exact ring = a / sqrt(p.x * p.x + p.z * p.z);  // from the circle in the middle of the tube
        return unit(p + Exact(-1) * ExactVector{ring * p.x, Exact(0), ring * p.z});
    }
    std::vector<Exact> roots(const ExactVector& o, const ExactVector& d) const {
        const Polynomial p = polynomial(o, d);
        if (kind == Kind::torus) return sign_changes(p, Exact("1e-40"), 100);
        if (kind == Kind::ball) return quadratic_roots(p);
        return p[1] == 0 ? std::vector<Exact>{} : std::vector<Exact>{-p[0] / p[1]};
    }
};

// What is where: an owner (0: empty space) by the surfaces that hold a point, and the owners' indices.
struct ExactMatter {
    std::vector<ExactSurface> surfaces;
    std::function<std::size_t(const std::vector<bool>&)> owner;
    std::vector<double> indices;
};

struct ExactEvent {
    std::uint64_t branch;
    ExactVector point;
    double index_before, index_behind;
};

class Oracle {
public:
    explicit Oracle(const ExactMatter& matter) : matter_(matter) {}

    // The events of all paths with at most `mirrors` partial reflections; total ones do not count.
    std::vector<ExactEvent> trace(const ExactVector& origin, const ExactVector& direction, int mirrors) {
        events_.clear();
        follow(origin, direction, 1, 0, mirrors);
        return std::move(events_);
    }

    // Branches that total reflection forbids.
    std::vector<std::uint64_t> forbidden;

private:
    void follow(const ExactVector& origin, const ExactVector& direction, std::uint64_t branch, int turns, int mirrors) {
        struct Root {
            Exact t;
            const ExactSurface* surface;
        };
        const Exact tiny("1e-40");
        std::vector<Root> roots;
        for (const ExactSurface& surface : matter_.surfaces)
            for (const Exact& t : surface.roots(origin, direction))
                if (t > tiny) roots.push_back({t, &surface});
        std::sort(roots.begin(), roots.end(), [](const Root& a, const Root& b) { return a.t < b.t; });

        Exact from = 0;
        for (std::size_t i = 0; i < roots.size();) {
            std::size_t next = i + 1;  // behind all roots at the same place
            while (next < roots.size() && roots[next].t - roots[i].t < tiny) ++next;
            const Exact t = roots[i].t, beyond = next < roots.size() ? roots[next].t : Exact(t + 1);
            const std::size_t before = owner_at(at(origin, direction, (from + t) / 2));
            const std::size_t behind = owner_at(at(origin, direction, (t + beyond) / 2));
            const ExactSurface& surface = *roots[i].surface;
            i = next;
            from = t;
            if (before == behind) continue;
            const ExactVector point = at(origin, direction, t);
            const double n1 = matter_.indices[before], n2 = matter_.indices[behind];
            events_.push_back({branch, point, n1, n2});
            if (n1 == n2) continue;
            if (turns < depth) turn(point, surface.normal(point), direction, n1, n2, branch, turns, mirrors);
            return;
        }
    }

    void turn(const ExactVector& point, ExactVector normal, const ExactVector& direction, double n1, double n2,
              std::uint64_t branch, int turns, int mirrors) {
        if (dot(normal, direction) > 0) normal = Exact(-1) * normal;
        const Exact cosine = -dot(normal, direction), eta = Exact(n1) / n2;
        const Exact squared = 1 - eta * eta * (1 - cosine * cosine);
        if (squared > 0)
            follow(point, unit(eta * direction + Exact(eta * cosine - sqrt(squared)) * normal), 2 * branch + 1, turns + 1,
                   mirrors);
        else
            forbidden.push_back(2 * branch + 1);
        if (squared <= 0 || mirrors > 0)
            follow(point, unit(direction + Exact(2 * cosine) * normal), 2 * branch, turns + 1, mirrors - (squared > 0));
    }

    std::size_t owner_at(const ExactVector& p) const {
        std::vector<bool> inside;
        for (const ExactSurface& surface : matter_.surfaces) inside.push_back(surface.holds(p));
        return matter_.owner(inside);
    }

    const ExactMatter& matter_;
    std::vector<ExactEvent> events_;
};

struct Example {
    std::string name, text;
    ExactMatter matter;
    int cost = 1;  // of a ray for the oracle: others take as many more rays
};

const Point a_centre{0, 0, 0}, b_centre{0.75, 0.25, 0.125};

std::string ball_text(const Point& centre, double radius, double index, const std::string& more = "") {
    return fmt::format("sphere {{ radius({}); transform {{ translate({},{},{}); }} {} {} }} ", radius, centre.x, centre.y,
                       centre.z, more, glass(index));
}

// Of the listed surfaces the first that holds the point owns it.
std::size_t first_inside(const std::vector<bool>& inside) {
    for (std::size_t i = 0; i < inside.size(); ++i)
        if (inside[i]) return i + 1;
    return 0;
}

ExactMatter two_balls(double index_a, double index_b) {
    return {{ExactSurface::ball(a_centre, 1), ExactSurface::ball(b_centre, 0.75)}, first_inside, {1, index_a, index_b}};
}
std::string two_balls_text(double index_a, double index_b) {
    return ball_text(a_centre, 1, index_a) + ball_text(b_centre, 0.75, index_b);
}

std::vector<Example> examples() {
    std::vector<Example> all;
    all.push_back({"union of two balls of one glass", "union { " + two_balls_text(1.5, 1.5) + "}", two_balls(1.5, 1.5)});
    all.push_back({"union of two glasses", "union { " + two_balls_text(1.5, 1.25) + "}", two_balls(1.5, 1.25)});
    all.push_back({"two solids of two glasses", two_balls_text(1.25, 1.75), two_balls(1.25, 1.75)});
    ExactMatter merged = two_balls(1.5, 1.5);
    merged.owner = [](const std::vector<bool>& inside) { return static_cast<std::size_t>(inside[0] || inside[1]); };
    all.push_back({"merge of two balls", "merge { " + two_balls_text(1.5, 1.5) + "}", merged});

    ExactMatter either = two_balls(1.5, 1.25), common = either, cut = either;
    either.owner = [](const std::vector<bool>& inside) { return inside[0] && inside[1] ? 0 : first_inside(inside); };
    common.owner = [](const std::vector<bool>& inside) { return static_cast<std::size_t>(inside[0] && inside[1]); };
    cut.owner = [](const std::vector<bool>& inside) { return static_cast<std::size_t>(inside[0] && !inside[1]); };
    all.push_back({"symmetric difference of two balls", "symdiff { " + two_balls_text(1.5, 1.25) + "}", either});
    all.push_back({"intersection of two balls", "intersection { " + two_balls_text(1.5, 1.25) + "}", common});
    all.push_back({"difference of two balls", "subtraction { " + two_balls_text(1.5, 1.25) + "}", cut});
    all.push_back({"torus about a ball",
                   "torus { radii(1.25,0.5); " + glass(1.5) + "} " + ball_text(a_centre, 1, 1.25),
                   {{ExactSurface::torus(1.25, 0.5), ExactSurface::ball(a_centre, 1)}, first_inside, {1, 1.5, 1.25}},
                   8});

    const Point glass_centre{0.25, 0, 0}, bubble_centre{0.5, 0.125, 0};
    all.push_back({"bubble in glass in water",
                   ball_text(a_centre, 3, 1.333) + ball_text(glass_centre, 2, 1.5, "priority(1);") +
                       ball_text(bubble_centre, 1, 1, "priority(2);"),
                   {{ExactSurface::ball(bubble_centre, 1), ExactSurface::ball(glass_centre, 2), ExactSurface::ball(a_centre, 3)},
                    first_inside,
                    {1, 1, 1.5, 1.333}}});
    all.push_back({"glass that fills a hollow of another glass",
                   "subtraction { " + ball_text(a_centre, 2, 1.5) + "} with { " + ball_text(b_centre, 1, 1.2) + "} union { " +
                       ball_text(b_centre, 1, 1.25) + "} ",
                   {{ExactSurface::ball(b_centre, 1), ExactSurface::ball(a_centre, 2)}, first_inside, {1, 1.25, 1.5}}});
    all.push_back({"one ball of two glasses, twice",
                   "union { " + ball_text(a_centre, 2, 1.5) + ball_text(a_centre, 2, 1.25) + "}",
                   {{ExactSurface::ball(a_centre, 2)}, first_inside, {1, 1.5}}});

    // Cut by one plane from two sides, the plane having come to its place in different ways.
    const std::string turned = "halfspace { transform { rotz(0.3); } } ",
                      turned_back = "halfspace { transform { rotz(1.3); rotz(-1); } } ";
    all.push_back({"a ball cut in two glasses",
                   "intersection { " + ball_text(a_centre, 2, 1.5) + "} with { " + turned + "} subtraction { " +
                       ball_text(a_centre, 2, 1.25) + "} with { " + turned_back + "} ",
                   {{ExactSurface::ball(a_centre, 2), ExactSurface::below({-sin(Exact(0.3)), cos(Exact(0.3)), 0}, 0)},
                    [](const std::vector<bool>& inside) { return inside[0] ? (inside[1] ? std::size_t{1} : 2) : 0; },
                    {1, 1.5, 1.25}}});

    // Two boxes side by side, the second reaching further down.
    const auto between = [](const ExactVector& axis, double low, double high) {
        return std::array{ExactSurface::below(axis, high), ExactSurface::below(Exact(-1) * axis, -low)};
    };
    const ExactVector x{Exact(1), Exact(0), Exact(0)}, y{Exact(0), Exact(1), Exact(0)}, z{Exact(0), Exact(0), Exact(1)};
    ExactMatter boxes;
    for (const auto& [axis, low, high] :
         {std::tuple{x, -1.0, 1.0}, {y, -1.0, 1.0}, {z, -1.0, 1.0}, {x, 1.0, 2.0}, {y, -1.5, 0.5}})
        for (const ExactSurface& side : between(axis, low, high)) boxes.surfaces.push_back(side);
    boxes.owner = [](const std::vector<bool>& inside) {
        const auto in = [&](std::size_t slab) { return inside[2 * slab] && inside[2 * slab + 1]; };
        return in(0) && in(1) && in(2) ? std::size_t{1} : in(3) && in(4) && in(2) ? std::size_t{2} : std::size_t{0};
    };
    boxes.indices = {1, 1.5, 1.25};
    all.push_back({"boxes side by side",
                   "cube { " + glass(1.5) +
                       "} cube { size(0.5,1,1); transform { rotx(0.7); rotx(-0.7); translate(1.5,-0.5,0); } " + glass(1.25) +
                       "} ",
                   boxes});

    // All stand within a wall, where paths end.
    for (Example& example : all) {
        example.text = fmt::format("render {{ depth({}); cutoff(0); }} objects {{ {} {} }}", depth, example.text, wall);
        const std::size_t wall_surface = example.matter.surfaces.size(), wall_owner = example.matter.indices.size();
        example.matter.surfaces.push_back(ExactSurface::ball({}, 50));
        example.matter.indices.push_back(1);
        example.matter.owner = [inner = example.matter.owner, wall_surface, wall_owner](std::vector<bool> inside) {
            if (!inside[wall_surface]) return wall_owner;
            inside.pop_back();
            return inner(inside);
        };
    }
    return all;
}

struct Tally {
    int rays = 0;
    std::size_t events = 0;
    double worst = 0;
};

// Compares the events branch by branch.
bool is_right(const TracedRay& traced, const std::vector<ExactEvent>& exact, const std::vector<std::uint64_t>& forbidden,
              Tally& tally) {
    for (const std::uint64_t branch : forbidden)
        if (traced.has_branch(branch)) return false;
    for (std::size_t i = 0; i < exact.size();) {
        const std::uint64_t branch = exact[i].branch;
        for (const PathEvent& event : traced.events) {
            if (event.branch != branch) continue;
            if (i >= exact.size() || exact[i].branch != branch) return false;  // one too many
            const ExactVector point = exact[i].point;
            const ExactVector apart{point.x - event.point.anchor.x - event.point.offset.x,
                                    point.y - event.point.anchor.y - event.point.offset.y,
                                    point.z - event.point.anchor.z - event.point.offset.z};
            const double distance = static_cast<double>(Exact(sqrt(dot(apart, apart))));
            const bool is_wall = dot(point, point) > 2000;
            if (!is_wall) tally.worst = std::max(tally.worst, distance);
            if (!(distance < (is_wall ? 1e-6 : 1e-8))) return false;
            if (!is_wall && (event.index_before != exact[i].index_before || event.index_behind != exact[i].index_behind))
                return false;
            ++i;
            ++tally.events;
        }
        if (i < exact.size() && exact[i].branch == branch) return false;  // one too few
    }
    return true;
}

void check_paths(int rays) {
    for (const Example& example : examples()) {
        CAPTURE(example.name);
        TracedScene scene(example.text);
        Random random(21);
        Tally tally;
        Measurement paths({"T63-T68", "paths: " + example.name, "", 0}),
            places({"T63-T68", "places: " + example.name, "length", 1e-8});
        for (; tally.rays < rays / example.cost; ++tally.rays) {
            const Point origin = to_point(8 * random.direction());
            const Point aim = to_point(random.uniform(0, 2) * random.direction());
            const Vector direction = normalize(aim - origin);
            const TracedRay traced = paths.timed([&] { return scene.trace(origin, direction); });
            // The direction as the tracer got it.
            const Vector given = traced.events.front().direction;
            Oracle oracle(example.matter);
            const auto exact = oracle.trace(origin, unit(given), 1);
            paths.expect(is_right(traced, exact, oracle.forbidden, tally));
        }
        places.record(tally.worst);
        CHECK(tally.events > 2 * static_cast<std::size_t>(tally.rays));
    }
}

}  // namespace

TEST_CASE("Paths through glass are those of an exact oracle") { check_paths(600); }

TEST_CASE("Paths through glass are those of an exact oracle, in a hundred thousand rays", "[.long]") { check_paths(12000); }
