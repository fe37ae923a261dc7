// SPDX-License-Identifier: MIT
//
// Paths of light through solids of clear matter, against closed forms (numerics 5.2 and 5.3, T62 to T69).

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "support/catch.h"
#include "support/traced_scene.h"

using namespace lapidary;
using namespace lapidary::test;

namespace {

constexpr double degree = std::numbers::pi / 180;
constexpr double u = 0x1p-53;

std::string objects(const std::string& content, const std::string& settings = "") {
    return "background(1,1,1); " + settings + " objects { " + content + " }";
}

// A slab of clear matter between two heights.
std::string slab(double index, double low, double high) {
    return "cube { size(200,0.5,200); transform { scale(1," + std::to_string(high - low) + ",1); translate(0," +
           std::to_string((low + high) / 2) + ",0); } " + glass(index) + "} ";
}

std::string ball(double radius, double index, const std::string& more = "") {
    return "sphere { radius(" + std::to_string(radius) + "); " + glass(index) + more + "} ";
}

Vector falling_at(double angle) { return {std::sin(angle), -std::cos(angle), 0}; }

double angle_of(const Vector& v) { return std::atan2(v.y, v.x); }

// How far the last stretch of a path, lengthened backwards, runs beside the first.
double shift_beside(const PathEvent& first, const PathEvent& last) {
    const Vector way = last.point.rounded() - first.point.rounded();
    return length(way - dot(way, first.direction) * first.direction);
}

}  // namespace

TEST_CASE("T63 A slab shifts a ray and leaves its direction") {
    TracedScene scene(objects(slab(1.5, -0.5, 0.5) + wall));
    const auto path = scene.trace({-1, 1.5, 0}, falling_at(45 * degree)).main_path();
    REQUIRE(path.size() == 3);
    CHECK(std::fabs(shift_beside(path[0], path[1]) - 0.3291423081773203) <= 8 * u);

    std::mt19937 random(1);
    std::uniform_real_distribution<double> uniform(0, 1);
    for (int i = 0; i < 200; ++i) {
        const double angle = 89 * degree * uniform(random), turn = 2 * std::numbers::pi * uniform(random);
        const Vector direction =
            normalize(Vector{std::sin(angle) * std::cos(turn), -std::cos(angle), std::sin(angle) * std::sin(turn)});
        const auto random_path = scene.trace(Point{0, 0.6, 0}, direction).main_path();
        REQUIRE(random_path.size() == 3);
        CHECK(length(random_path[2].direction - direction) <= 8 * u / std::cos(angle));
        const double inner = std::asin(std::sin(angle) / 1.5);
        CHECK(shift_beside(random_path[0], random_path[1]) ==
              Approx(std::sin(angle - inner) / std::cos(inner)).epsilon(1e-13).margin(1e-15));
    }
}

TEST_CASE("T63 Ten slabs one upon the other shift a ray as their sum") {
    const std::array<double, 10> indices{1.5, 1.333, 1.7, 1.5, 2.42, 1.31, 1.2, 1.9, 1.6, 1.1};
    std::string all;
    for (std::size_t i = 0; i < indices.size(); ++i)
        all += slab(indices[i], -static_cast<double>(i) - 1, -static_cast<double>(i));
    TracedScene scene(objects(all + wall, "render { depth(20); cutoff(0.2); }"));
    for (const double degrees : {0.0, 10.0, 30.0, 45.0}) {
        CAPTURE(degrees);
        const Vector direction = normalize(falling_at(degrees * degree));
        const auto path = scene.trace({-1, 1, 0}, direction).main_path();
        REQUIRE(path.size() == 12);  // eleven faces and the wall: one face between neighbours
        double x = path[0].point.rounded().x;
        for (std::size_t i = 0; i < indices.size(); ++i) {
            CHECK(path[i].index_behind == indices[i]);
            CHECK(path[i + 1].index_before == indices[i]);
            x += std::tan(std::asin(std::sin(degrees * degree) / indices[i]));
            CHECK(path[i + 1].point.rounded().x == Approx(x).epsilon(1e-14).margin(4e-15));
        }
        CHECK(length(path.back().direction - direction) <= 32 * u);
    }
}

TEST_CASE("T64 Glass upon water has one face between, and the shift of both") {
    TracedScene scene(objects(slab(1.5, -1, 0) + slab(1.333, -2, -1) + wall));
    const auto path = scene.trace({-1, 1, 0}, falling_at(45 * degree)).main_path();
    REQUIRE(path.size() == 4);
    CHECK(std::fabs(path[2].point.rounded().x - path[0].point.rounded().x - 1.16028339261426789) <= 1e-14);
}

