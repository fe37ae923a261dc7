// SPDX-License-Identifier: MIT
#include "kernel/math/float_box.h"

#include <random>

#include "support/catch.h"

namespace lapidary {
namespace {

bool holds(const Bounds& outer, const Bounds& inner) {
    return intersect(outer, inner).contains(inner.low) && outer.contains(inner.high);
}

TEST_CASE("a box of floats holds the box of doubles, and hardly more, wherever its anchor is") {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> coordinate(-1, 1);
    const auto point = [&](double size) {
        return Point{size * coordinate(random), size * coordinate(random), size * coordinate(random)};
    };
    for (const double size : {1e-30, 1e-3, 1.0, 1e9, 1e30})
        for (int i = 0; i < 1000; ++i) {
            CAPTURE(size, i);
            const Point corner = point(size);
            const Bounds box = unite(Bounds{corner, corner}, point(size));
            const Bounds found = FloatBox(box, {}).around({});
            REQUIRE(holds(found, box));
            REQUIRE(found.diagonal().x <= box.diagonal().x + 1e-6 * size);
            REQUIRE(found.diagonal().y <= box.diagonal().y + 1e-6 * size);
            REQUIRE(found.diagonal().z <= box.diagonal().z + 1e-6 * size);
        }
    const Point far{1e9, -3e9, 2e9};
    const Bounds box{far - Vector{1, 1, 1}, far + Vector{2, 2, 2}};
    CHECK(holds(FloatBox(box, far).around(far), box));
    CHECK(FloatBox(box, far).around(far).diagonal().x == Approx(3).epsilon(1e-6));
}

TEST_CASE("boxes without end, beyond all floats, and empty ones stay such as boxes of floats") {
    const Bounds everything = FloatBox(Bounds::everything(), {1, 2, 3}).around({1, 2, 3});
    CHECK(everything.low == Bounds::everything().low);
    CHECK(everything.high == Bounds::everything().high);
    for (const double side : {-1.0, 1.0}) {
        CAPTURE(side);
        const Bounds beyond{{side * 1e200 - 1e199, 0, 0}, {side * 1e200 + 1e199, 1, 1}};
        CHECK(holds(FloatBox(beyond, {}).around({}), beyond));
    }
    CHECK(FloatBox().around({}).is_empty());
    CHECK(FloatBox(Bounds::empty(), {1, 2, 3}).around({1, 2, 3}).is_empty());
}

}  // namespace
}  // namespace lapidary
