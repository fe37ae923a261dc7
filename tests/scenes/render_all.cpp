// SPDX-License-Identifier: MIT
//
// Every scene of the project renders, without a message, and gives the same picture, bit for bit, for any number of threads and
// for regions put together.
#include <algorithm>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "kernel/prepare/world.h"
#include "kernel/registry/registry.h"
#include "kernel/render/render.h"
#include "kernel/scene/build.h"
#include "kernel/scene/print.h"
#include "loaders/scene/load.h"
#include "support/catch.h"

namespace lapidary {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> scenes_in(const fs::path& folder) {
    std::vector<fs::path> scenes;
    for (const auto& entry : fs::recursive_directory_iterator(fs::path(LAPIDARY_SOURCE_FOLDER) / folder))
        if (entry.path().extension() == ".scene") scenes.push_back(entry.path());
    std::sort(scenes.begin(), scenes.end());
    return scenes;
}

// A scene file, ready to render small.
struct ReadyScene {
    std::unique_ptr<Registry> registry = std::make_unique<Registry>(std::vector<fs::path>{LAPIDARY_PLUGIN_FOLDER});
    Messages messages;
    Scene scene;
    std::shared_ptr<const World> world;
};

std::unique_ptr<ReadyScene> make_ready(const fs::path& file, int width, int height) {
    auto ready = std::make_unique<ReadyScene>();
    const Document document = load_scene_file(file, {}, ready->messages);
    const auto scene = build_scene(document, *ready->registry, file.stem(), ready->messages);
    if (!scene) return ready;
    ready->scene = *scene;
    ready->scene.output.width = width;
    ready->scene.output.height = height;
    ready->world = prepare_world(ready->scene, ready->messages);
    return ready;
}

// The same from what the log holds of it.
std::unique_ptr<ReadyScene> make_ready_again(const ReadyScene& other) {
    auto ready = std::make_unique<ReadyScene>();
    const Document document = load_scene_text("log", print_scene(other.scene), {}, ready->messages);
    const auto scene = build_scene(document, *ready->registry, other.scene.title, ready->messages);
    if (!scene) return ready;
    ready->scene = *scene;
    ready->world = prepare_world(ready->scene, ready->messages);
    return ready;
}

std::string first_message(const Messages& messages) {
    const auto all = messages.all();
    return all.empty() ? "" : all.front().format();
}

std::unique_ptr<const Frame> rendered(const ReadyScene& ready, const RenderOptions& options) {
    auto frame = std::make_unique<Frame>(ready.scene.output.width, ready.scene.output.height,
                                         LayerSet{Layer::depth, Layer::normal, Layer::object});
    const RenderReport report = render(*ready.world, ready.scene, *frame, options);
    CHECK(report.complete);
    CHECK(report.trace.non_finite_samples == 0);
    return frame;
}

constexpr Layer compared_layers[] = {Layer::colour, Layer::depth, Layer::normal, Layer::object};

bool same_bits(const Frame& a, const Frame& b) {
    return std::all_of(std::begin(compared_layers), std::end(compared_layers), [&](Layer layer) {
        const auto p = a.layer(layer), q = b.layer(layer);
        return p.size() == q.size() && std::memcmp(p.data(), q.data(), p.size_bytes()) == 0;
    });
}

TEST_CASE("every scene renders without a message") {
    const std::vector<fs::path> scenes = scenes_in("scenes");
    REQUIRE(scenes.size() >= 4);
    for (const fs::path& file : scenes) {
        INFO(file);
        const auto ready = make_ready(file, 48, 36);
        CHECK(first_message(ready->messages) == "");
        REQUIRE(ready->world);
        const auto frame = rendered(*ready, {});
        // Something is to be seen: not all pixels are alike.
        const auto colour = frame->layer(Layer::colour);
        const auto [least, greatest] = std::minmax_element(colour.begin(), colour.end());
        CHECK(*greatest - *least > 0.1f);
    }
}

TEST_CASE("the benchmark's scenes build without a message") {
    for (const fs::path& file : scenes_in("tests/bench")) {
        INFO(file);
        const auto ready = make_ready(file, 16, 12);
        CHECK(first_message(ready->messages) == "");
        CHECK(ready->world);
    }
}

TEST_CASE("every scene as it stands in the log renders to the same picture") {
    RenderOptions options;
    options.samples = 2;
    for (const char* folder : {"scenes", "tests/bench"})
        for (const fs::path& file : scenes_in(folder)) {
            INFO(file);
            const auto ready = make_ready(file, 32, 24);
            REQUIRE(ready->world);
            const auto again = make_ready_again(*ready);
            CHECK(first_message(again->messages) == "");
            REQUIRE(again->world);
            CHECK(same_bits(*rendered(*ready, options), *rendered(*again, options)));
        }
}

TEST_CASE("pictures of shown scenes do not depend on the number of threads") {
    for (const char* name : {"dice.scene", "csg.scene", "trees.scene"}) {
        INFO(name);
        const auto ready = make_ready(fs::path(LAPIDARY_SOURCE_FOLDER) / "scenes" / name, 100, 75);
        REQUIRE(ready->world);
        RenderOptions options;
        options.threads = 1;
        const auto one = rendered(*ready, options);
        for (const int threads : {2, 7}) {
            options.threads = threads;
            CHECK(same_bits(*one, *rendered(*ready, options)));
        }
    }
}

TEST_CASE("regions of shown scenes put together are their pictures") {
    for (const char* name : {"dice.scene", "csg.scene"}) {
        INFO(name);
        const auto ready = make_ready(fs::path(LAPIDARY_SOURCE_FOLDER) / "scenes" / name, 100, 75);
        REQUIRE(ready->world);
        const auto whole = rendered(*ready, {});
        Frame pieces(100, 75, {Layer::depth, Layer::normal, Layer::object});
        // Cuts that agree with no size of a tile, down to single pixels.
        for (const PixelRegion& region :
             {PixelRegion{0, 0, 37, 75}, {37, 0, 38, 1}, {37, 1, 38, 75}, {38, 0, 100, 29}, {38, 29, 100, 75}}) {
            RenderOptions options;
            options.region = region;
            options.threads = 2;
            CHECK(render(*ready->world, ready->scene, pieces, options).complete);
        }
        CHECK(same_bits(*whole, pieces));
    }
}

}  // namespace
}  // namespace lapidary
