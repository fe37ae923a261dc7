// SPDX-License-Identifier: MIT
//
// Solids that touch: flush (T28), to within a billionth of a millimetre (T29), at points (T30), in faces that the ray lies in
// (T33), at edges and vertices (T34), and everywhere, a thousand times (T35). All at several scales and far from the origin,
// each leaf placed by a chain of its own, each ray forward and backward.
#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "stress/grid_solids.h"
#include "support/first_hits.h"

using namespace lapidary;
using namespace lapidary::test;

namespace {

GridPlace any_place() {
    return GENERATE(GridPlace{1, 0}, GridPlace{1, 1e3}, GridPlace{1, 1e6}, GridPlace{1e-6, 0}, GridPlace{1e-6, 1e3},
                    GridPlace{1e6, 0});
}

std::array<Ray, 2> both_ways(const Ray& ray, const GridPlace& place) { return {ray, reversed(ray, 64 * place.size)}; }

// From far outside through two places of the grid.
Ray ray_through(const std::array<double, 3>& p, const std::array<double, 3>& q, const GridPlace& place) {
    const Vector way = normalize(Vector{q[0] - p[0], q[1] - p[1], q[2] - p[2]});
    return ray_from(place.world({p[0] - 20 * way.x, p[1] - 20 * way.y, p[2] - 20 * way.z}), way);
}

class Uniform {
public:
    explicit Uniform(unsigned seed) : engine(seed) {}
    double operator()(double low, double high) { return std::uniform_real_distribution<>(low, high)(engine); }

    std::mt19937_64 engine;
};

// Many rays through one solid, first hits included.
class Witness {
public:
    Witness(const SceneNodePtr& node, const GridPlace& place) : place_(place), through_(node) {}

