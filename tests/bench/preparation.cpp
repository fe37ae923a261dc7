// SPDX-License-Identifier: MIT
//
// What it costs until the first ray: processor time of reading, building and preparing a scene, and the memory that the World
// takes. A plain program that prints the best of several runs.
//
//     tests/bench/workloads scaling 100000 > balls.scene; lapidary_bench_preparation balls.scene

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <memory>
#include <vector>

#include "kernel/prepare/world.h"
#include "kernel/registry/registry.h"
#include "kernel/scene/build.h"
#include "loaders/scene/load.h"

namespace lapidary {
namespace {

double processor_seconds() {
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

template <class Work>
auto measure(double& least, const Work& work) {
    const double start = processor_seconds();
    auto result = work();
    least = std::min(least, processor_seconds() - start);
    return result;
}

template <class T>
double bytes_of(const std::vector<T>& list) {
    return static_cast<double>(list.size() * sizeof(T));
}

void print_memory(const World& world) {
    const double solids = static_cast<double>(std::max<std::size_t>(1, world.solids.size()));
    const struct {
        const char* what;
        double bytes;
    } parts[] = {{"leaves", bytes_of(world.leaves)},
                 {"nodes", bytes_of(world.nodes) + bytes_of(world.children)},
                 {"solids", bytes_of(world.solids) + bytes_of(world.clips)},
                 {"surfaces", bytes_of(world.faces) + bytes_of(world.surface_uses) + bytes_of(world.surface_classes)},
                 {"materials", bytes_of(world.materials)},
                 {"hierarchy", bytes_of(world.hierarchy.nodes())}};
    double sum = 0;
    for (const auto& [what, bytes] : parts) {
        std::printf("%-10s %8.1f bytes a solid\n", what, bytes / solids);
        sum += bytes;
    }
    std::printf("%-10s %8.1f bytes a solid\n", "all", sum / solids);
}

bool measure(const char* file) {
    constexpr int runs = 7;
    double read = infinity, built = infinity, prepared = infinity;
    std::shared_ptr<const World> world;
    for (int run = 0; run < runs; ++run) {
        world.reset();
        Messages messages;
        Registry registry({LAPIDARY_PLUGIN_FOLDER});
        const Document document = measure(read, [&] { return load_scene_file(file, {}, messages); });
        const auto scene = measure(built, [&] { return build_scene(document, registry, "scene", messages); });
        if (!scene) return false;
        world = measure(prepared, [&] { return prepare_world(*scene, messages); });
    }
    std::printf("%zu solids, %zu leaves\n", world->solids.size(), world->leaves.size());
    std::printf("read %8.1f ms   build %8.1f ms   prepare %8.1f ms\n", 1e3 * read, 1e3 * built, 1e3 * prepared);
    print_memory(*world);
    return true;
}

}  // namespace
}  // namespace lapidary

int main(int argc, char** argv) {
    if (argc != 2) {
        std::fprintf(stderr, "usage: lapidary_bench_preparation SCENE\n");
        return 2;
    }
    if (lapidary::measure(argv[1])) return 0;
    std::fprintf(stderr, "%s has errors: ask 'lapidary check'\n", argv[1]);
    return 1;
}
