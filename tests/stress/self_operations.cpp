// SPDX-License-Identifier: MIT
//
// T25: every primitive against a copy of itself that stands in the same place by another chain: A − A and A xor A are nothing,
// A ∩ A, A ∪ A and the merge of both are A, whose faces and inside belong to the first. Each ray also comes backward (T40).
#include <fmt/format.h>

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "stress/grid_solids.h"
#include "support/first_hits.h"

using namespace lapidary;
using namespace lapidary::test;

namespace {

struct Primitive {
    std::string keyword;
    std::vector<std::pair<std::string, std::vector<double>>> properties;
};

const std::vector<Primitive>& primitives() {
    static const std::vector<Primitive> all{
        {"sphere", {}},
        {"cube", {{"size", {1, 0.8, 1.2}}}},
        {"plane", {{"thickness", {0.7}}}},
        {"halfspace", {}},
        {"cylinder", {{"radius", {0.7}}}},
        {"cylinder", {{"radius", {0.9}}, {"height", {1.6}}}},
        {"cone", {}},
        {"cone", {{"radii", {1, 0.5}}, {"height", {1.4}}}},
        {"torus", {{"radii", {1, 0.35}}}},
    };
    return all;
}

// A ray from outside through the neighbourhood of the place, and the same line from the other side.
std::array<Ray, 2> both_ways(std::mt19937_64& random, const GridPlace& place) {
    std::uniform_real_distribution<double> uniform(-1, 1);
    const Vector way = normalize(Vector{uniform(random), uniform(random), uniform(random)});
    const std::array<double, 3> aim{uniform(random), uniform(random), uniform(random)};
    const Ray ray = ray_from(place.world({aim[0] - 16 * way.x, aim[1] - 16 * way.y, aim[2] - 16 * way.z}), way);
    return {ray, reversed(ray, 32 * place.size)};
}

void try_copies(const Primitive& primitive, const GridPlace& place, int rays) {
    INFO(fmt::format("{} of size {} at {}", primitive.keyword, place.size, place.offset));
    SolidMaker maker;
    const Factors to_place{scale(place.size, place.size, place.size), rotate({1, 2, 3}, 0.9),
                           translate(place.offset, place.offset, place.offset)};
    const auto copy = [&](int chain) {
        Factors factors = maker.there_and_back(chain);
        factors.insert(factors.end(), to_place.begin(), to_place.end());
        return maker.leaf(primitive.keyword, factors, primitive.properties);
    };
    const auto both = [&](Operation operation) { return SpansThrough(maker.combine(operation, {copy(0), copy(3)})); };
    SpansThrough alone(copy(0));
    std::array<SpansThrough, 2> nothing{both(Operation::subtraction), both(Operation::symdiff)};
    std::array<SpansThrough, 3> itself{both(Operation::intersection), both(Operation::union_), both(Operation::merge)};

    Measurement empty({"T25, T40", "A - A and A xor A", "", 0});
    Measurement same({"T25, T40", "A and A, A or A, and A merged with A", "", 0});
    Measurement ends({"T25, T40", "their ends, against those of A", "u max(size, t²/size)", 8});
    const double size = std::fabs(place.offset) + 32 * place.size;
    // Far off, an unbounded primitive is met at an angle of about size / t: rounding of its place shows as so much longer.
    const auto compare = [&](double end, double expected) {
        if (std::fabs(end) < infinity && std::fabs(expected) < infinity)
            ends.record(std::fabs(end - expected) / (u * std::fmax(size, end * end / size)));
        else
            same.expect(end == expected);
    };
    for (int i = 0; i < rays; ++i)
        for (const Ray& ray : both_ways(maker.random, place)) {
            const std::vector<Span> expected = alone(ray);
            for (SpansThrough& solid : nothing) empty.expect(solid(ray).empty());
            for (SpansThrough& solid : itself) {
                const std::vector<Span> found = solid(ray);
                same.expect(found.size() == expected.size());
                for (std::size_t s = 0; s < found.size() && s < expected.size(); ++s) {
                    const auto [in, out] = found[s];
                    compare(in, expected[s].in), compare(out, expected[s].out);
                    if (in > 0) same.expect(solid.leaves_at(ray, in) == SpansThrough::LeavesAt{1, 1});
                    if (out < infinity) same.expect(solid.leaves_at(ray, out) == SpansThrough::LeavesAt{1, 0});
                }
            }
        }
}

}  // namespace

TEST_CASE("T25, T40 every primitive against a copy of itself") {
    const auto place = GENERATE(GridPlace{1, 0}, GridPlace{1, 1e3}, GridPlace{1e-6, 0}, GridPlace{1e-6, 1e3}, GridPlace{1e6, 0},
                                GridPlace{1e6, 1e9});
    for (const Primitive& primitive : primitives()) try_copies(primitive, place, 100);
}

TEST_CASE("T25, T40 every primitive against a copy of itself, in a million rays", "[.long]") {
    const auto place = GENERATE(GridPlace{1, 0}, GridPlace{1, 1e3}, GridPlace{1e-6, 0}, GridPlace{1e-6, 1e3}, GridPlace{1e6, 0},
                                GridPlace{1e6, 1e9});
    for (const Primitive& primitive : primitives()) try_copies(primitive, place, 10000);
}
