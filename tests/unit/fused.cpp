// SPDX-License-Identifier: MIT
//
// The products for instruction sets without a fused multiply-add have the bits of those with one.
#include "kernel/math/fused.h"

#include <cstdint>
#include <limits>
#include <random>

#include "support/catch.h"

namespace lapidary {
namespace {

// Equal in all bits; any two that are not numbers are.
bool same(double a, double b) {
    return (std::isnan(a) && std::isnan(b)) || std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

struct Disagreements {
    int products = 0, sums = 0;

    void add(double a, double b, double c) {
        const double product = a * b;
        products += !same(portable::product_error(a, b, product), std::fma(a, b, -product));
        sums += !same(portable::fused_multiply_add(a, b, c), std::fma(a, b, c));
    }
};

class RandomNumbers {
public:
    // Of an exponent between these; some with few bits, some with long runs of ones, where rounding is a close thing.
    double operator()(int lowest, int highest) {
        const std::uint64_t all = (std::uint64_t{1} << 52) - 1, tail = (std::uint64_t{1} << random_() % 53) - 1;
        std::uint64_t fraction = random_() & all;
        if (random_() % 3 == 0) fraction &= ~tail;
        if (random_() % 5 == 0) fraction |= tail;
        const auto exponent = static_cast<std::uint64_t>(lowest) + random_() % static_cast<std::uint64_t>(highest - lowest + 1);
        return std::bit_cast<double>(random_() << 63 | exponent << 52 | (fraction & all));
    }
    // A small number of units in the last place.
    double units() { return static_cast<double>(random_() % 9) * 0x1p-52; }

private:
    std::mt19937_64 random_{2008};
};

TEST_CASE("without an instruction for it, a fused multiply-add has the same bits") {
    RandomNumbers number;
    Disagreements disagreements;
    for (int i = 0; i < 100000; ++i) {
        const double a = number(1000, 1046), b = number(1000, 1046);
        disagreements.add(a, b, number(960, 1100));
        disagreements.add(a, b, number(900, 1150));
        disagreements.add(a, b, -a * b);
        disagreements.add(a, b, -a * b * (1 + number.units()));
    }
    CHECK(disagreements.products == 0);
    CHECK(disagreements.sums == 0);
}

TEST_CASE("nor does it differ at the ends of the range, and for what is no number") {
    RandomNumbers number;
    Disagreements disagreements;
    for (int i = 0; i < 20000; ++i) {
        disagreements.add(number(0, 2047), number(0, 2047), number(0, 2047));
        disagreements.add(number(0, 200), number(800, 1100), number(0, 300));
        disagreements.add(number(1, 80), number(990, 1100), number(0, 120));
        disagreements.add(number(1023, 2046), number(1023, 2046), number(1800, 2047));
    }
    using Limits = std::numeric_limits<double>;
    const double special[] = {
        0,          -0.0,          1,        -1,       Limits::infinity(), -Limits::infinity(), Limits::quiet_NaN(), 0x1p-1074,
        -0x1p-1074, Limits::max(), 0x1p-537, 0x1p-1022};
    for (const double a : special)
        for (const double b : special)
            for (const double c : special) disagreements.add(a, b, c);
    CHECK(disagreements.products == 0);
    CHECK(disagreements.sums == 0);
}

}  // namespace
}  // namespace lapidary