TEST_CASE("A prism deviates least where light passes it symmetrically") {
    const auto [index, deviation] = GENERATE(table<double, double>({{1.5, 37.1807557814583}, {1.333, 23.5950089016136}}));
    CAPTURE(index);
    TracedScene prism(objects("intersection { " + glass(index) +
                              " halfspace { transform { rotz(60deg); } } halfspace { transform { rotz(-60deg); } }"
                              " halfspace { transform { rotz(180deg); translate(0,-1,0); } } cube { size(5,5,5); } } " +
                              wall));
    const double half = deviation / 2 * degree;
    const Point entry{-0.5 * std::tan(30 * degree), -0.5, 0};
    const auto deviation_at = [&](double angle) {
        const Vector direction{std::cos(angle), std::sin(angle), 0};
        const auto path = prism.trace(entry - 2 * direction, direction).main_path();
        REQUIRE(path.size() == 3);
        return (angle - angle_of(path[2].direction)) / degree;
    };
    CHECK(std::fabs(deviation_at(half) - deviation) <= 1e-13 * 180);
    CHECK(deviation_at(half + 0.01) > deviation);
    CHECK(deviation_at(half - 0.01) > deviation);
}

TEST_CASE("T65 A ball deviates a ray and brings it to its axis") {
    const auto [index, b, deviation, chord, axis] = GENERATE(
        table<double, double, double, double, double>({{1.5, 0.5, 21.0575587310186, 1.88561808316413, 1.39157294888931},
                                                       {1.5, 0.9, 54.5763391819777, 1.6, 1.10444556836926},
                                                       {1.333, 0.7, 25.4998448647859, 1.70204246222364, 1.62598357827603}}));
    CAPTURE(index, b);
    TracedScene scene(objects(ball(1, index) + wall));
    const auto path = scene.trace({-3, b, 0}, {1, 0, 0}).main_path();
    REQUIRE(path.size() == 3);
    const Point out = path[1].point.rounded();
    const Vector direction = path[2].direction;
    CHECK(-angle_of(direction) / degree == Approx(deviation).epsilon(2e-14));
    CHECK(length(out - path[0].point.rounded()) == Approx(chord).epsilon(1e-14));
    CHECK(out.x - out.y * direction.x / direction.y == Approx(axis).epsilon(2e-14));
}

TEST_CASE("T66 Nested balls deviate as n r sin = const demands, total reflection included") {
    struct Row {
        double outer, inner, impact, deviation;
    };
    const Row row = GENERATE(values<Row>({{1.5, 1.333, 0.3, 5.495837404045726},
                                          {1.5, 1, 0.3, -14.74215015347117},
                                          {1.333, 1.5, 0.3, 15.24828359870799},
                                          {1.5, 1.2, 0.45, -4.868798836408411},
                                          {1.5, 1.333, 0.7, -8.861210130330925}}));
    CAPTURE(row.outer, row.inner, row.impact);
    const bool is_total = row.impact == 0.7;
    const auto deviation_in = [&](const std::string& matter) {
        TracedScene scene(objects(matter + wall));
        const TracedRay ray = scene.trace({-3, row.impact, 0}, {1, 0, 0});
        const auto path = ray.main_path();
        REQUIRE(path.size() == (is_total ? 4 : 5));
        CHECK(path[1].index_before == row.outer);
        CHECK(path[1].index_behind == row.inner);
        if (is_total) CHECK_FALSE(ray.has_branch(7));
        return -angle_of(path.back().direction) / degree;
    };
    CHECK(deviation_in(ball(1, row.outer) + ball(0.5, row.inner, "priority(1);")) == Approx(row.deviation).epsilon(1e-13));
    CHECK(deviation_in(ball(0.5, row.inner) + ball(1, row.outer)) == Approx(row.deviation).epsilon(1e-13));
    const std::string hollow = "subtraction { " + ball(1, row.outer) + "} with { sphere { radius(0.5); } } ";
    CHECK(deviation_in(hollow + ball(0.5, row.inner)) == Approx(row.deviation).epsilon(1e-13));
    if (row.inner == 1) CHECK(deviation_in(hollow) == Approx(row.deviation).epsilon(1e-13));
}

