// SPDX-License-Identifier: MIT
//
// Trees of a hundred thousand operations, one inside the other (T36 to T38): prepared without recursion, and evaluated along
// heavy paths where what is left of their depth after joining is too much to be followed from node to node.
#include <pthread.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "support/first_hits.h"
#include "support/measurement.h"
#include "support/solids.h"

using namespace lapidary;

namespace {

// ((c0 op c1) op c2) …, the operations alternating where `alternating`; cube i is the unit cube at [i, i + 1].
SceneNodePtr chain(SolidMaker& maker, int cubes, Operation operation, bool alternating) {
    const auto cube = [&](int i) { return maker.leaf("cube", {scale(0.5, 0.5, 0.5), translate(i + 0.5, 0, 0)}); };
    SceneNodePtr tree = cube(0);
    for (int i = 1; i < cubes; ++i) {
        const bool other = alternating && i % 2 == 0;
        tree = maker.combine(other ? Operation::subtraction : operation, {tree, cube(i)});
    }
    return tree;
}

// A tree, and what it means along the x axis: a leaf holds low <= x < high.
struct KnownTree {
    SceneNodePtr node;
    double low = 0, high = 0;  // of a leaf
    Operation operation = Operation::leaf;
    std::int32_t first = -1, second = -1;
};

// Trees by their nodes, operands before operations: what they mean is evaluated without recursion, too.
class KnownTrees {
public:
    explicit KnownTrees(unsigned seed) : maker_(seed) {}

    // A cube that reaches along x from `low` to `high`.
    std::int32_t leaf(double low, double high) {
        const double half = (high - low) / 2, centre = low + half;
        nodes_.push_back({maker_.leaf("cube", {scale(half, 1, 1), translate(centre, 0, 0)}), low, high});
        return last();
    }
    // Whole numbers, so that ends coincide now and then.
    std::int32_t random_leaf(int range) {
        const double low = whole(0, range);
        return leaf(low, low + 2 * whole(1, 12));
    }
    std::int32_t combine(Operation operation, std::int32_t first, std::int32_t second) {
        nodes_.push_back({maker_.combine(operation, {nodes_[first].node, nodes_[second].node}), 0, 0, operation, first, second});
        return last();
    }
    std::int32_t combine_at_random(std::int32_t first, std::int32_t second) {
        constexpr std::array operations{Operation::union_, Operation::subtraction, Operation::symdiff, Operation::merge};
        // An intersection of two that lie apart would be nothing: now and then, one with what holds everything.
        const int choice = whole(0, 20);
        if (choice == 20) return combine(Operation::intersection, combine(Operation::merge, first, second), leaf(-10, 1e5));
        return combine(operations[static_cast<std::size_t>(choice % 4)], first, second);
    }
    int whole(int low, int high) { return std::uniform_int_distribution<int>(low, high)(maker_.random); }

    const SceneNodePtr& root() const { return nodes_.back().node; }

    // Whether x lies inside of the last node.
    bool holds(double x) const {
        std::vector<bool> inside;
        for (const KnownTree& tree : nodes_) {
            switch (tree.operation) {
                case Operation::leaf:
                    inside.push_back(tree.low <= x && x < tree.high);
                    break;
                case Operation::intersection:
                    inside.push_back(inside[tree.first] && inside[tree.second]);
                    break;
                case Operation::subtraction:
                    inside.push_back(inside[tree.first] && !inside[tree.second]);
                    break;
                case Operation::symdiff:
                    inside.push_back(inside[tree.first] != inside[tree.second]);
                    break;
                default:
                    inside.push_back(inside[tree.first] || inside[tree.second]);
            }
        }
        return inside.back();
    }

private:
    std::int32_t last() const { return static_cast<std::int32_t>(nodes_.size()) - 1; }

