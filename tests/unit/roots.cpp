// SPDX-License-Identifier: MIT
//
// Where lines run inside the standard surfaces, on cases that can be checked by eye. tests/stress has the hard ones.

#include "kernel/math/roots.h"

#include <random>

#include "support/catch.h"

namespace lapidary {
namespace {

void check_span(const Span& span, double in, double out) {
    CHECK(span.in == Approx(in).margin(1e-15));
    CHECK(span.out == Approx(out).margin(1e-15));
}

}  // namespace

TEST_CASE("the normalizing power of two brings a number near 1 without rounding") {
    std::mt19937_64 engine(1);
    std::uniform_real_distribution<double> mantissa(1, 2);
    std::uniform_int_distribution<int> exponent(-1021, 1020);
    for (int i = 0; i < 2000; ++i) {
        const double x = std::ldexp(mantissa(engine), exponent(engine)), power = normalizing_power_of_two(-x);
        CHECK(power * x >= 0.5);
        CHECK(power * x < 1);
        int ignored = 0;
        CHECK(std::frexp(power, &ignored) == 0.5);
    }
    for (double x : {0.0, 0x1p-1074, 0x1p-1022, 0x1.fffffffffffffp1023}) {
        CHECK(normalizing_power_of_two(x) > 0);
        CHECK(std::isfinite(normalizing_power_of_two(x)));
        CHECK(normalizing_power_of_two(x) * x < 8);
    }
}

TEST_CASE("a ball") {
    check_span(ball_span({{0, 0, 0}, {1, 0, 0}}, 2), -2, 2);
    check_span(ball_span({{0, 3, 0}, {0, 0, 2}}, 5), -2, 2);
    CHECK(ball_span({{0, 1, 0}, {1, 0, 0}}, 1).is_empty());
    CHECK(ball_span({{0, 2, 0}, {1, 0, 0}}, 1).is_empty());
}

TEST_CASE("a tube") {
    check_span(tube_span({{0, 7, 3}, {1, 0, 0}}, 5), -4, 4);
    check_span(tube_span({{0, 0, 0}, {1, 1, 0}}, 1), -1, 1);
    CHECK(tube_span({{0, 0, 1}, {1, 0, 0}}, 1).is_empty());
}

TEST_CASE("a slab and a half-space") {
    check_span(slab_span(1, 2, -1, 5), -1, 2);
    check_span(slab_span(1, -2, -1, 5), -2, 1);
    check_span(half_space_span({{0, 0, 0}, {0, 1, 0}}, 0, 2, 0, 4), -infinity, 2);
    check_span(half_space_span({{0, 0, 0}, {0, -1, 0}}, 0, 2, 0, 4), -2, infinity);
    CHECK_FALSE(half_space_span({{0, 1, 0}, {1, 0, 0}}, 0, 1, 0, 2).is_empty());
    CHECK(half_space_span({{0, 3, 0}, {1, 0, 0}}, 0, 1, 0, 2).is_empty());
    CHECK(half_space_span({{0, 2, 0}, {1, 0, 0}}, 0, 1, 0, 2).is_empty());
}

TEST_CASE("a double cone") {
    Span spans[2];
    SECTION("across one nappe") {
        REQUIRE(double_cone_spans({{0, -1, 0}, {1, 0, 0}}, 0.5, 1, spans) == 1);
        check_span(spans[0], -1, 1);
    }
    SECTION("across both nappes, outside between them") {
        REQUIRE(double_cone_spans({{0.5, 0, 0}, {0, 1, 0}}, 1, 0, spans) == 2);
        check_span(spans[0], -infinity, -0.5);
        check_span(spans[1], 0.5, infinity);
    }
    SECTION("along the axis") {
        REQUIRE(double_cone_spans({{0, 0, 0}, {0, 1, 0}}, 1, 0, spans) == 1);
        check_span(spans[0], -infinity, infinity);
    }
    SECTION("past it") { CHECK(double_cone_spans({{0, 0, 1}, {1, 0.5, 0}}, 0.1, 0, spans) == 0); }
}

TEST_CASE("a torus") {
    Span spans[2];
    REQUIRE(torus_spans({{0, 0, 0}, {0, 0, 1}}, 3, 1, spans) == 2);
    check_span(spans[0], -4, -2);
    check_span(spans[1], 2, 4);
    REQUIRE(torus_spans({{3, 0, 0}, {0, 1, 0}}, 3, 1, spans) == 1);
    check_span(spans[0], -1, 1);
    CHECK(torus_spans({{0, 1, 0}, {1, 0, 0}}, 3, 1, spans) == 0);
    CHECK(torus_spans({{5, 0, 0}, {0, 1, 0}}, 3, 1, spans) == 0);
}

}  // namespace lapidary