TEST_CASE("T62 Faces between equal indices neither bend, mirror nor cost a ray") {
    // All within glass: the camera, balls of the same glass that overlap, and what is seen behind them.
    TracedScene scene(objects(ball(40, 1.5) + ball(2, 1.5, "priority(1);") +
                              "sphere { radius(2); transform { translate(1,1,0); } priority(2);" + glass(1.5) + "} " +
                              "cube { size(20,20,1); transform { translate(0,0,10); } priority(3); } "));
    std::mt19937 random(3);
    std::uniform_real_distribution<double> uniform(-1, 1);
    std::size_t faces = 0;
    for (int i = 0; i < 200; ++i) {
        const Vector direction = normalize(Vector{0.2 * uniform(random), 0.2 * uniform(random), 1});
        const TracedRay ray = scene.trace({0, 0, -9}, direction);
        for (const PathEvent& event : ray.events) {
            CHECK(event.direction == ray.events.front().direction);
            CHECK(event.branch == 1);
        }
        faces += ray.events.size();
    }
    CHECK(faces > 600);
    CHECK(scene.statistics().mirrored_rays == 0);
    CHECK(scene.statistics().refracted_rays == 0);
}

TEST_CASE("T67 Where balls overlap the higher priority decides, then the order of writing") {
    struct Media {
        int priority_a, priority_b;
        bool a_first;
    };
    const Media media =
        GENERATE(values<Media>({{0, 0, true}, {0, 0, false}, {1, 0, true}, {1, 0, false}, {0, 1, true}, {0, 1, false}}));
    CAPTURE(media.priority_a, media.priority_b, media.a_first);
    const auto placed = [](double x, double index, int priority) {
        return "sphere { transform { translate(" + std::to_string(x) + ",0,0); } priority(" + std::to_string(priority) + "); " +
               glass(index) + "} ";
    };
    const std::string form = GENERATE(as<std::string>{}, "", "union { ", "merge { ");
    const auto both = [&](double apart) {
        const std::string a = placed(-apart, 1.5, media.priority_a), b = placed(apart, 1.3, media.priority_b);
        return form + (media.a_first ? a + b : b + a) + (form.empty() ? "" : "} ");
    };
    const bool a_wins = media.priority_a != media.priority_b ? media.priority_a > media.priority_b : media.a_first;
    const auto indices_along_axis = [](const std::string& matter) {
        TracedScene scene(objects(matter + wall));
        std::vector<double> indices;
        for (const PathEvent& event : scene.trace({-3, 0, 0}, {1, 0, 0}).main_path()) indices.push_back(event.index_before);
        return indices;
    };
    if (form != "merge { ") {
        CHECK(indices_along_axis(both(0.5)) == std::vector<double>{1, 1.5, 1.3, 1});
        CHECK(indices_along_axis(both(0)) == std::vector<double>{1, a_wins ? 1.5 : 1.3, 1});
    }
    // Which medium the lens between them is of shows in where the face lies.
    TracedScene scene(objects(both(0.5) + wall));
    const auto path = scene.trace({-3, 0, 0}, {1, 0, 0}).main_path();
    if (form != "merge { ") {
        REQUIRE(path.size() == 4);
        CHECK(path[1].point.rounded().x == Approx(a_wins ? 0.5 : -0.5));
    }
}

TEST_CASE("T68 Of eight media in one place the highest priority is what is there") {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> uniform(-1, 1);
    std::array<int, 8> priorities{};
    std::iota(priorities.begin(), priorities.end(), 0);
    for (int shuffle = 0; shuffle < 6; ++shuffle) {
        std::shuffle(priorities.begin(), priorities.end(), random);
        struct Medium {
            Point centre;
            double index;
            int priority;
        };
        std::vector<Medium> media;
        std::string matter;
        for (std::size_t i = 0; i < 8; ++i) {
            media.push_back({{0.3 * uniform(random), 0.3 * uniform(random), 0.3 * uniform(random)},
                             1.1 + 0.05 * static_cast<double>(i),
                             priorities[i]});
            const Medium& m = media.back();
            matter += fmt::format(
                "sphere {{ radius(1); transform {{ translate({},{},{}); }} priority({}); material {{ solid {{ refraction({}); }} "
                "}} }} ",
                m.centre.x, m.centre.y, m.centre.z, m.priority, m.index);
        }
        const auto index_at = [&](const Point& p) {
            const Medium* top = nullptr;
            for (const Medium& m : media)
                if (length(p - m.centre) < 1 && (!top || m.priority > top->priority)) top = &m;
            return top ? top->index : 1;
        };
        TracedScene scene(objects(matter + wall, "render { cutoff(0.1); depth(40); }"));
        for (int i = 0; i < 40; ++i) {
            const Point origin{3 * uniform(random), 3 * uniform(random), -4};
            const Point aim{0.5 * uniform(random), 0.5 * uniform(random), 0};
            for (const PathEvent& event : scene.trace(origin, aim - origin).events) {
                const Point p = event.point.rounded();
                if (length(p - Point{}) > 10) continue;  // the wall
                const Vector off = 1e-7 * to_vector(event.normal);
                CHECK(event.index_before == index_at(p + off));
                CHECK(event.index_behind == index_at(p - off));
            }
        }
    }
}

