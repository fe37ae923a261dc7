// SPDX-License-Identifier: MIT
//
// What every texture is at a point: the formulas of the scene language, worked out here once more.

#include <numbers>
#include <random>

#include "lapidary/noise.h"
#include "support/catch.h"
#include "support/textures.h"

namespace lapidary {

using namespace test;

namespace {

Point random_point(std::mt19937_64& generator, double reach = 20) {
    std::uniform_real_distribution<double> coordinate(-reach, reach);
    const double x = coordinate(generator), y = coordinate(generator), z = coordinate(generator);
    return {x, y, z};
}

// The gradient of a height by central differences.
template <class Height>
Vector slope_of(const Height& height, const Point& p, double h = 1e-5) {
    return {(height({p.x + h, p.y, p.z}) - height({p.x - h, p.y, p.z})) / (2 * h),
            (height({p.x, p.y + h, p.z}) - height({p.x, p.y - h, p.z})) / (2 * h),
            (height({p.x, p.y, p.z + h}) - height({p.x, p.y, p.z - h})) / (2 * h)};
}

double turbulence_sum(const Point& p) {
    double sum = 0;
    for (int i = 0; i < 6; ++i) {
        const double f = std::pow(2, i);
        sum += std::fabs(noise({f * p.x, f * p.y, f * p.z})) / f;
    }
    return sum;
}

Point stirred(const Point& p, double amount) {
    return p + amount * Vector{turbulence_sum(p), turbulence_sum(p + Vector{31.416, 47.853, 12.793}),
                               turbulence_sum(p + Vector{-233.145, 113.408, 185.31})};
}

}  // namespace

TEST_CASE("solid has its defaults and what it is given") {
    const Matter plain = texture("solid")->evaluate({});
    CHECK(plain.colour == Colour::white());
    CHECK(plain.reflection == 0);
    CHECK(!plain.is_transparent());
    CHECK(plain.shininess == 10);
    CHECK(plain.relief == Vector{});
    CHECK(texture("solid")->is_uniform());

    const MaterialPtr glass = texture("solid", {number("colour", {0.2, 0.5, 0.9}), number("refraction", {1.5}),
                                                number("reflection", {0.25}), number("opacity", {0.1}), number("depth", {3})});
    const Matter matter = glass->evaluate({{1, 2, 3}, 0});
    CHECK(matter.colour == Colour{0.2, 0.5, 0.9});
    CHECK(matter.refraction == 1.5);
    CHECK(matter.reflection == 0.25);
    CHECK(matter.opacity == 0.1);
    CHECK(matter.depth == 3);
    CHECK(glass->may_be_transparent());
    CHECK(glass->may_reflect());
    CHECK_FALSE(glass->has_boundaries());
}

TEST_CASE("any leaf takes a relief of noise") {
    const MaterialPtr leaf = texture("solid", {number("bump", {0.5}), {"relief", {text_value("noise"), number_value(3)}}});
    CHECK(leaf->may_have_relief());
    CHECK_FALSE(leaf->is_uniform());
    std::mt19937_64 generator(1);
    for (int i = 0; i < 100; ++i) {
        const Point p = random_point(generator);
        const Vector slope = slope_of([](const Point& q) { return noise({3 * q.x, 3 * q.y, 3 * q.z}); }, p);
        CHECK(length(leaf->evaluate({p, 0}).relief - 0.5 * slope) < 1e-7);
    }
    CHECK_THROWS_WITH(texture("solid", {{"relief", {text_value("waves"), number_value(3)}}}),
                      Catch::Contains("the relief must be \"noise\""));
}

TEST_CASE("sine mixes two colours by its height, and has its slope as relief") {
    const MaterialPtr waves = texture("sine", {number("colour", {1, 0, 0}), number("colour", {0, 1, 0})});
    for (double x : {-7.0, -1.0, 0.0, 0.5, 2.0, 30.0}) {
        const Matter matter = waves->evaluate({{x, 5, -3}, 0});
        CHECK(matter.colour.r == Approx(1 - (1 + std::sin(x)) / 2));
        CHECK(matter.colour.g == Approx((1 + std::sin(x)) / 2));
        CHECK(matter.relief == Vector{std::cos(x), 0, 0});
    }
    CHECK(texture("sine")->evaluate({{-std::numbers::pi / 2, 0, 0}, 0}).colour == Colour::white());
    CHECK(texture("sine", {number("colour2", {0, 0, 1})})->evaluate({{std::numbers::pi / 2, 0, 0}, 0}).colour == Colour{0, 0, 1});
    CHECK_FALSE(texture("sine", {number("bump", {0})})->may_have_relief());
    CHECK_THROWS(texture("sine", {number("colour", {1, 0, 0}), number("colour", {0, 1, 0}), number("colour2", {0, 0, 1})}));
}

TEST_CASE("checkers alternate, far out, too") {
    const MaterialPtr checkers = texture("checkers", {}, {marked(0), marked(1)});
    std::mt19937_64 generator(2);
    for (double reach : {3.0, 1e5, 1e12})
        for (int i = 0; i < 1000; ++i) {
            const Point p = random_point(generator, reach);
            const auto sum = static_cast<long long>(std::floor(p.x)) + static_cast<long long>(std::floor(p.y)) +
                             static_cast<long long>(std::floor(p.z));
            REQUIRE(mark_at(*checkers, p) == static_cast<double>(sum & 1));
        }
}

TEST_CASE("rings alternate by the distance from a centre or an axis") {
    std::mt19937_64 generator(3);
    for (const std::string axis : {"none", "x", "y", "z"}) {
        const MaterialPtr rings = texture("rings", {word("axis", axis)}, {marked(0), marked(1)});
        for (int i = 0; i < 1000; ++i) {
            const Point p = random_point(generator);
            const double radius = axis == "x"   ? std::hypot(p.y, p.z)
                                  : axis == "y" ? std::hypot(p.x, p.z)
                                  : axis == "z" ? std::hypot(p.x, p.y)
                                                : std::hypot(p.x, p.y, p.z);
            REQUIRE(mark_at(*rings, p) == static_cast<double>(static_cast<int>(radius) & 1));
        }
    }
}

TEST_CASE("noise has one material below, one above and one in its band") {
    std::mt19937_64 generator(4);
    const MaterialPtr usual = texture("noise", {}, {marked(0), marked(1), marked(2)});
    const MaterialPtr wide = texture("noise", {number("band", {-0.3, 0.2})}, {marked(0), marked(1), marked(2)});
    for (int i = 0; i < 1000; ++i) {
        const Point p = random_point(generator);
        const double v = noise(p);
        REQUIRE(mark_at(*usual, p) == (v < -0.05 ? 0 : v > 0.05 ? 1 : 2));
        REQUIRE(mark_at(*wide, p) == (v < -0.3 ? 0 : v > 0.2 ? 1 : 2));
    }
    CHECK_THROWS(texture("noise", {number("band", {0.2, -0.3})}));
}

TEST_CASE("turbulence is its child at the stirred point, relief and all") {
    const MaterialPtr ramp = texture("gradient", {number("colour", {-1e6, 0, 0}), number("colour", {1e6, 0, 0})});
    const MaterialPtr waves = texture("sine");
    std::mt19937_64 generator(5);
    for (double amount : {1.0, -0.4}) {
        const MaterialPtr stirred_waves = texture("turbulence", {number("amount", {amount})}, {waves});
        for (int i = 0; i < 300; ++i) {
            const Point p = random_point(generator);
            const Matter matter = stirred_waves->evaluate({p, 0}), expected = waves->evaluate({stirred(p, amount), 0});
            REQUIRE(matter.colour.r == Approx(expected.colour.r).margin(1e-12));

            // Its corners, where an octave passes 0, have no slope to compare.
            const auto height = [&](const Point& q) { return std::sin(stirred(q, amount).x); };
            const Vector slope = slope_of(height, p, 1e-6), wider = slope_of(height, p, 3e-6);
            if (length(slope - wider) < 1e-5 * (1 + length(slope)))
                REQUIRE(length(matter.relief - slope) < 1e-4 * (1 + length(slope)));
        }
    }
}

TEST_CASE("octaves that cannot be seen move a point by less than a sixteenth of a pixel") {
    const MaterialPtr ramp = texture("gradient", {number("colour", {0, 0, 0}), number("colour", {1, 1, 1})});
    const MaterialPtr stirred_ramp = texture("turbulence", {number("octaves", {24})}, {ramp});
    std::mt19937_64 generator(6);
    for (double footprint : {1e-4, 1e-3, 1e-2, 0.1}) {
        bool any_left_out = false;
        for (int i = 0; i < 300; ++i) {
            const Point p = random_point(generator);
            const double exact = mark_at(*stirred_ramp, {p.x / 40, p.y, p.z});
            const double seen = stirred_ramp->evaluate({{p.x / 40, p.y, p.z}, footprint}).colour.r;
            REQUIRE(std::fabs(seen - exact) < footprint / 16);
            any_left_out = any_left_out || seen != exact;
        }
        CHECK(any_left_out);
    }
}

TEST_CASE("octaves that cannot be seen move the veins of marble by less than a sixteenth of a pixel") {
    // From black to white as (1 + cos(2 pi s)) / 2, which is nowhere steeper than pi.
    const MaterialPtr marble = texture(
        "marble", {number("octaves", {24}), number("sharpness", {1}), number("colour", {0, 0, 0}), number("vein", {1, 1, 1})});
    std::mt19937_64 generator(7);
    for (double footprint : {1e-4, 1e-3, 1e-2, 0.1}) {
        bool any_left_out = false;
        for (int i = 0; i < 300; ++i) {
            const Point p = random_point(generator);
            const double exact = marble->evaluate({p, 0}).colour.r, seen = marble->evaluate({p, footprint}).colour.r;
            REQUIRE(std::fabs(seen - exact) < std::numbers::pi * footprint / 16);
            any_left_out = any_left_out || seen != exact;
        }
        CHECK(any_left_out);
    }
}

TEST_CASE("mix blends every value, by a number or by a third material") {
    const MaterialPtr a = texture("solid", {number("colour", {1, 0, 0}), number("reflection", {0.2}), number("shininess", {10}),
                                            number("refraction", {1.2}), number("depth", {1})});
    const MaterialPtr b = texture("solid", {number("colour", {0, 0, 1}), number("reflection", {0.6}), number("shininess", {30}),
                                            number("refraction", {1.6}), number("depth", {5}), number("opacity", {1})});
    const Matter quarter = texture("mix", {number("amount", {0.25})}, {a, b})->evaluate({});
    CHECK(quarter.colour.r == Approx(0.75));
    CHECK(quarter.colour.b == Approx(0.25));
    CHECK(quarter.reflection == Approx(0.3));
    CHECK(quarter.shininess == Approx(15));
    CHECK(quarter.refraction == Approx(1.3));
    CHECK(quarter.depth == Approx(2));
    CHECK(quarter.opacity == Approx(0.25));

    const MaterialPtr ramp = texture("gradient");
    for (double x : {0.0, 0.1, 0.5, 0.9, 1.0})
        CHECK(texture("mix", {}, {a, b, ramp})->evaluate({{x, 0, 0}, 0}).colour.b == Approx(x));
    CHECK(texture("mix", {}, {a, b})->is_uniform());
    CHECK_FALSE(texture("mix", {}, {a, b, ramp})->is_uniform());
}

TEST_CASE("mix turns gradually from opaque to transparent") {
    const MaterialPtr glass = texture("solid", {number("refraction", {1.5}), number("depth", {4})});
    const MaterialPtr clay = texture("solid");
    const auto blend = [&](double amount) { return texture("mix", {number("amount", {amount})}, {glass, clay})->evaluate({}); };
    CHECK(blend(0).opacity == 0);
    CHECK(blend(0.3).refraction == Approx(1.5));
    CHECK(blend(0.3).opacity == Approx(0.3));
    CHECK(blend(0.3).depth == Approx(4));
    CHECK(!blend(1).is_transparent());
}

TEST_CASE("gradient runs from colour to colour and holds or mirrors its ends") {
    const std::vector<TextureProperty> colours{number("colour", {1, 0, 0}), number("colour", {0, 1, 0}),
                                               number("colour", {0, 0, 1})};
    const MaterialPtr held = texture("gradient", colours);
    const auto colour = [](const MaterialPtr& material, double x) { return material->evaluate({{x, 7, 7}, 0}).colour; };
    CHECK(colour(held, -3) == Colour{1, 0, 0});
    CHECK(colour(held, 0.25) == Colour{0.5, 0.5, 0});
    CHECK(colour(held, 0.5) == Colour{0, 1, 0});
    CHECK(colour(held, 0.75) == Colour{0, 0.5, 0.5});
    CHECK(colour(held, 9) == Colour{0, 0, 1});

    auto with_mirror = colours;
    with_mirror.push_back(word("extend", "mirror"));
    const MaterialPtr mirrored = texture("gradient", with_mirror);
    for (double x : {0.25, 0.5, 1.0})
        for (double same : {-x, 2 - x, 2 + x, 4 - x, -2 - x}) CHECK(colour(mirrored, same) == colour(mirrored, x));
}

TEST_CASE("layers deal the range of a pattern to their materials") {
    const std::vector<MaterialPtr> three{marked(0), marked(1), marked(2)};
    std::mt19937_64 generator(7);
    const MaterialPtr planes = texture("layers", {}, three);
    const MaterialPtr uneven = texture("layers", {number("edge", {0.1}), number("edge", {0.4})}, three);
    const MaterialPtr waves = texture("layers", {word("pattern", "waves")}, three);
    const MaterialPtr cloudy = texture("layers", {word("pattern", "noise")}, three);
    const MaterialPtr balls = texture("layers", {word("pattern", "spheres")}, three);
    const auto third = [](double v) { return v < 1.0 / 3 ? 0 : v < 2.0 / 3 ? 1 : 2; };
    for (int i = 0; i < 1000; ++i) {
        const Point p = random_point(generator);
        const double x = p.x - std::floor(p.x), radius = std::hypot(p.x, p.y, p.z);
        REQUIRE(mark_at(*planes, p) == third(x));
        REQUIRE(mark_at(*uneven, p) == (x < 0.1 ? 0 : x < 0.4 ? 1 : 2));
        REQUIRE(mark_at(*waves, p) == third((1 + std::sin(p.x)) / 2));
        REQUIRE(mark_at(*cloudy, p) == third((1 + noise(p)) / 2));
        REQUIRE(mark_at(*balls, p) == third(radius - std::floor(radius)));
    }
    CHECK_THROWS(texture("layers", {number("edge", {0.5})}, three));
    CHECK_THROWS(texture("layers", {number("edge", {0.5}), number("edge", {0.4})}, three));
}

TEST_CASE("bricks lie in running bond") {
    const MaterialPtr wall = texture("bricks", {number("size", {2, 1, 1}), number("joint", {0.1})}, {marked(0), marked(1)});
    CHECK(mark_at(*wall, {0.5, 0.5, 0.5}) == 0);
    CHECK(mark_at(*wall, {1.95, 0.5, 0.5}) == 1);  // the joint between two bricks of the first course
    CHECK(mark_at(*wall, {1.95, 1.5, 0.5}) == 0);  // is covered by the second
    CHECK(mark_at(*wall, {0.95, 1.5, 0.5}) == 1);
    CHECK(mark_at(*wall, {0.5, 0.95, 0.5}) == 1);
    CHECK(mark_at(*wall, {0.5, 0.5, -0.05}) == 1);
    CHECK(mark_at(*wall, {-0.05, -1.5, 0.5}) == 1);
    CHECK_THROWS(texture("bricks", {number("joint", {0.8})}));
}

TEST_CASE("every cell has one material, and all materials occur") {
    const MaterialPtr cells = texture("cells", {}, {marked(0), marked(1), marked(2)});
    std::mt19937_64 generator(8);
    int counts[3] = {};
    for (int i = 0; i < 3000; ++i) ++counts[static_cast<int>(mark_at(*cells, random_point(generator)))];
    for (int count : counts) CHECK(std::abs(count - 1000) < 200);

    // Without jitter, the cells are the unit cubes.
    const MaterialPtr cubes = texture("cells", {number("jitter", {0})}, {marked(0), marked(1)});
    for (int i = 0; i < 1000; ++i) {
        const Point p = random_point(generator);
        const Point middle{std::floor(p.x) + 0.5, std::floor(p.y) + 0.5, std::floor(p.z) + 0.5};
        REQUIRE(mark_at(*cubes, p) == mark_at(*cubes, middle));
    }
}

TEST_CASE("marble and wood are continuous and run between their colours") {
    std::mt19937_64 generator(9);
    for (const std::string keyword : {"marble", "wood"}) {
        const std::string second = keyword == "marble" ? "vein" : "late";
        const MaterialPtr material = texture(keyword, {number("colour", {1, 0, 0}), number(second, {0, 1, 0})});
        double least = 1, most = 0;
        for (int i = 0; i < 3000; ++i) {
            const Point p = random_point(generator);
            const Colour here = material->evaluate({p, 0}).colour;
            const Colour next = material->evaluate({p + Vector{1e-7, -1e-7, 1e-7}, 0}).colour;
            REQUIRE(here.r + here.g == Approx(1));
            REQUIRE(std::fabs(here.r - next.r) < 1e-4);
            least = std::min(least, here.r), most = std::max(most, here.r);
        }
        CHECK(least < 0.1);
        CHECK(most > 0.9);
        CHECK_FALSE(material->has_boundaries());
    }
}

TEST_CASE("no texture stumbles over places that are no places") {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const std::vector<MaterialPtr> children{marked(0), marked(1), marked(2)};
    for (const std::string& keyword : built_plugins().keywords(PluginKind::material)) {
        std::string reason;
        const Plugin* plugin = built_plugins().find(PluginKind::material, keyword, reason);
        REQUIRE(plugin);
        const std::size_t slots = plugin->schema().children().size();
        const MaterialPtr material =
            texture(keyword, {}, {children.begin(), children.begin() + static_cast<std::ptrdiff_t>(slots)});
        for (double c : {nan, infinity, -infinity, 1e300, -1e300, 0x1p53, -0x1p63}) {
            for (const Point& p : {Point{c, 0.5, 0.5}, Point{0.5, c, -c}, Point{c, c, c}}) {
                material->evaluate({p, 0});
                material->region(p);
                material->clearance(p);
                material->next_boundary({p, {1, 0.5, 0.25}}, 0, 10);
                material->next_boundary({{0.3, 0.4, 0.5}, {c, 1, c}}, 0, infinity);
            }
        }
        material->next_boundary({{0.3, 0.4, 0.5}, {0, 0, 0}}, 0, infinity);
        material->next_boundary({{0.3, 0.4, 0.5}, {1, 0, 0}}, 5, 5);
    }
}

}  // namespace lapidary
