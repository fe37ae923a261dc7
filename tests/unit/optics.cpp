// SPDX-License-Identifier: MIT
//
// Reflection and refraction at one face, against tabulated values (numerics 5.2) and the law itself.
#include "kernel/render/optics.h"

#include <cmath>
#include <numbers>

#include "support/catch.h"

using namespace lapidary;

namespace {

constexpr double degree = std::numbers::pi / 180;
const Normal up{0, 1, 0};

Vector falling_at(double angle) { return {std::sin(angle), -std::cos(angle), 0}; }

}  // namespace

TEST_CASE("Fresnel reflectance has the tabulated values") {
    struct Row {
        double before, behind, degrees, reflectance;
    };
    const Row row = GENERATE(values<Row>({
        {1, 1.5, 0, 0.04},
        {1, 1.5, 30, 0.0415226259758215},
        {1, 1.5, 45, 0.0502399110122359},
        {1, 1.5, 60, 0.0891867128022128},
        {1, 1.5, 75, 0.25306056299032},
        {1, 1.5, 85, 0.612799645264827},
        {1, 1.5, 89, 0.904184949780189},
        {1, 1.333, 0, 0.0203731878419714},
        {1, 1.333, 45, 0.0278983645983761},
        {1, 1.333, 60, 0.0596909191751527},
        {1, 1.333, 80, 0.347916706959683},
        {1, 2.42, 0, 0.172394924934168},
        {1, 2.42, 45, 0.1815210591841},
        {1, 2.42, 80, 0.43332761124545},
        {1.5, 1, 10, 0.0400829591550701},
        {1.5, 1, 30, 0.0551901672953759},
        {1.333, 1.5, 0, 0.00347487985443108},
        {1.333, 1.5, 45, 0.00571633080167459},
        {1.333, 1.5, 80, 0.223468145412415},
        {2.42, 1, 10, 0.173064156433315},
    }));
    CAPTURE(row.before, row.behind, row.degrees);
    const double reflectance = fresnel_reflectance(falling_at(row.degrees * degree), up, row.before, row.behind);
    // The table has 12 to 15 digits; a normal incidence of 1e-17 is one of 0.
    CHECK(std::fabs(reflectance - row.reflectance) <= 2e-13 * row.reflectance + 1e-15);
}

TEST_CASE("Nothing is reflected at Brewster's angle but the perpendicular half") {
    CHECK(fresnel_reflectance(falling_at(56.30993247402021 * degree), up, 1, 1.5) == Approx(0.0739644970414201).epsilon(1e-13));
    CHECK(fresnel_reflectance(falling_at(53.12322576039242 * degree), up, 1, 1.333) == Approx(0.0391355019711486).epsilon(1e-12));
    CHECK(fresnel_reflectance(falling_at(67.54845354399613 * degree), up, 1, 2.42) == Approx(0.250845672264205).epsilon(1e-13));
}

TEST_CASE("Almost everything is reflected at grazing incidence") {
    const double passed = 1 - fresnel_reflectance(falling_at(89.999999 * degree), up, 1, 1.5);
    CHECK(passed == Approx(1.01469540205455e-7).epsilon(1e-7));
}

TEST_CASE("Reflection is total beyond the critical angle, and tends to 1 below it") {
    const double critical = std::asin(1 / 1.5);
    CHECK(critical / degree == Approx(41.8103148957786).epsilon(1e-14));
    for (int k = 1; k <= 10; ++k) {
        const double off = std::pow(10, -k);
        CAPTURE(k);
        CHECK(fresnel_reflectance(falling_at(critical + off), up, 1.5, 1) == 1);
        CHECK(refract(falling_at(critical + off), up, 1.5).is_total);
        CHECK_FALSE(refract(falling_at(critical - off), up, 1.5).is_total);
        // To first order 1 - R = 2 (n + 1/n) cos(refracted) / cos(critical), with cos^2(refracted) = 2 n cos(critical) off.
        const double passed = 1 - fresnel_reflectance(falling_at(critical - off), up, 1.5, 1);
        const double expected = 2 * (1.5 + 1 / 1.5) * std::sqrt(3 * off / std::cos(critical));
        CHECK(std::fabs(passed / expected - 1) <= 6 * std::sqrt(off) + 1e-5);
    }
}

TEST_CASE("Refraction obeys Snell's law and stays in the plane of incidence") {
    for (double eta : {1 / 1.5, 1 / 1.333, 1.333 / 1.5, 1.5 / 1.333, 1.2})
        for (double angle = 0.01; angle < 0.6; angle += 0.0371) {
            const auto refracted = refract(falling_at(angle), up, eta);
            REQUIRE_FALSE(refracted.is_total);
            CHECK(std::fabs(refracted.direction.x - eta * std::sin(angle)) <= 4e-16);
            CHECK(refracted.direction.z == 0);
            CHECK(std::fabs(length(refracted.direction) - 1) <= 4e-16);
            CHECK(refracted.direction.y < 0);
        }
}

TEST_CASE("Equal indices neither bend nor mirror") {
    CHECK(fresnel_reflectance(falling_at(1.2), up, 1.5, 1.5) == 0);
    CHECK(fresnel_reflectance(falling_at(1.5707), up, 1.0, 1.0) == 0);
}

TEST_CASE("The hemispherical mean of the reflectance is the tabulated one") {
    // 2 integral of R cos(theta) d cos(theta), by the midpoint rule in cos^2.
    for (const auto& [index, mean] :
         {std::pair{1.333, 0.066405764783079}, std::pair{1.5, 0.091777959342351}, std::pair{2.42, 0.21254079473884}}) {
        constexpr int steps = 200000;
        double sum = 0;
        for (int i = 0; i < steps; ++i) {
            const double squared_cosine = (i + 0.5) / steps;
            sum += fresnel_reflectance(falling_at(std::acos(std::sqrt(squared_cosine))), up, 1, index);
        }
        CHECK(sum / steps == Approx(mean).epsilon(1e-6));
    }
}

TEST_CASE("A mirrored direction keeps its length and its part along the face") {
    for (double angle = 0; angle < 1.57; angle += 0.1) {
        const Vector mirrored = mirror(falling_at(angle), up);
        CHECK(std::fabs(mirrored.x - std::sin(angle)) <= 3e-16);
        CHECK(std::fabs(mirrored.y - std::cos(angle)) <= 3e-16);
    }
}
