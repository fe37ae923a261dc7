// SPDX-License-Identifier: MIT
//
// The laws of set algebra (T26, T27), the order of operands (T39), boxes that change nothing (T41) and scale that changes
// nothing (T42): bit for bit, on random solids that share faces.
#include <algorithm>
#include <array>
#include <functional>
#include <string>

#include "stress/grid_solids.h"
#include "support/first_hits.h"

using namespace lapidary;
using namespace lapidary::test;

namespace {

using Op = Operation;

GridSolid unite(const GridSolid& a, const GridSolid& b) { return combine(Op::union_, {a, b}); }
GridSolid meet(const GridSolid& a, const GridSolid& b) { return combine(Op::intersection, {a, b}); }
GridSolid minus(const GridSolid& a, const GridSolid& b) { return combine(Op::subtraction, {a, b}); }
GridSolid differ(const GridSolid& a, const GridSolid& b) { return combine(Op::symdiff, {a, b}); }

// All of space, in two halves that share a plane in the middle of the grid.
GridSolid everything() {
    GridSolid below;
    below.leaf = {GridLeaf::Kind::half_space, 1, false, {4, 4, 4}, {}};
    GridSolid above = below;
    above.leaf.reversed = true;
    return combine(Op::merge, {below, above});
}
GridSolid without(const GridSolid& a) { return minus(everything(), a); }

struct Law {
    std::string text;
    std::function<GridSolid(const GridSolid&, const GridSolid&, const GridSolid&)> left, right;
};

const std::vector<Law>& laws() {
    using S = const GridSolid&;
    static const std::vector<Law> all{
        {"(A - B) + AB + (B - A) = A + B",
         [](S a, S b, S) {
             return combine(Op::union_, {minus(a, b), meet(a, b), minus(b, a)});
         },
         [](S a, S b, S) { return unite(a, b); }},
        {"not (A + B) = not A, not B", [](S a, S b, S) { return without(unite(a, b)); },
         [](S a, S b, S) { return meet(without(a), without(b)); }},
        {"not AB = not A + not B", [](S a, S b, S) { return without(meet(a, b)); },
         [](S a, S b, S) { return unite(without(a), without(b)); }},
        {"not not A = A", [](S a, S, S) { return without(without(a)); }, [](S a, S, S) { return a; }},
        {"A + BC = (A + B)(A + C)", [](S a, S b, S c) { return unite(a, meet(b, c)); },
         [](S a, S b, S c) { return meet(unite(a, b), unite(a, c)); }},
        {"A (B + C) = AB + AC", [](S a, S b, S c) { return meet(a, unite(b, c)); },
         [](S a, S b, S c) { return unite(meet(a, b), meet(a, c)); }},
        {"A + AB = A", [](S a, S b, S) { return unite(a, meet(a, b)); }, [](S a, S, S) { return a; }},
        {"A (A + B) = A", [](S a, S b, S) { return meet(a, unite(a, b)); }, [](S a, S, S) { return a; }},
        {"A - B = A, not B", [](S a, S b, S) { return minus(a, b); }, [](S a, S b, S) { return meet(a, without(b)); }},
        {"A xor B = (A + B) - AB", [](S a, S b, S) { return differ(a, b); },
         [](S a, S b, S) { return minus(unite(a, b), meet(a, b)); }},
        {"(A xor B) xor B = A", [](S a, S b, S) { return differ(differ(a, b), b); }, [](S a, S, S) { return a; }},
        {"A xor (B xor C) = (A xor B) xor C", [](S a, S b, S c) { return differ(a, differ(b, c)); },
         [](S a, S b, S c) { return differ(differ(a, b), c); }},
        {"A - (B + C) = (A - B) - C", [](S a, S b, S c) { return minus(a, unite(b, c)); },
         [](S a, S b, S c) { return minus(minus(a, b), c); }},
    };
    return all;
}

// The same spans; of a ray that is aimed at an edge or a vertex, to within cells of rounding length.
bool same_spans(const std::vector<Span>& a, const std::vector<Span>& b, const GridPlace& place, Aim aim) {
    if (aim == Aim::anywhere) return same_bits(a, b);
    const double longest = place.size * (1e-12 + 100 * place.rounding());
    const std::vector<Span> x = without_slivers(a, longest), y = without_slivers(b, longest);
    bool same = x.size() == y.size();
    for (std::size_t i = 0; same && i < x.size(); ++i)
        same = (x[i].in == y[i].in || std::fabs(x[i].in - y[i].in) <= longest) &&
               (x[i].out == y[i].out || std::fabs(x[i].out - y[i].out) <= longest);
    return same;
}

Aim aim_of(int ray) { return ray % 4 == 3 ? Aim::vertex : ray % 4 == 2 ? Aim::edge : Aim::anywhere; }

GridPlace any_place() {
    return GENERATE(GridPlace{1, 0}, GridPlace{1, 1e6}, GridPlace{1e-6, 0}, GridPlace{1e-6, 1e3}, GridPlace{1e6, 0});
}

// Both sides of each law in one World, all leaves through chains of their own.
void check_laws(int solids, int rays) {
    const GridPlace place = any_place();
    for (const Law& law : laws()) {
        CAPTURE(law.text, place.size, place.offset);
        Measurement measured({law.text.find("(A - B) +") == 0 ? "T26" : "T27", law.text, "", 0});
        int spans = 0;
        for (int i = 0; i < solids; ++i) {
            SolidMaker maker(static_cast<unsigned>(26 + i));
            const int leaves = 1 + i % 3;
            const GridSolid a = random_solid(maker.random, leaves, true), b = random_solid(maker.random, leaves, true),
                            c = random_solid(maker.random, leaves, true);
            SpansThrough through({scene_node(law.left(a, b, c), place, maker), scene_node(law.right(a, b, c), place, maker)});
            for (int k = 0; k < rays; ++k) {
                const Ray ray = aim_at_grid(maker.random, place, aim_of(k));
                for (const Ray& way : {ray, reversed(ray, 64 * place.size)}) {
                    const std::vector<Span> left = through(way, 0), right = through(way, 1);
                    spans += static_cast<int>(left.size());
                    measured.expect(same_spans(left, right, place, aim_of(k)));
                }
            }
        }
        CHECK(spans > solids * rays / 4);
    }
}

// The operands of commutative operations, and subtrahends, in another order.
GridSolid shuffled(GridSolid solid, std::mt19937_64& random) {
    for (GridSolid& operand : solid.operands) operand = shuffled(operand, random);
    if (!solid.operands.empty())
        std::shuffle(solid.operands.begin() + (solid.operation == Op::subtraction ? 1 : 0), solid.operands.end(), random);
    return solid;
}

void check_permutations(int solids, int rays) {
    const GridPlace place = any_place();
    CAPTURE(place.size, place.offset);
    Measurement measured({"T39", "order of operands", "", 0});
    for (int i = 0; i < solids; ++i) {
        SolidMaker maker(static_cast<unsigned>(39 + i));
        const GridSolid solid = random_solid(maker.random, 4 + i % 20, true);
        SpansThrough through({scene_node(solid, place, maker), scene_node(shuffled(solid, maker.random), place, maker)});
        for (int k = 0; k < rays; ++k) {
            const Ray ray = aim_at_grid(maker.random, place, aim_of(k));
            for (const Ray& way : {ray, reversed(ray, 64 * place.size)})
                measured.expect(same_spans(through(way, 0), through(way, 1), place, aim_of(k)));
        }
    }
}

// An object in a box without bounds: nothing can be left out because of it.
class Unbounded final : public Object {
public:
    explicit Unbounded(std::shared_ptr<const Object> object) : object_(std::move(object)) {}
    Bounds bounds() const override { return Bounds::everything(); }
    int max_spans() const override { return object_->max_spans(); }
    int spans(const LocalLine& line, Span* out) const override { return object_->spans(line, out); }
    int face(const Point& local) const override { return object_->face(local); }
    Normal normal(const Hit& hit) const override { return object_->normal(hit); }
    Surfaces surfaces() const override { return object_->surfaces(); }

private:
    std::shared_ptr<const Object> object_;
};

SceneNodePtr without_bounds(const SceneNodePtr& node) {
    auto copy = std::make_shared<SceneNode>();
    copy->operation = node->operation;
    copy->factors = node->factors;
    copy->transform = node->transform;
    if (node->object) copy->object = std::make_shared<Unbounded>(node->object);
    for (const SceneNodePtr& operand : node->operands) copy->operands.push_back(without_bounds(operand));
    return copy;
}

// The same World with boxes that hold everything and no hierarchy.
std::shared_ptr<const World> with_endless_boxes(const World& world) {
    auto copy = std::make_shared<World>(world);
    for (Node& node : copy->nodes) {
        node.box = FloatBox(Bounds::everything(), {});
        node.united = -1;
    }
    for (Leaf& leaf : copy->leaves) leaf.box = FloatBox(Bounds::everything(), {});
    copy->hierarchy = Hierarchy();
    copy->unbounded.clear();
    for (std::size_t i = 0; i < copy->solids.size(); ++i) copy->unbounded.push_back(static_cast<std::int32_t>(i));
    return copy;
}

void check_bounds(int solids, int rays) {
    const GridPlace place = any_place();
    CAPTURE(place.size, place.offset);
    Measurement boxes({"T41", "boxes on the way", "", 0}), first({"T41", "first hits with and without hierarchy", "", 0}),
        pruning({"T41", "operands out of reach", "", 0});
    for (int i = 0; i < solids; ++i) {
        SolidMaker maker(static_cast<unsigned>(41 + i));
        const GridSolid solid = random_solid(maker.random, 4 + i % 20, true);
        const SceneNodePtr node = scene_node(solid, place, maker);
        SpansThrough boxed(node), unpruned(without_bounds(node)), endless(with_endless_boxes(boxed.world()));
        std::vector<Ray> aimed;
        std::vector<std::vector<Span>> found;
        for (int k = 0; k < rays; ++k) {
            aimed.push_back(aim_at_grid(maker.random, place, aim_of(k)));
            found.push_back(boxed(aimed.back()));
            boxes.expect(same_bits(found.back(), endless(aimed.back())));
            // Where leaves were left out, others may represent the faces.
            pruning.expect(same_spans(found.back(), unpruned(aimed.back()), place, Aim::edge));
        }
        FirstHits(boxed.world()).expect(first, aimed, found);
        FirstHits(endless.world()).expect(first, aimed, found);
    }
}

// One operation over many operands, in a hierarchy of their own, and the same operands looked at one by one: not only positions,
// but also whose face stands there and who owns what is behind it.
void check_many_operands(int solids, int rays) {
    const GridPlace place = any_place();
    CAPTURE(place.size, place.offset);
    Measurement spans({"T41", "many operands, with and without hierarchy", "", 0}),
        leaves({"T41", "whose faces they show", "", 0});
    for (int i = 0; i < solids; ++i) {
        SolidMaker maker(static_cast<unsigned>(141 + i));
        constexpr std::array operations{Op::union_, Op::merge, Op::subtraction};
        GridSolid solid{operations[static_cast<std::size_t>(i) % operations.size()], {}, {}};
        if (solid.operation == Op::subtraction) solid.operands.push_back(box({0, 0, 0}, {8, 8, 8}));
        for (int k = 0; k < 17 + i; ++k) {
            GridSolid operand = random_solid(maker.random, 1 + k % 3, true);
            // Half-spaces would leave nothing of the rest: one, among few.
            if (operand.leaf.kind == GridLeaf::Kind::half_space && k > 5) operand = ball({4, 4, 4}, 1);
            solid.operands.push_back(operand);
        }
        // Within an intersection a union stays what it is.
        const GridSolid whole = combine(Op::intersection, {box({-1, -1, -1}, {9, 9, 9}), solid});
        SpansThrough many(scene_node(whole, place, maker)), one_by_one(with_endless_boxes(many.world()));
        const bool has_hierarchy = !many.world().united_operands.empty();
        CHECK((has_hierarchy || many.world().solids.empty() || many.world().solids[0].is_product));
        for (int k = 0; k < rays; ++k) {
            const Ray ray = aim_at_grid(maker.random, place, aim_of(k));
            for (const Ray& way : {ray, reversed(ray, 64 * place.size)}) {
                const std::vector<Span> found = many(way);
                spans.expect(same_bits(found, one_by_one(way)));
                for (const Span& span : found)
                    for (double t : {span.in, span.out})
                        if (t < infinity) leaves.expect(many.leaves_at(way, t) == one_by_one.leaves_at(way, t));
            }
        }
    }
}

// The same solid at 2^40 and at 2^-40 times its size: every position is that of the original, times a power of two.
void check_scales(int solids, int rays) {
    const double size = GENERATE(0x1p40, 0x1p-40);
    CAPTURE(size);
    Measurement measured({"T42", "sizes that differ by a power of two", "", 0}), first({"T42", "first hits of them", "", 0});
    for (int i = 0; i < solids; ++i) {
        const auto make = [&](const GridPlace& place) {
            SolidMaker maker(static_cast<unsigned>(42 + i));
            const GridSolid solid = random_solid(maker.random, 4 + i % 20, true);
            return scene_node(solid, place, maker);
        };
        SpansThrough once(make({1, 0})), scaled(make({size, 0}));
        std::mt19937_64 random(static_cast<unsigned>(i)), again(static_cast<unsigned>(i));
        std::vector<Ray> aimed;
        std::vector<std::vector<Span>> found;
        for (int k = 0; k < rays; ++k) {
            std::vector<Span> expected = once(aim_at_grid(random, {1, 0}, aim_of(k)));
            for (Span& span : expected) span = {size * span.in, size * span.out};
            aimed.push_back(aim_at_grid(again, {size, 0}, aim_of(k)));
            found.push_back(scaled(aimed.back()));
            measured.expect(same_bits(found.back(), expected));
        }
        FirstHits(scaled.world()).expect(first, aimed, found);
    }
}

}  // namespace

TEST_CASE("T26, T27 the laws of set algebra hold bit for bit") { check_laws(6, 24); }
TEST_CASE("T26, T27 the laws of set algebra, in a million rays", "[.long]") { check_laws(60, 250); }

TEST_CASE("T39 the order of operands changes no position") { check_permutations(20, 100); }
TEST_CASE("T39 the order of operands, in a million rays", "[.long]") { check_permutations(200, 1000); }

TEST_CASE("T41 boxes and hierarchies change no position") { check_bounds(20, 100); }
TEST_CASE("T41 boxes and hierarchies, in a million rays", "[.long]") { check_bounds(200, 1000); }

TEST_CASE("T41 the hierarchy of many operands changes nothing") { check_many_operands(18, 40); }
TEST_CASE("T41 the hierarchy of many operands, in a million rays", "[.long]") { check_many_operands(100, 1000); }

TEST_CASE("T42 a power of two in size changes no digit") { check_scales(20, 100); }
TEST_CASE("T42 a power of two in size, in a million rays", "[.long]") { check_scales(250, 1000); }
