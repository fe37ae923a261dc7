// SPDX-License-Identifier: MIT
//
// What objects cost: nanoseconds per line of each, asked one by one and in batches, on random lines through their default
// instance. A plain program that prints a table; the best of several runs counts.

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <random>
#include <vector>

#include "kernel/interfaces/object.h"
#include "kernel/registry/registry.h"

namespace lapidary {
namespace {

template <class Work>
double nanoseconds(int count, const Work& work) {
    double best = infinity;
    for (int run = 0; run < 9; ++run) {
        const auto start = std::chrono::steady_clock::now();
        work();
        const std::chrono::duration<double, std::nano> time = std::chrono::steady_clock::now() - start;
        best = std::min(best, time.count() / count);
    }
    return best;
}

// Lines through random points of the cube |x|, |y|, |z| <= 1.2, about their points closest to the origin.
std::vector<LineBatch> random_lines(int batches) {
    std::mt19937_64 generator(1);
    std::uniform_real_distribution<double> coordinate(-1.2, 1.2);
    std::vector<LineBatch> lines(static_cast<std::size_t>(batches));
    for (LineBatch& batch : lines)
        for (int lane = 0; lane < batch_size; ++lane) {
            const Vector d = normalize(Vector{coordinate(generator), coordinate(generator), coordinate(generator)});
            const Vector p{coordinate(generator), coordinate(generator), coordinate(generator)};
            const Vector closest = p - dot(p, d) * d;
            batch.closest_x[lane] = closest.x, batch.direction_x[lane] = d.x;
            batch.closest_y[lane] = closest.y, batch.direction_y[lane] = d.y;
            batch.closest_z[lane] = closest.z, batch.direction_z[lane] = d.z;
        }
    return lines;
}

void measure(const Plugin& plugin, const std::vector<LineBatch>& lines) {
    const auto object = plugin.create_object();
    const auto ranks = static_cast<std::size_t>(object->max_spans());
    const int count = batch_size * static_cast<int>(lines.size());
    std::vector<Span> spans(ranks);
    std::vector<SpanBatch> batch(ranks);
    int hits = 0;
    const double one_by_one = nanoseconds(count, [&] {
        hits = 0;
        for (const LineBatch& b : lines)
            for (int lane = 0; lane < batch_size; ++lane) hits += object->spans(b.line(lane), spans.data()) > 0;
    });
    const double batched = nanoseconds(count, [&] {
        for (const LineBatch& b : lines) object->spans_batch(b, batch_size, batch.data());
    });
    std::printf("%-12s %10.1f %10.1f %9.0f %%\n", plugin.keyword().c_str(), one_by_one, batched, 100.0 * hits / count);
}

}  // namespace
}  // namespace lapidary

int main() {
    using namespace lapidary;
    Registry registry({LAPIDARY_PLUGIN_FOLDER});
    const auto lines = random_lines(1024);
    std::printf("%-12s %10s %10s %11s\n", "object", "ns/line", "in batches", "hits");
    for (const std::string& keyword : registry.keywords(PluginKind::object)) {
        std::string reason;
        if (const Plugin* plugin = registry.find(PluginKind::object, keyword, reason))
            measure(*plugin, lines);
        else
            std::fprintf(stderr, "%s\n", reason.c_str());
    }
}