TEST_CASE("T69 Coloured matter absorbs by the length of the way") {
    const std::string rose = fmt::format("material {{ solid {{ refraction(1); colour({:.17g}, 0.5, 1); }} }} ", std::exp(-0.5));
    TracedScene scene(objects("sphere { " + rose + " }"));
    const Colour seen = scene.colour({-3, 0.6, 0}, {1, 0, 0});
    CHECK(std::fabs(seen.r - 0.4493289641172216) <= 1e-15);
    CHECK(std::fabs(seen.g - std::pow(0.5, 1.6)) <= 1e-15);
    CHECK(seen.b == 1);
    CHECK(scene.statistics().refracted_rays == 0);
}

TEST_CASE("A coloured slab mirrors and lets through what the sum over all paths demands") {
    const double n = GENERATE(1.333, 1.5, 2.42);
    const std::string matter = "cube { size(99,0.5,99); " +
                               fmt::format("material {{ solid {{ refraction({}); colour(0.7,0.4,1); depth(2); }} }}", n) + " } ";
    TracedScene lit_from_both(objects(matter, "render { depth(60); cutoff(0); }"));
    const double r = std::pow((n - 1) / (n + 1), 2);
    const Colour seen = lit_from_both.colour({0, 3, 0}, {0, -1, 0});
    const auto both = [&](double colour) {
        const double a = std::pow(colour, 0.5), through = (1 - r) * (1 - r) * a / (1 - r * r * a * a);
        return through + r + (1 - r) * (1 - r) * a * a * r / (1 - r * r * a * a);
    };
    CHECK(largest_difference(seen, {both(0.7), both(0.4), 1}) <= 4e-15);

    // Black above, and below a face that shines by ambient light: what is seen has come through.
    TracedScene lit_from_behind("lights { ambient { intensity(1); } } render { depth(60); cutoff(0); } objects { " + matter +
                                "halfspace { transform { translate(0,-2,0); } material { solid { colour(1,1,1); } } } }");
    const auto through = [&](double colour) {
        const double a = std::pow(colour, 0.5);
        return (1 - r) * (1 - r) * a / (1 - r * r * a * a);
    };
    CHECK(largest_difference(lit_from_behind.colour({0, 3, 0}, {0, -1, 0}), {through(0.7), through(0.4), through(1)}) <= 4e-15);
}

TEST_CASE("Textured absorption is the product over the pieces of the way") {
    TracedScene checkers(
        objects("cube { size(2,2,2); material { checkers { solid { refraction(1); colour(0.5,1,0.9); }"
                " solid { refraction(1); colour(1,0.25,0.8); } } } }"));
    const Colour along = checkers.colour({-5, 0.5, 0.5}, {1, 0, 0});
    CHECK(largest_difference(along, {std::pow(0.5, 2), std::pow(0.25, 2), std::pow(0.9 * 0.8, 2)}) <= 1e-14);
    // Along a diagonal x and y change in turn.
    const Colour diagonal = checkers.colour({-5, -5.25, 0.5}, {1, 1, 0});
    // x from -1.75 to 2 with y = x - 0.25: odd from x = -1, 0 and 1 on for a quarter each.
    const double odd = std::numbers::sqrt2 * 0.75, even = std::numbers::sqrt2 * 3.0;
    CHECK(largest_difference(diagonal, {std::pow(0.5, even), std::pow(0.25, odd), std::pow(0.9, even) * std::pow(0.8, odd)}) <=
          1e-13);

    // Over periods of a sine the mean of log(a + b sin x) is log((a + sqrt(a^2 - b^2)) / 2).
    TracedScene sine(
        objects(fmt::format("cube {{ size({:.17g},1,1); material {{ sine {{ refraction(1); colour(0.9,0.5,1); "
                            "colour2(0.3,0.5,0.8); bump(0); }} }} }}",
                            2 * std::numbers::pi)));
    const auto over_two_periods = [](double first, double second) {
        const double a = 0.5 * (first + second), b = 0.5 * (second - first);
        return std::pow(0.5 * (a + std::sqrt(a * a - b * b)), 4 * std::numbers::pi);
    };
    CHECK(largest_difference(sine.colour({-9, 0, 0}, {1, 0, 0}), {over_two_periods(0.9, 0.3), std::pow(0.5, 4 * std::numbers::pi),
                                                                  over_two_periods(1, 0.8)}) <= 1e-12);
}
