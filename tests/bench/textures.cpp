// SPDX-License-Identifier: MIT
//
// What textures cost: nanoseconds per evaluation of each, on random points, alone and in batches, and microseconds per boundary
// along lines. A plain program that prints a table; the best of several runs counts.

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <random>

#include "lapidary/noise.h"
#include "lapidary/turbulence.h"
#include "support/textures.h"

namespace lapidary {

using namespace test;

namespace {

template <class Work>
double nanoseconds(int count, const Work& work) {
    double best = infinity;
    for (int run = 0; run < 7; ++run) {
        const auto start = std::chrono::steady_clock::now();
        work();
        const std::chrono::duration<double, std::nano> time = std::chrono::steady_clock::now() - start;
        best = std::min(best, time.count() / count);
    }
    return best;
}

std::vector<Point> random_points(int count) {
    std::mt19937_64 generator(1);
    std::uniform_real_distribution<double> coordinate(-100, 100);
    std::vector<Point> points;
    for (int i = 0; i < count; ++i) points.push_back({coordinate(generator), coordinate(generator), coordinate(generator)});
    return points;
}

// Keeps the compiler from leaving out what is measured.
volatile double sink;

void measure(const char* name, const std::vector<Point>& points, double (*function)(const Point&)) {
    const double time = nanoseconds(static_cast<int>(points.size()), [&] {
        double sum = 0;
        for (const Point& p : points) sum += function(p);
        sink = sum;
    });
    std::printf("%-28s %8.1f ns\n", name, time);
}

void measure(const char* name, const std::vector<Point>& points, const MaterialPtr& material) {
    const int count = static_cast<int>(points.size());
    const double evaluation = nanoseconds(count, [&] {
        double sum = 0;
        for (const Point& p : points) sum += material->evaluate({p, 0}).colour.r;
        sink = sum;
    });
    const double in_batches = nanoseconds(count, [&] {
        double sum = 0;
        for (int i = 0; i + batch_size <= count; i += batch_size) {
            SiteBatch sites{};
            for (int lane = 0; lane < batch_size; ++lane) sites.points.set(lane, points[i + lane]);
            MatterBatch matter;
            material->evaluate_batch(sites, (1u << batch_size) - 1, matter);
            sum += matter.r[0];
        }
        sink = sum;
    });
    std::printf("%-28s %8.1f ns %8.1f ns in batches", name, evaluation, in_batches);
    if (material->has_boundaries()) {
        const int lines = 200;
        const double boundary = nanoseconds(lines, [&] {
            double sum = 0;
            for (int i = 0; i < lines; ++i) {
                const Vector direction = normalize(points[2 * i + 1] - points[2 * i]);
                sum += material->next_boundary({points[2 * i], direction}, 0, 100).t;
            }
            sink = sum;
        });
        std::printf(" %10.2f us a boundary", boundary / 1000);
    }
    std::printf("\n");
}

}  // namespace
}  // namespace lapidary

int main() {
    using namespace lapidary;
    const std::vector<Point> points = random_points(4000);
    measure("noise", points, [](const Point& p) { return noise(p); });
    measure("noise and gradient", points, [](const Point& p) { return noise_with_gradient(p).gradient.x; });
    measure("turbulence, 6 octaves", points, [](const Point& p) { return turbulence(p, 6); });

    const std::vector<MaterialPtr> three{marked(0), marked(0.5), marked(1)}, two{three[0], three[1]};
    const MaterialPtr ramp = texture("gradient"), checkers = texture("checkers", {}, two);
    measure("solid", points, three[0]);
    measure("sine", points, texture("sine"));
    measure("gradient", points, ramp);
    measure("marble", points, texture("marble"));
    measure("wood", points, texture("wood"));
    measure("checkers", points, checkers);
    measure("rings", points, texture("rings", {}, two));
    measure("noise", points, texture("noise", {}, three));
    measure("bricks", points, texture("bricks", {}, two));
    measure("cells", points, texture("cells", {}, three));
    measure("layers of planes", points, texture("layers", {}, three));
    measure("layers of noise", points, texture("layers", {word("pattern", "noise")}, three));
    measure("mix by a number", points, texture("mix", {}, two));
    measure("mix by a gradient", points, texture("mix", {}, {two[0], two[1], ramp}));
    measure("turbulence of a solid", points, texture("turbulence", {}, {three[0]}));
    measure("turbulence of checkers", points, texture("turbulence", {}, {checkers}));
}
