// SPDX-License-Identifier: MIT
//
// Lights at their limits, T89 to T92: edges of thin cones, intensities and distances beyond what squares can hold, and the
// light of balls and discs against closed forms.

#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "kernel/interfaces/light.h"
#include "kernel/registry/registry.h"
#include "stress/exact.h"
#include "support/catch.h"
#include "support/measurement.h"

namespace lapidary::test {
namespace {

constexpr double pi = std::numbers::pi;

struct Setting {
    std::string property;
    std::vector<double> numbers;
};

std::unique_ptr<Light> make_light(const std::string& keyword, const std::vector<Setting>& settings) {
    static Registry registry({LAPIDARY_PLUGIN_FOLDER});
    std::string reason;
    const Plugin* plugin = registry.find(PluginKind::light, keyword, reason);
    REQUIRE(plugin);
    auto light = plugin->create_light();
    for (const Setting& setting : settings) {
        const PropertySchema* property = plugin->schema().find(setting.property);
        REQUIRE(property);
        std::vector<Value> values;
        for (double number : setting.numbers) values.push_back(number_value(number));
        property->assign(dynamic_cast<void*>(light.get()), values);
    }
    plugin->schema().derive(dynamic_cast<void*>(light.get()));
    return light;
}

double brightness(const Light& light, const Point& p) { return light.toward(p, {}).radiance.g; }

// The light that a surface with this normal gets, over a grid of samples.
double irradiance(const Light& light, const Point& p, const Vector& normal) {
    constexpr int n = 400;
    double sum = 0;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
            const Illumination lit = light.toward(p, {(i + 0.5) / n, (j + 0.5) / n});
            sum += lit.radiance.g * std::fmax(0, dot(lit.direction, normal));
        }
    return sum / (n * n);
}

}  // namespace

TEST_CASE("T89: the edge of a spot of any width") {
    Measurement edge({"T89", "edge of a spot", "", 0});
    for (int exponent = 1; exponent <= 11; ++exponent) {
        const double angle = std::pow(10, -exponent);
        CAPTURE(angle);
        const auto light = make_light("spot", {{"angles", {angle, angle}}, {"direction", {1, 2, -2}}});
        const Vector axis = normalize(Vector{1, 2, -2}), across = normalize(cross(axis, Vector{0.3, 0.5, 0.1}));
        for (double part : {0.5, 0.999, 1.001, 2.0}) {
            const Point p = to_point(std::cos(angle * part) * axis + std::sin(angle * part) * across);
            edge.expect((brightness(*light, p) > 0) == (part < 1));
        }
    }
}

TEST_CASE("T90: spots of 0, 90 and 180 degrees, and soft edges") {
    Measurement limits({"T90", "spots of 0, 90 and 180 degrees", "", 0}), inside({"T90", "brightness within a spot", "u", 8});
    const auto lit = [](double a, double b, double angle) {
        return brightness(*make_light("spot", {{"angles", {a, b}}}), {std::sin(angle), 0, std::cos(angle)});
    };
    limits.expect(lit(0, 0, 0) == 0);
    limits.expect(lit(0, 0, 1e-9) == 0);
    limits.expect(lit(pi / 2, pi / 2, 1.6) == 0);
    const auto record = [&](double a, double b, double angle, double expected) {
        inside.record(std::fabs(lit(a, b, angle) - expected) / u);
    };
    record(pi / 2, pi / 2, 1.5, 1), record(pi, pi, 3.1, 1), record(pi, pi, pi, 1), record(0, 1, 0, 1);
    for (double angle : {0.35, 0.4, 0.5}) {
        const double a = pi / 9, b = pi / 6, s = (std::cos(angle) - std::cos(b)) / (std::cos(a) - std::cos(b));
        record(a, b, angle, s * s * (3 - 2 * s));
    }
}

TEST_CASE("T91: intensities and distances of any size") {
    Measurement measured({"T91", "light of any intensity at any distance", "u, relative", 4});
    struct Case {
        double intensity, distance, expected;
    };
    for (const Case& c : {Case{1e300, 1e155, 1e-10}, Case{1e-300, 1e-160, 1e20}, Case{1, 2, 0.25}})
        measured.record((brightness(*make_light("point", {{"intensity", {c.intensity}}}), {c.distance, 0, 0}) / c.expected - 1) /
                        u);
    CHECK(std::isfinite(brightness(*make_light("point", {}), {1e-300, 0, 0})));
    CHECK(brightness(*make_light("point", {}), {0, 0, 0}) == 0);
}