    template <class Judge>
    void look(const Ray& ray, Judge judge) {
        for (const Ray& way : both_ways(ray, place_)) {
            rays_.push_back(way);
            found_.push_back(through_(way));
            judge(way, found_.back());
        }
    }
    void expect_first_hits(Measurement& measured) { FirstHits(through_.world()).expect(measured, rays_, found_); }

private:
    GridPlace place_;
    SpansThrough through_;
    std::vector<Ray> rays_;
    std::vector<std::vector<Span>> found_;
};

void check_flush_hole(int rays) {
    const GridPlace place = any_place();
    CAPTURE(place.size, place.offset);
    SolidMaker maker(28);
    const GridSolid solid = combine(Operation::subtraction, {box({0, 0, 0}, {8, 8, 8}), rod({4, 4, 4}, 2, 8)});
    Witness witness(scene_node(solid, place, maker), place);
    GridComparison comparison(place, "T28", "box with a flush hole");
    Measurement skin({"T28", "rays through a flush hole", "", 0}), first({"T28", "first hits of them", "", 0});
    Uniform uniform(28);
    // Along the axis, along lines beside it, from a place of one cap to a place of the other: nothing is met.
    const auto sees_nothing = [&](const Ray&, const std::vector<Span>& spans) { skin.expect(spans.empty()); };
    witness.look(ray_through({4, 0, 4}, {4, 8, 4}, place), sees_nothing);
    const auto in_cap = [&](double y) {
        const double radius = 1.999 * std::sqrt(uniform(0, 1)), angle = uniform(0, 7);
        return std::array<double, 3>{4 + radius * std::cos(angle), y, 4 + radius * std::sin(angle)};
    };
    for (int i = 0; i < rays; ++i) {
        const std::array<double, 3> p = in_cap(0), q = in_cap(8);
        witness.look(ray_through(p, {p[0], 8, p[2]}, place), sees_nothing);
        witness.look(ray_through(p, q, place), sees_nothing);
        // Any way: what the ideal solid is.
        witness.look(aim_at_grid(uniform.engine, place, Aim::anywhere), [&](const Ray& ray, const std::vector<Span>& spans) {
            comparison.compare(solid, ray, spans, Aim::anywhere);
        });
    }
    witness.expect_first_hits(first);
}

// A ball less a ball that is thinner by `thickness`, seen from a distance: two spans of the right length.
void check_shells(double thickness, double distance, int rays) {
    CAPTURE(thickness, distance);
    SolidMaker maker(29);
    Random random(29);
    const double inner = 1 - thickness;
    const auto ball_of = [&](double radius) { return maker.leaf("sphere", maker.there_and_back(3), {{"radius", {radius}}}); };
    SpansThrough through(maker.combine(Operation::subtraction, {ball_of(1), ball_of(inner)}));
    Measurement measured({"T29", fmt::format("shell of {:g} from {:g} away", thickness, distance), "u (t + size)", 4});
    for (int i = 0; i < rays; ++i) {
        const Vector d = random.direction();
        const Point beside = to_point(random.uniform(0, 0.9) * normalize(cross(d, random.direction())));
        const Ray ray = ray_from(beside - distance * d, d);
        const std::vector<Span> spans = through(ray);
        measured.expect(spans.size() == 2);
        if (spans.size() != 2) continue;
        const ExactVector o = ray.origin.anchor, v = ray.direction;
        const std::vector<Exact> outer_roots = quadratic_roots(sphere_polynomial(o, v, 1));
        const std::vector<Exact> inner_roots = quadratic_roots(sphere_polynomial(o, v, inner));
        const double scale = u * (distance + 2);
        for (int side = 0; side < 2; ++side) {
            const Exact length = abs(outer_roots[static_cast<std::size_t>(side)] - inner_roots[static_cast<std::size_t>(side)]);
            const Span& span = spans[static_cast<std::size_t>(side)];
            measured.record(std::fabs(static_cast<double>(span.out - span.in - length)) / scale);
        }
    }
}

void check_inscribed_ball(int rays) {
    const GridPlace place = any_place();
    CAPTURE(place.size, place.offset);
    SolidMaker maker(30);
    const GridSolid solid = combine(Operation::subtraction, {box({0, 0, 0}, {8, 8, 8}), ball({4, 4, 4}, 4)});
    Witness witness(scene_node(solid, place, maker), place);
    GridComparison comparison(place, "T30", "box less its inscribed ball");
    Measurement phantom({"T30", "rays through opposite contacts", "", 0}), first({"T30", "first hits", "", 0});
    Uniform uniform(30);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        std::array<double, 3> near{4, 4, 4}, far{4, 4, 4};
        near[axis] = 0;
        far[axis] = 8;
        witness.look(ray_through(near, far, place),
                     [&](const Ray&, const std::vector<Span>& spans) { phantom.expect(spans.empty()); });
        for (int i = 0; i < rays; ++i) {
            const std::array<double, 3> through{uniform(0, 8), uniform(0, 8), uniform(0, 8)};
            for (const std::array<double, 3>& contact : {near, far})
                witness.look(ray_through(contact, through, place), [&](const Ray& ray, const std::vector<Span>& spans) {
                    comparison.compare(solid, ray, spans, Aim::vertex);
                });
        }
    }
    CHECK(comparison.cells() > rays);
    witness.expect_first_hits(first);
}

