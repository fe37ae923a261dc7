// SPDX-License-Identifier: MIT
//
// What holds for every material: of a batch of places it is the same matter, bit for bit, as of each place alone.

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include "conformance/instances.h"
#include "kernel/render/placed_material.h"
#include "support/catch.h"

namespace lapidary::test {
namespace {

using Values = std::array<double, 11>;

Values values_of(const Matter& m) {
    return {m.colour.r, m.colour.g, m.colour.b, m.reflection, m.refraction, m.shininess,
            m.opacity,  m.depth,    m.relief.x, m.relief.y,   m.relief.z};
}

// Zeros of either sign are the same matter, and so are all that are no numbers.
bool are_same(const Values& a, const Values& b) {
    const auto is_same = [](double x, double y) { return x == y || (std::isnan(x) && std::isnan(y)); };
    return std::equal(a.begin(), a.end(), b.begin(), is_same);
}

// Places as on a face; one lane may be far out, or nowhere.
SiteBatch random_sites(Random& random) {
    const double scale = random.magnitude(-2, 2);
    SiteBatch sites;
    for (int lane = 0; lane < batch_size; ++lane) {
        sites.points.set(lane, to_point(scale * random.uniform(0, 1) * random.direction()));
        sites.footprint[lane] = random.below(2) == 0 ? 0 : random.magnitude(-4, 1);
    }
    if (random.below(2) == 0) std::fill_n(sites.footprint, batch_size, random.magnitude(-4, 1));
    constexpr double no_number = std::numeric_limits<double>::quiet_NaN();
    constexpr double odd_coordinates[] = {0, -0.0, 7, 0x1p40, -1e300, infinity, no_number};
    if (random.below(3) == 0) sites.points.y[random.below(batch_size)] = odd_coordinates[random.below(7)];
    return sites;
}

// Some of the lanes: all, one, or any.
unsigned random_lanes(Random& random) {
    const unsigned any = 1 + static_cast<unsigned>(random.below((1 << batch_size) - 1));
    const unsigned choices[] = {(1u << batch_size) - 1, 1u << random.below(batch_size), any};
    return choices[random.below(3)];
}

void check_batch(const Material& material, Random& random) {
    const SiteBatch sites = random_sites(random);
    const unsigned lanes = random_lanes(random);
    const Values untouched{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11};
    MatterBatch matter;
    for (int lane = 0; lane < batch_size; ++lane) matter.set(lane, {{1, 2, 3}, 4, 5, 6, 7, 8, {9, 10, 11}});
    material.evaluate_batch(sites, lanes, matter);
    for (int lane = 0; lane < batch_size; ++lane) {
        const bool asked = (lanes >> lane & 1) != 0;
        const Site site = sites.site(lane);
        CAPTURE(lanes, lane, site.point.x, site.point.y, site.point.z, site.footprint);
        REQUIRE(are_same(values_of(matter.matter(lane)), asked ? values_of(material.evaluate(site)) : untouched));
    }
}

}  // namespace

TEST_CASE("every material is in a batch what it is at each place") {
    Random random(94);
    for (const std::string& keyword : registry().keywords(PluginKind::material)) {
        CAPTURE(keyword);
        for (int i = 0; i < 150; ++i) {
            const MaterialPtr material = random_material(plugin(PluginKind::material, keyword), random, 3);
            for (int j = 0; j < 10; ++j) check_batch(*material, random);
        }
    }
}

TEST_CASE("materials placed anywhere are in a batch what they are at each place") {
    Random random(95);
    const auto keywords = registry().keywords(PluginKind::material);
    for (int i = 0; i < 600; ++i) {
        const std::string& keyword = keywords[static_cast<std::size_t>(random.below(static_cast<int>(keywords.size())))];
        std::vector<TransformFactor> factors;
        if (i % 2 == 0) factors.push_back({TransformFactor::Kind::roty, {random.uniform(-3, 3)}});
        if (i % 3 == 0) factors.push_back({TransformFactor::Kind::scale, {random.magnitude(-1, 1), 2, -1}});
        if (i % 5 < 3)
            factors.push_back(
                {TransformFactor::Kind::translate, {random.uniform(-9, 9), random.uniform(-9, 9), random.uniform(-9, 9)}, true});
        const MaterialPtr inner = random_material(plugin(PluginKind::material, keyword), random, 2);
        CAPTURE(keyword, i);
        const PlacedMaterial placed(inner, ExactTransform::of(factors).value());
        for (int j = 0; j < 10; ++j) check_batch(placed, random);
    }
}

}  // namespace lapidary::test