    SolidMaker maker_;
    std::vector<KnownTree> nodes_;
};

// A chain of leaves over [0, range), each to the right or to the left of the rest.
enum class TreeShape { comb, left_comb };
void grow(KnownTrees& trees, TreeShape shape, int leaves, int range) {
    std::vector<std::int32_t> open;
    for (int i = 0; i < leaves; ++i) {
        const std::int32_t leaf = trees.random_leaf(range);
        if (open.empty())
            open.push_back(leaf);
        else  // a leaf less a tree would leave little of either
            open[0] = shape == TreeShape::comb ? trees.combine(i % 2 ? Operation::symdiff : Operation::merge, leaf, open[0])
                                               : trees.combine_at_random(open[0], leaf);
    }
}

std::size_t deep_trees_of(const SpansThrough& spans) { return spans.world().deep_trees.size(); }

// Runs a function on a thread with a stack of this many bytes.
void run_on_stack(std::size_t bytes, std::function<void()> function) {
    pthread_attr_t attributes;
    REQUIRE(pthread_attr_init(&attributes) == 0);
    REQUIRE(pthread_attr_setstacksize(&attributes, bytes) == 0);
    pthread_t thread{};
    const auto run = [](void* argument) -> void* {
        (*static_cast<std::function<void()>*>(argument))();
        return nullptr;
    };
    REQUIRE(pthread_create(&thread, &attributes, run, &function) == 0);
    REQUIRE(pthread_join(thread, nullptr) == 0);
    pthread_attr_destroy(&attributes);
}

// One solid, from either end.
void check_merged_chain(int cubes) {
    SolidMaker maker;
    SpansThrough spans(chain(maker, cubes, Operation::merge, false));
    CHECK(spans.messages.errors() == 0);
    test::Measurement whole({"T36", std::to_string(cubes) + " cubes in a row, merged", "", 0});
    for (const double aside : {0.1, -0.3, 0.45})
        for (const Ray& ray : {ray_from({-1, aside, 0.2}, {1, 0, 0}), ray_from({cubes + 1.0, aside, 0.2}, {-1, 0, 0})}) {
            const auto along = whole.timed([&] { return spans(ray); });
            whole.expect(along.size() == 1 && along[0].in == 1 && along[0].out == cubes + 1);
        }
}

// As many solids: their spans as they are, and the one that a ray meets first, which is what has to be quick here.
void check_united_chain(int cubes) {
    SolidMaker maker;
    SpansThrough spans(chain(maker, cubes, Operation::union_, false));
    CHECK(spans.messages.errors() == 0);
    test::Measurement whole({"T36", std::to_string(cubes) + " cubes in a row, united", "", 0}),
        first({"T36", "the first of them", "", 0});
    test::FirstHits hits(spans.world());
    for (const double aside : {0.1, -0.3, 0.45}) {
        const Ray forward = ray_from({-1, aside, 0.2}, {1, 0, 0}), backward = ray_from({cubes + 1.0, aside, 0.2}, {-1, 0, 0});
        const auto along = spans(forward);
        whole.expect(along.size() == 1 && along[0].in == 1 && along[0].out == cubes + 1);
        for (const Ray& ray : {forward, backward})
            first.expect(first.timed([&] { return hits.distances({&ray, 1}, true); }).front() == 1);
    }
}

void check_chain(int cubes) {
    check_merged_chain(cubes);
    check_united_chain(cubes);
}

void check_random_tree(int leaves, int range) {
    const TreeShape shape = GENERATE(TreeShape::comb, TreeShape::left_comb);
    const unsigned seed = GENERATE(1u, 2u, 3u);
    CAPTURE(static_cast<int>(shape), seed);
    KnownTrees trees(seed);
    grow(trees, shape, leaves, range);
    SpansThrough spans(trees.root());
    CHECK(spans.messages.errors() == 0);
    CHECK(deep_trees_of(spans) > 0);
    test::Measurement measured({"T38", "random trees of " + std::to_string(2 * leaves) + " nodes", "", 0});
    const auto along = measured.timed([&] { return spans(ray_from({-1, 0.1, 0.2}, {1, 0, 0})); });
    CHECK(along.size() > 10);
    int held = 0;
    for (int x = 0; x < range + 30; ++x) {
        const double t = x + 1.5;  // between whole numbers
        const auto holds_t = [t](const Span& span) { return span.in <= t && t < span.out; };
        const bool inside = std::any_of(along.begin(), along.end(), holds_t);
        held += inside;
        measured.expect(inside == trees.holds(x + 0.5));
    }
    CHECK(held > range / 50);
}

}  // namespace

TEST_CASE("T36 A chain of twenty thousand cubes is one span") { check_chain(20000); }
TEST_CASE("T36 A chain of a hundred thousand cubes is one span", "[.long]") { check_chain(100000); }

TEST_CASE("T38 Deep random trees agree with what they mean") { check_random_tree(3000, 4000); }
TEST_CASE("T38 Random trees of a hundred thousand nodes agree with what they mean", "[.long]") { check_random_tree(50000, 4000); }

TEST_CASE("T37 Alternating operations agree with what they mean, however deep") {
    // Cube i is added where i is odd and taken away where it is even; no two overlap: what was added stays.
    const int cubes = GENERATE(60, 1500, 5000);
    SolidMaker maker;
    SpansThrough spans(chain(maker, cubes, Operation::union_, true));
    CHECK(spans.messages.errors() == 0);
    test::Measurement measured({"T37", std::to_string(cubes) + " cubes, added and taken away in turn", "", 0});
    const auto along = measured.timed([&] { return spans(ray_from({-1, 0.1, 0.2}, {1, 0, 0})); });
    // From -1 on: [0, 2], [3, 4], [5, 6] …
    REQUIRE(along.size() == static_cast<std::size_t>(cubes / 2));
    for (std::size_t i = 0; i < along.size(); ++i) {
        const auto begin = static_cast<double>(2 * i + (i == 0 ? 1 : 2)), end = static_cast<double>(2 * i + 3);
        measured.expect(along[i].in == begin && along[i].out == end);
    }
}