// Boxes that fill a box: one span along every ray that meets it, in-face and along edges, too.
void check_filled(const std::string& test, const std::vector<GridSolid>& boxes, const std::vector<Ray>& rays,
                  const GridPlace& place) {
    SolidMaker maker(34);
    std::vector<GridSolid> even, odd;
    for (std::size_t i = 0; i < boxes.size(); ++i) (i % 2 == 0 ? even : odd).push_back(boxes[i]);
    const GridSolid united = combine(Operation::union_, boxes), whole = box({0, 0, 0}, {8, 8, 8});
    SpansThrough through(
        {scene_node(united, place, maker), scene_node(combine(Operation::merge, boxes), place, maker),
         scene_node(combine(Operation::symdiff, boxes), place, maker), scene_node(whole, place, maker),
         scene_node(combine(Operation::subtraction, {whole, united}), place, maker),
         scene_node(combine(Operation::intersection, {combine(Operation::union_, even), combine(Operation::union_, odd)}), place,
                    maker)});
    Measurement gap({test, "boxes that fill a box, along their faces and edges", "", 0}),
        nothing({test, "what they leave, and what they share", "", 0});
    for (const Ray& ray : rays)
        for (const Ray& way : both_ways(ray, place)) {
            const std::vector<Span> expected = through(way, 3);
            REQUIRE(expected.size() == 1);
            for (std::size_t root = 0; root < 3; ++root) {
                const std::vector<Span> spans = through(way, root);
                gap.expect(spans.size() == 1 && spans[0].in == expected[0].in && spans[0].out == expected[0].out);
            }
            nothing.expect(through(way, 4).empty());
            nothing.expect(through(way, 5).empty());
        }
}

// Rays in the plane through `middle` across the first axis, along the edge that two axes cross in, and through the vertex.
std::vector<Ray> rays_within(const std::array<double, 3>& middle, int count, const GridPlace& place) {
    Uniform uniform(33);
    std::vector<Ray> rays;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        std::array<double, 3> end = middle;
        end[axis] = 8;
        rays.push_back(ray_through(middle, end, place));
    }
    for (int i = 0; i < count; ++i)
        for (std::size_t axis = 0; axis < 3; ++axis) {
            std::array<double, 3> in_face{uniform(1, 7), uniform(1, 7), uniform(1, 7)};
            std::array<double, 3> other{uniform(1, 7), uniform(1, 7), uniform(1, 7)};
            rays.push_back(ray_through(middle, other, place));
            in_face[axis] = other[axis] = middle[axis];
            rays.push_back(ray_through(in_face, other, place));
            rays.push_back(ray_through(middle, other, place));
        }
    return rays;
}

void check_face_sharing(int rays) {
    const GridPlace place = any_place();
    CAPTURE(place.size, place.offset);
    check_filled("T33", {box({0, 0, 0}, {4, 8, 8}), box({4, 0, 0}, {8, 8, 8})}, rays_within({4, 4, 4}, rays, place), place);

    // A ray in the shared face is in exactly one of the two, forward and backward the same one.
    const bool turned = GENERATE(false, true);
    SolidMaker maker(33);
    const int chain = turned ? 3 : 0;
    SpansThrough through(
        {scene_node(box({0, 0, 0}, {4, 8, 8}), place, maker, chain), scene_node(box({4, 0, 0}, {8, 8, 8}), place, maker, chain)});
    Uniform uniform(33);
    Measurement held({"T33", "rays in the face that two boxes share", "", 0});
    for (int i = 0; i < rays; ++i) {
        const Ray ray = ray_through({4, uniform(1, 7), uniform(1, 7)}, {4, uniform(1, 7), uniform(1, 7)}, place);
        std::array<bool, 2> in_first{};
        for (std::size_t way = 0; way < 2; ++way) {
            const Ray line = both_ways(ray, place)[way];
            const std::vector<Span> a = through(line, 0), b = through(line, 1);
            // What rounding has turned, the ray may cross on its way.
            held.expect(turned ? !a.empty() || !b.empty() : a.empty() != b.empty());
            in_first[way] = !a.empty();
        }
        held.expect(turned || in_first[0] == in_first[1]);
    }
}

}  // namespace

TEST_CASE("T28, T40 a flush hole has no skin") { check_flush_hole(150); }
TEST_CASE("T28, T40 a flush hole, in a million rays", "[.long]") { check_flush_hole(28000); }

TEST_CASE("T29 shells of 1e-12 keep their thickness") {
    for (const double distance : {1.5, 3.0, 10.0, 100.0, 1e3, 1e4})
        for (const double thickness : {1e-12, 1e-11, 1e-9, 1e-3})
            if (thickness > 4 * 0x1p-52 * distance) check_shells(thickness, distance, 300);  // else t cannot tell
}

