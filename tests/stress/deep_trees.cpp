// SPDX-License-Identifier: MIT
//
// Trees of a hundred thousand operations, one inside the other (T36, T37): prepared without recursion, evaluated where what is
// left of their depth after joining fits a stack, refused with a place where it does not.
#include <cmath>

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

}  // namespace

TEST_CASE("T36 A chain of twenty thousand cubes is one span") {
    const Operation operation = GENERATE(Operation::union_, Operation::merge);
    constexpr int cubes = 20000;
    SolidMaker maker;
    SpansThrough spans(chain(maker, cubes, operation, false));
    CHECK(spans.messages.errors() == 0);
    const auto along = spans(ray_from({-1, 0.1, 0.2}, {1, 0, 0}));
    REQUIRE(along.size() == 1);
    CHECK(along[0].in == Approx(1).epsilon(1e-15));
    CHECK(along[0].out == Approx(cubes + 1).epsilon(1e-15));
}

TEST_CASE("T37 Alternating operations agree with what they mean, 1500 deep") {
    // Cube i is added where i is odd and taken away where it is even; no two overlap: what was added stays.
    constexpr int cubes = 1500;
    SolidMaker maker;
    SpansThrough spans(chain(maker, cubes, Operation::union_, true));
    CHECK(spans.messages.errors() == 0);
    const auto along = spans(ray_from({-1, 0.1, 0.2}, {1, 0, 0}));
    // [0, 2], [3, 4], [5, 6] …
    REQUIRE(along.size() == cubes / 2);
    CHECK(along[0].out == Approx(3).epsilon(1e-15));
    CHECK(along[1].in == Approx(4).epsilon(1e-15));
    CHECK(along.back().out == Approx(cubes + 1).epsilon(1e-15));
}

TEST_CASE("A tree of a hundred thousand alternating operations is refused, not followed to the end of the stack") {
    SolidMaker maker;
    // Every cube at the same place, so that nothing is pruned.
    SceneNodePtr tree = maker.leaf("sphere");
    for (int i = 0; i < 100000; ++i)
        tree = maker.combine(i % 2 == 0 ? Operation::union_ : Operation::subtraction,
                             {tree, maker.leaf("sphere", {translate(0.1, 0, 0)})});
    SpansThrough spans(tree);
    REQUIRE(spans.messages.errors() == 1);
    CHECK(spans.messages.all()[0].text.find("operations of alternating kind stand") == 0);
    CHECK(spans(ray_from({-3, 0, 0}, {1, 0, 0})).empty());
}
