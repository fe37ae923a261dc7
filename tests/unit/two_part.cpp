// SPDX-License-Identifier: MIT
//
// Two-part arithmetic. (That the compiler neither contracts a b + c nor assumes away, on which it stands: stress/same_bits.cpp.)

#include "kernel/math/two_part.h"

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <random>

#include "support/catch.h"

namespace lapidary {
namespace {

using Exact = boost::multiprecision::number<boost::multiprecision::cpp_bin_float<400, boost::multiprecision::digit_base_2>,
                                            boost::multiprecision::et_off>;

Exact exact(const TwoPart& a) { return Exact(a.hi) + Exact(a.lo); }

class Numbers {
public:
    double next() { return std::ldexp(mantissa_(engine_), exponent_(engine_)); }
    TwoPart next_two_part() {
        const double hi = next();
        return quick_two_sum(hi, hi * 0x1p-54 * mantissa_(engine_));
    }

private:
    std::mt19937_64 engine_{5};
    std::uniform_real_distribution<double> mantissa_{-1, 1};
    std::uniform_int_distribution<int> exponent_{-60, 60};
};

}  // namespace

TEST_CASE("sums, differences and products of doubles are exact in two parts") {
    Numbers numbers;
    for (int i = 0; i < 2000; ++i) {
        const double a = numbers.next(), b = numbers.next();
        CHECK(exact(two_sum(a, b)) == Exact(a) + Exact(b));
        CHECK(exact(two_difference(a, b)) == Exact(a) - Exact(b));
        CHECK(exact(two_product(a, b)) == Exact(a) * Exact(b));
    }
}

TEST_CASE("two-part operations keep a hundred bits") {
    Numbers numbers;
    const auto close = [](const TwoPart& found, const Exact& truth) {
        return abs(exact(found) - truth) <= abs(truth) * 0x1p-100;
    };
    for (int i = 0; i < 2000; ++i) {
        const TwoPart a = numbers.next_two_part(), b = numbers.next_two_part();
        CHECK(close(a * b, exact(a) * exact(b)));
        CHECK(close(a / b, exact(a) / exact(b)));
        // A sum may cancel: it is judged against what went in.
        CHECK(abs(exact(a + b) - (exact(a) + exact(b))) <= (abs(exact(a)) + abs(exact(b))) * 0x1p-100);
        CHECK(exact(a - a) == 0);
    }
}

TEST_CASE("the difference of two far points keeps what lies between them") {
    const TwoPartPoint a{{1e15, 1, -3}, {1e-9, 0, 0}}, b{{1e15, 1, 5}, {-1e-9, 0x1p-80, 0}};
    const TwoPartVector d = a - b;
    CHECK(d.hi.x + d.lo.x == 2e-9);
    CHECK(d.hi.y + d.lo.y == -0x1p-80);
    CHECK(d.hi.z + d.lo.z == -8);
}

}  // namespace lapidary