TEST_CASE("Deep trees name the same faces and owners as shallow ones do") {
    // Ninety operations are followed from node to node; sheathed in sixty more that change nothing, they are too deep for that.
    const auto grown = [](SolidMaker& maker, int sheath) {
        SceneNodePtr tree = maker.leaf("sphere");
        for (int i = 0; i < 91; ++i) {
            constexpr std::array operations{Operation::subtraction, Operation::union_, Operation::symdiff, Operation::merge};
            const Factors place{scale(0.3, 0.3, 0.3), translate(std::cos(i), std::sin(i), 0.4 * std::cos(2.0 * i))};
            tree = maker.combine(operations[i % 4], {tree, maker.leaf(i % 2 ? "cube" : "sphere", place)});
        }
        for (int i = 0; i < sheath; ++i)
            tree = i % 2 ? maker.combine(Operation::symdiff, {tree, maker.leaf("cube", {translate(0, 0, 50)})})
                         : maker.combine(Operation::intersection, {tree, maker.leaf("cube", {scale(99, 99, 99)})});
        return tree;
    };
    SolidMaker deep_maker, shallow_maker;
    SpansThrough deep(grown(deep_maker, 60)), shallow(grown(shallow_maker, 0));
    REQUIRE(deep_trees_of(deep) == 1);
    REQUIRE(deep_trees_of(shallow) == 0);
    std::mt19937_64 random(5);
    std::uniform_real_distribution<double> uniform(-1.2, 1.2);
    std::size_t compared = 0;
    for (int i = 0; i < 1000; ++i) {
        const Ray ray = ray_from({-4, uniform(random), uniform(random)}, {1, 0.2 * uniform(random), 0.2 * uniform(random)});
        const std::vector<double> places = deep.changes(ray);
        REQUIRE(places == shallow.changes(ray));
        for (double t : places) REQUIRE(deep.leaves_at(ray, t) == shallow.leaves_at(ray, t));
        compared += places.size();
    }
    CHECK(compared > 1000);
}

TEST_CASE("Deep trees need little stack, and no stack for each node of their depth") {
    SolidMaker maker;
    // Every ball at the same place, so that nothing is pruned.
    SceneNodePtr tree = maker.leaf("sphere");
    for (int i = 0; i < 20000; ++i)
        tree = maker.combine(i % 2 == 0 ? Operation::union_ : Operation::subtraction,
                             {tree, maker.leaf("sphere", {translate(0.1, 0, 0)})});
    SpansThrough spans(tree);
    CHECK(spans.messages.errors() == 0);
    REQUIRE(deep_trees_of(spans) > 0);
    std::vector<Span> along;
    run_on_stack(64 * 1024, [&] { along = spans(ray_from({-3, 0, 0}, {1, 0, 0})); });
    // What is left of the first ball outside of the others.
    REQUIRE(along.size() == 1);
    CHECK(along[0].in == Approx(2));
    CHECK(along[0].out == Approx(2.1));
}

TEST_CASE("T37 A hundred thousand leaves of alternating operations", "[.long]") {
    const int met = GENERATE(4, 64, 1024);
    const Operation operation = GENERATE(Operation::subtraction, Operation::symdiff);
    constexpr int leaves = 100001;
    SolidMaker maker(7);
    std::uniform_real_distribution<double> uniform(0, 1);
    SceneNodePtr tree = maker.leaf("cube", {scale(1000, 0.1, 0.1)});
    for (int i = 1; i < leaves; ++i) {
        // A ray along x meets about `met` leaves, spread over the whole depth.
        const bool is_met = i % (leaves / met) == 0;
        const Factors place{scale(0.4, 0.4, 0.4),
                            translate(900 * uniform(maker.random), is_met ? 0 : 2 + uniform(maker.random), 0)};
        tree = maker.combine(i % 2 == 0 ? Operation::merge : operation, {tree, maker.leaf("sphere", place)});
    }
    SpansThrough spans(tree);
    CHECK(spans.messages.errors() == 0);
    CHECK(deep_trees_of(spans) > 0);
    const std::string name = operation == Operation::subtraction ? "subtraction" : "symdiff";
    test::Measurement measured({"T37", "1e5 leaves, merge and " + name + ", " + std::to_string(met) + " met", "", 0});
    for (int i = 0; i < 100; ++i) {
        const Ray ray = ray_from({-1500, 1e-4 * i, 0}, {1, 0, 0});
        measured.expect(!measured.timed([&] { return spans(ray); }).empty());
    }
}
