// SPDX-License-Identifier: MIT
//
// What the recognition of coincident faces costs: scenes rendered with it and without it, in turn, on one thread.
//
//     tests/bench/workloads.py dice dice.scene
//     tests/bench/workloads.py spheres-10000 spheres.scene
//     lapidary_bench_coincidence dice.scene spheres.scene
//
// Of each pair of neighbouring renders the ratio is taken, and of the ratios the median, so that a machine that others use as
// well is slow for both. A scene of tiles that all touch one another, in which every face is shared, is added.
#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include "kernel/prepare/world.h"
#include "kernel/registry/registry.h"
#include "kernel/render/render.h"
#include "kernel/scene/build.h"
#include "loaders/scene/load.h"

namespace lapidary {
namespace {

constexpr int pairs = 9, width = 320, height = 240, samples = 4;

// A wall of cubes without gaps, less a ball, on a floor that it stands on.
const std::string touching_tiles = R"(
    camera { location(0, 2, -14); look_at(0, 0, 0); angle(60deg); }
    lights { ambient { } point { location(-6, 8, -9); intensity(100); } }
    objects {
        subtraction {
            union { repeat i (-6, 6) { repeat j (0, 6) { cube {
                colour(0.5 + 0.07*i, 0.5, 0.1*j); transform { scale(0.5); translate(i, j - 2.5, 0); } } } } }
            sphere { radius(1.5); transform { translate(0, 0, -0.5); } }
        }
        halfspace { transform { translate(0, -3, 0); } }
    })";

double median(std::vector<double> values) {
    std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
    return values[values.size() / 2];
}

double seconds_of(const World& world, const Scene& scene) {
    Frame frame(width, height, {});
    RenderOptions options;
    options.threads = 1;
    options.samples = samples;
    return render(world, scene, frame, options).processor_seconds;
}

void measure(const std::string& name, const Document& document, Registry& registry, Messages& messages) {
    const auto scene = build_scene(document, registry, name, messages);
    if (!scene) {
        std::fprintf(stderr, "%s", messages.all().front().format().c_str());
        return;
    }
    const auto with = prepare_world(*scene, messages);
    const auto without = prepare_world(*scene, messages, {.coincidence = false});
    std::vector<double> ratios, quickest_with, quickest_without;
    for (int pair = 0; pair < pairs; ++pair) {
        quickest_with.push_back(seconds_of(*with, *scene));
        quickest_without.push_back(seconds_of(*without, *scene));
        ratios.push_back(quickest_with.back() / quickest_without.back());
    }
    std::printf("%-24s %8zu %8zu %10.1f %10.1f %8.3f\n", name.c_str(), with->leaves.size(), with->surface_classes.size(),
                1e3 * *std::min_element(quickest_without.begin(), quickest_without.end()),
                1e3 * *std::min_element(quickest_with.begin(), quickest_with.end()), median(ratios));
    std::fflush(stdout);
}

}  // namespace
}  // namespace lapidary

int main(int count, char** arguments) {
    using namespace lapidary;
    Registry registry({LAPIDARY_PLUGIN_FOLDER});
    std::printf("%-24s %8s %8s %10s %10s %8s\n", "scene", "leaves", "shared", "without ms", "with ms", "ratio");
    for (int i = 1; i < count; ++i) {
        Messages messages;
        const std::filesystem::path file(arguments[i]);
        measure(file.stem().string(), load_scene_file(file, {}, messages), registry, messages);
    }
    Messages messages;
    measure("touching tiles", load_scene_text("tiles", touching_tiles, {}, messages), registry, messages);
}
