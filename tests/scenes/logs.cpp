// SPDX-License-Identifier: MIT
//
// The log of a render is itself a scene: rendered, it gives the same picture, to the last bit of every layer.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <tuple>

#include "lapidary/image_library.h"
#include "support/catch.h"
#include "support/run.h"
#include "support/temporary_folder.h"

namespace lapidary {
namespace {

namespace fs = std::filesystem;

const fs::path scenes = fs::path(LAPIDARY_SOURCE_FOLDER) / "scenes";

// The program in a folder of its own, without the user's configuration.
RunResult lapidary(const TemporaryFolder& folder, const std::string& words) {
    return run(fmt::format("cd {0} && HOME={0} XDG_CONFIG_HOME={0} DISPLAY= WAYLAND_DISPLAY= {1} {2}", quoted(folder.path()),
                           quoted(LAPIDARY_PROGRAM), words));
}

// Whether two pictures of many layers (OpenEXR) are the same.
bool same(const fs::path& a, const fs::path& b) {
    const Picture one = load_image_library()->decode(a), other = load_image_library()->decode(b);
    const auto place = [](const Picture& p) { return std::tuple(p.width, p.height, p.x, p.y, p.full_width, p.full_height); };
    const auto by_name = [](const Picture::Channel& p, const Picture::Channel& q) { return p.name == q.name; };
    if (place(one) != place(other) || !std::ranges::equal(one.channels, other.channels, by_name)) return false;
    // A depth of infinity equals itself; nothing here is no number.
    return one.samples == other.samples;
}

void check_log(const std::string& scene, const std::string& options, const std::string& options_again) {
    INFO(scene << " " << options);
    const TemporaryFolder folder;
    const RunResult first = lapidary(folder, fmt::format("-l -o first.exr {} {}", options, quoted(scenes / scene)));
    INFO(first.output);
    REQUIRE(first.exit_code == 0);
    fs::rename(folder.path() / "first.log", folder.path() / "again.scene");
    const RunResult again = lapidary(folder, options_again + " again.scene");  // the format stands in the log
    INFO(again.output);
    REQUIRE(again.exit_code == 0);
    CHECK(same(folder.path() / "first.exr", folder.path() / "again.exr"));
}

TEST_CASE("the logs of the project's scenes give the same pictures") {
    // Of the others, what stands in the log is compared where all scenes are rendered.
    for (const char* scene : {"extremeMaterialTest.scene", "gallery/wood.scene"})
        check_log(scene, "--resolution 32x24 --samples 2", "");
}

TEST_CASE("the log keeps what the options asked for") {
    check_log("matDemo.scene", "--resolution 24x18 --error 0.05", "");
    check_log("dice.scene", "--resolution 24x18 --samples 3 --set camera.location=1,4,-9", "");
}

// A scene is of a whole picture: the log tells of the region in its comment, and who gives the option again has the same.
TEST_CASE("the log of a region tells of it, and gives the same with the option") {
    check_log("dice.scene", "--resolution 64x48 --samples 2 --region 10,8,40,30", "--region 10,8,40,30");
    const TemporaryFolder folder;
    REQUIRE(lapidary(folder, fmt::format("-l -o part.png --resolution 32x24 --samples 1 --region 4,4,20,20 {}",
                                         quoted(scenes / "first.scene")))
                .exit_code == 0);
    std::ifstream stream(folder.path() / "part.log");
    const std::string log{std::istreambuf_iterator<char>(stream), {}};
    CHECK(log.find("//   only the region 4,4,20,20\n") != std::string::npos);
}

}  // namespace
}  // namespace lapidary