TEST_CASE("T30, T40 rays through the contacts of a box and its inscribed ball pass") { check_inscribed_ball(60); }
TEST_CASE("T30, T40 rays through the contacts of a box and its inscribed ball, in a million rays", "[.long]") {
    check_inscribed_ball(14000);
}

TEST_CASE("T33, T40 rays in a face that two boxes share are in one of them") { check_face_sharing(100); }
TEST_CASE("T33, T40 rays in a face that two boxes share, in a million rays", "[.long]") { check_face_sharing(9000); }

TEST_CASE("T34, T40 boxes that meet at edges and vertices leave no gap along them") {
    const GridPlace place = any_place();
    CAPTURE(place.size, place.offset);
    const std::vector<Ray> rays = rays_within({4, 4, 4}, 40, place);
    // Three at an edge, four at an edge, and the eight at a vertex.
    check_filled("T34", {box({0, 0, 0}, {4, 8, 8}), box({4, 0, 0}, {8, 4, 8}), box({4, 4, 0}, {8, 8, 8})}, rays, place);
    check_filled("T34",
                 {box({0, 0, 0}, {4, 4, 8}), box({4, 0, 0}, {8, 4, 8}), box({4, 4, 0}, {8, 8, 8}), box({0, 4, 0}, {4, 8, 8})},
                 rays, place);
    check_filled("T34",
                 {box({0, 0, 0}, {8, 8, 4}), box({0, 0, 4}, {8, 4, 8}), box({0, 4, 4}, {4, 8, 8}), box({4, 4, 4}, {8, 8, 8})},
                 rays, place);
    std::vector<GridSolid> octants;
    for (int i : {0, 3, 5, 6, 1, 2, 4, 7}) {  // neighbours of even number are not neighbours
        const std::array<double, 3> low{4.0 * (i & 1), 4.0 * (i >> 1 & 1), 4.0 * (i >> 2)};
        octants.push_back(box(low, {low[0] + 4, low[1] + 4, low[2] + 4}));
    }
    check_filled("T34", octants, rays, place);
}

TEST_CASE("T35 a thousand copies of one box are the box, or nothing") {
    const GridPlace place = GENERATE(GridPlace{1, 0}, GridPlace{1, 1e6}, GridPlace{1e-6, 0});
    CAPTURE(place.size, place.offset);
    SolidMaker maker(35);
    const std::vector<GridSolid> even(1000, box({1, 2, 3}, {7, 6, 5})), odd(999, even[0]);
    const std::array<SceneNodePtr, 3> nodes{scene_node(combine(Operation::union_, even), place, maker, 1),
                                            scene_node(combine(Operation::symdiff, even), place, maker, 1),
                                            scene_node(combine(Operation::symdiff, odd), place, maker, 1)};
    SpansThrough through({nodes.begin(), nodes.end()});
    Measurement measured({"T35", "a thousand copies of a box", "", 0});
    std::mt19937_64 random(35);
    int met = 0;
    std::uint64_t most_tests = 0;
    for (int i = 0; i < 30; ++i) {
        const Aim aim = i % 3 == 0 ? Aim::edge : Aim::anywhere;
        const Ray ray = aim_at_grid(random, place, aim);
        for (const Ray& way : both_ways(ray, place)) {
            const std::vector<Span> united = through(way, 0);
            const std::uint64_t before = through.statistics().object_tests;
            measured.expect(measured.timed([&] { return through(way, 1); }).empty());
            const std::vector<Span> once = through(way, 2);
            most_tests = std::max(most_tests, through.statistics().object_tests - before);
            met += !united.empty();
            measured.expect(united.size() <= 1 && same_bits(once, united));
        }
    }
    CHECK(met > 10);
    CHECK(most_tests <= 1999);  // every copy is asked once
}
