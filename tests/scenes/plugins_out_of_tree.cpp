// SPDX-License-Identifier: MIT
//
// The SDK's example, built as a stranger builds it: against an installation that has been moved, in a folder of its own.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <string>

#include "support/catch.h"
#include "support/installation.h"
#include "support/picture.h"
#include "support/run.h"
#include "support/temporary_folder.h"

namespace lapidary {
namespace {

namespace fs = std::filesystem;

constexpr const char* scene_of_octahedron =
    "camera { location(0,0,-6); rays(1); screen { location(0,0,-3); size(4,3); } }\n"
    "lights { direct { direction(1,-1,2); } }\n"
    "objects { octahedron { radius(1.5); transform { roty(30deg); } } }\n";

// The same from the scene language alone: what four slabs have in common.
constexpr const char* scene_of_slabs =
    "camera { location(0,0,-6); rays(1); screen { location(0,0,-3); size(4,3); } }\n"
    "lights { direct { direction(1,-1,2); } }\n"
    "let half = 1.5 / sqrt(3);\n"
    "let tilt = atan(sqrt(2));\n"
    "objects { intersection {\n"
    "  plane { thickness(2 * half); transform { rotz(tilt); roty(45deg); } }\n"
    "  plane { thickness(2 * half); transform { rotz(tilt); roty(135deg); } }\n"
    "  plane { thickness(2 * half); transform { rotz(tilt); roty(225deg); } }\n"
    "  plane { thickness(2 * half); transform { rotz(tilt); roty(315deg); } }\n"
    "  transform { roty(30deg); } } }\n";

TEST_CASE("a plugin is built outside of the tree against an installation that was moved") {
    const Installation installation;
    const TemporaryFolder folder;
    fs::copy(installation.prefix() / "share/lapidary/example", folder.path() / "example", fs::copy_options::recursive);
    const RunResult built = installation.build(folder.path() / "example", folder.path() / "build", "all");
    INFO(built.output);
    REQUIRE(built.exit_code == 0);
    const fs::path plugins = folder.path() / "build/lib/lapidary/plugins";
    REQUIRE(fs::exists(plugins / "objects/octahedron.so"));

    const auto picture_of = [&](const char* text, const char* name, const std::string& environment, const std::string& options) {
        const fs::path scene = folder.write(std::string(name) + ".scene", text);
        const fs::path picture = folder.path() / (std::string(name) + ".bmp");
        const RunResult rendered = run(fmt::format("{} {} {} --resolution 120x90 -o {} {}", environment, installation.program(),
                                                   options, quoted(picture), quoted(scene)));
        INFO(rendered.output);
        CHECK(rendered.exit_code == 0);
        return read_bmp_pixels(picture);
    };
    const auto expected = picture_of(scene_of_slabs, "slabs", "", "");
    REQUIRE(expected.size() == 120 * 90 * 3);
    CHECK(std::ranges::count(expected, 0) < 120 * 90 * 3 - 1000);  // it is to be seen

    {
        INFO("found by --plugin-path");
        const auto found = picture_of(scene_of_octahedron, "option", "", "--plugin-path " + quoted(plugins));
        CHECK(count_differences(found, expected) <= 10);
    }
    {
        INFO("found on a machine that has less");
        const auto found = picture_of(scene_of_octahedron, "less", "GLIBC_TUNABLES=glibc.cpu.hwcaps=-AVX2,-FMA",
                                      "--plugin-path " + quoted(plugins));
        CHECK(count_differences(found, expected) <= 10);
    }
    {
        INFO("found by LAPIDARY_PLUGIN_PATH");
        const auto found = picture_of(scene_of_octahedron, "variable", "LAPIDARY_PLUGIN_PATH=" + quoted(plugins), "");
        CHECK(count_differences(found, expected) <= 10);
    }
    {
        INFO("found by the scene, relative to its own file");
        const std::string scene = std::string("plugins \"build/lib/lapidary/plugins\";\n") + scene_of_octahedron;
        const auto found = picture_of(scene.c_str(), "scene", "", "");
        CHECK(count_differences(found, expected) <= 10);
    }
    {
        INFO("found by the user's configuration");
        folder.write("config/lapidary/config.yaml", "plugin_path: ../../build/lib/lapidary/plugins\n");
        const auto found =
            picture_of(scene_of_octahedron, "configuration", "XDG_CONFIG_HOME=" + quoted(folder.path() / "config"), "");
        CHECK(count_differences(found, expected) <= 10);
    }
    {
        INFO("found by the project's configuration");
        folder.write("lapidary.yaml", "plugin_path: build/lib/lapidary/plugins\n");
        const auto found = picture_of(scene_of_octahedron, "project", "cd " + quoted(folder.path()) + " &&", "");
        CHECK(count_differences(found, expected) <= 10);
    }
    {
        INFO("otherwise not found, and the message says where was searched");
        const fs::path scene = folder.write("lost.scene", scene_of_octahedron);
        const RunResult lost = run(installation.program() + " check " + quoted(scene));
        CHECK(lost.exit_code != 0);
        CHECK(lost.output.find("'octahedron'") != std::string::npos);
        CHECK(lost.output.find((installation.prefix() / "lib/lapidary/plugins").string()) != std::string::npos);
    }
}

}  // namespace
}  // namespace lapidary