TEST_CASE("T92: the light of balls and discs") {
    // A ball of radiance 1 and radius 1, two away: intensity pi r^2 = pi, irradiance pi/4.
    const auto ball = make_light("point", {{"radius", {1}}, {"intensity", {pi}}});
    CHECK(irradiance(*ball, {0, 0, 2}, {0, 0, -1}) == Approx(pi / 4).epsilon(1e-4));
    // As a point light far away, and at an angle at which it does not dip below the horizon.
    CHECK(irradiance(*ball, {0, 0, 20}, {0, 0.6, -0.8}) == Approx(pi / 400 * 0.8).epsilon(1e-4));
    // Within the ball its surface is all around: half of it above any horizon.
    CHECK(irradiance(*ball, {0.2, 0.1, 0}, {0, 1, 0}) == Approx(pi).epsilon(1e-3));

    // A disc in the sky gives a surface that faces it the light of the hard one.
    for (double angle : {0.01, 0.5, pi})
        CHECK(irradiance(*make_light("direct", {{"angle", {angle}}}), {3, 4, 5}, {0, 0, -1}) == Approx(1).epsilon(1e-4));
}

TEST_CASE("T92: the solid angle of a disc, exactly") {
    // A disc of radius 1 seen from 1 away fills 2 pi (1 - cos 45deg). So does the ball of radius 1 about a centre sqrt(2) away,
    // and a disc in the sky of 90 degrees. A light of radiance 1 has this light in all its samples together.
    constexpr double golden = 1.84030236902122;
    Random random(92);
    Measurement measured({"T92", "solid angle of a disc", "steradian", 1e-12});
    for (const double size : {1e-6, 1.0, 1e6}) {
        const auto ball = make_light("point", {{"radius", {size}}, {"intensity", {pi * size * size}}});
        const auto spot = make_light("spot", {{"radius", {size}}, {"intensity", {pi * size * size}}, {"angles", {pi, pi}}});
        for (int i = 0; i < 100; ++i) {
            const Point p = to_point(std::sqrt(2) * size * random.direction());
            const LightSample sample{random.uniform(0, 1), random.uniform(0, 1)};
            measured.record(measured.timed([&] { return ball->toward(p, sample); }).radiance.g - golden);
            measured.record(spot->toward(p, sample).radiance.g - golden);
        }
    }
    const auto sky = make_light("direct", {{"angle", {pi / 2}}, {"intensity", {pi / 2}}});  // pi sin^2 45deg on what faces it
    measured.record(sky->toward({3, 4, 5}, {0.3, 0.7}).radiance.g - golden);
}

TEST_CASE("T92: samples of a light fill its solid angle evenly, up to its edge") {
    // For equal solid angles, 1 - cos of the angle to the middle is uniform, and so is the angle around it.
    const auto ball = make_light("point", {{"radius", {1}}});
    const Point p{0, 0, -std::sqrt(2)};
    constexpr int count = 1 << 18, bins = 16;
    std::vector<int> rings(bins, 0), sectors(bins, 0);
    Random random(92);
    for (int i = 0; i < count; ++i) {
        const Vector d = ball->toward(p, {random.uniform(0, 1), random.uniform(0, 1)}).direction;
        const double part = (1 - d.z) / (1 - std::cos(pi / 4)), turn = std::atan2(d.y, d.x) / (2 * pi) + 0.5;
        REQUIRE(part < 1);
        ++rings[static_cast<std::size_t>(part * bins)];
        ++sectors[static_cast<std::size_t>(std::fmin(turn * bins, bins - 1))];
    }
    for (const std::vector<int>& counts : {rings, sectors})
        for (const int in_bin : counts) CHECK(in_bin == Approx(count / bins).epsilon(5 / std::sqrt(count / bins)));
}

TEST_CASE("samples of a ball lie on it, its middle straight ahead") {
    const auto light = make_light("point", {{"radius", {0.5}}, {"location", {1, 2, 3}}});
    Random random(92);
    for (int i = 0; i < 500; ++i) {
        const Point p = to_point(random.magnitude(-1, 3) * random.direction());
        const Illumination lit = light->toward(p, {random.uniform(0, 1), random.uniform(0, 1)});
        const Point end = p + lit.distance * lit.direction;
        CHECK(length(end - Point{1, 2, 3}) == Approx(0.5).epsilon(1e-5));
        const Illumination middle = light->toward(p, {});
        CHECK(length(cross(middle.direction, normalize(Point{1, 2, 3} - p))) <= 1e-12);
    }
}

}  // namespace lapidary::test
