// SPDX-License-Identifier: MIT
//
// What a run opens: the plugins that its scene names and nothing else. The dynamic loader itself is asked.
#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <set>
#include <string>

#include "support/catch.h"
#include "support/run.h"
#include "support/temporary_folder.h"

namespace lapidary {
namespace {

namespace fs = std::filesystem;

// The libraries that a render of the scene loads, by the part of their path behind lib/lapidary/ for our own, by file
// name for others.
std::set<std::string> libraries_opened(const TemporaryFolder& folder, const std::string& scene,
                                       const std::string& options = "--resolution 16x12 -o picture.bmp") {
    const fs::path file = folder.write("opened.scene", scene);
    const RunResult rendered =
        run(fmt::format("cd {0} && HOME={0} XDG_CONFIG_HOME={0}/config LD_DEBUG=files LD_DEBUG_OUTPUT={0}/loader {1} "
                        "{2} {3}",
                        quoted(folder.path()), quoted(LAPIDARY_PROGRAM), options, quoted(file)));
    INFO(rendered.output);
    CHECK(rendered.exit_code == 0);

    std::set<std::string> libraries;
    for (const auto& entry : fs::directory_iterator(folder.path())) {
        if (!entry.path().filename().string().starts_with("loader")) continue;
        std::ifstream log(entry.path());
        for (std::string line; std::getline(log, line);) {
            const std::size_t begin = line.find("calling init: ");
            if (begin == std::string::npos) continue;
            const std::string path = fs::path(line.substr(begin + 14)).lexically_normal().string();
            const std::size_t ours = path.find("lib/lapidary/");
            libraries.insert(ours == std::string::npos ? fs::path(path).filename().string() : path.substr(ours + 13));
        }
    }
    return libraries;
}

// Whatever instruction set they are for.
std::set<std::string> plugins_of(const std::set<std::string>& libraries) {
    std::set<std::string> plugins;
    for (const fs::path library : libraries)
        if (library.string().starts_with("plugins/"))
            plugins.insert((library.parent_path().filename() / library.filename()).string());
    return plugins;
}

// The module, not the library of YAML: OpenImageIO brings that one along for its own use.
constexpr const char* yaml_module = "modules/yaml_configuration.so";
// The one through which picture files are written; OpenImageIO comes with it.
constexpr const char* image_module = "modules/image.so";

TEST_CASE("only what the scene names is opened") {
    const TemporaryFolder folder;
    const auto libraries = libraries_opened(folder, "lights { point { location(0,3,-3); } } objects { sphere { } }");
    CHECK(plugins_of(libraries) == std::set<std::string>{"lights/point.so", "objects/sphere.so", "outputs/bmp.so"});
    CHECK_FALSE(libraries.contains(yaml_module));
}

TEST_CASE("what writes picture files is opened to write one, and not where a scene is only read") {
    const TemporaryFolder folder, another;
    const std::string scene = "lights { ambient { } } objects { sphere { } }";
    CHECK(libraries_opened(folder, scene).contains(image_module));
    const auto only_read = libraries_opened(another, scene, "-d");
    CHECK_FALSE(only_read.empty());
    for (const std::string& library : only_read)
        if (library == image_module || library.starts_with("libOpenImageIO")) FAIL_CHECK(library);
}

TEST_CASE("a verbose run tells how many plugins were opened and how many were passed over") {
    const TemporaryFolder folder;
    const fs::path file = folder.write("told.scene", "lights { ambient { } } objects { sphere { } }");
    const RunResult told = run(
        fmt::format("cd {} && {} -w -v --resolution 16x12 {}", quoted(folder.path()), quoted(LAPIDARY_PROGRAM), quoted(file)));
    INFO(told.output);
    std::size_t all = 0;
    for (const char* kind : {"objects", "materials", "lights", "outputs"})
        for (const auto& entry : fs::directory_iterator(fs::path(LAPIDARY_PLUGIN_FOLDER) / kind))
            all += entry.path().extension() == ".so";
    CHECK(told.output.find(fmt::format("3 plugins opened, {} passed over\n", all - 3)) != std::string::npos);
}

TEST_CASE("a verbose run tells which modules were opened and which were passed over") {
    const TemporaryFolder folder, configured;
    const std::string scene = "lights { ambient { } } objects { sphere { } }";
    folder.write("told.scene", scene);
    configured.write("told.scene", scene);
    configured.write("lapidary.yaml", "threads: 1\n");
    const auto told = [](const TemporaryFolder& where, const std::string& options) {
        return run(fmt::format("cd {0} && HOME={0} XDG_CONFIG_HOME={0}/config {1} -w -v --resolution 16x12 {2} told.scene",
                               quoted(where.path()), quoted(LAPIDARY_PROGRAM), options))
            .output;
    };
    CHECK_THAT(told(folder, "-d"), Catch::Contains("modules opened: none; passed over: image, yaml_configuration\n"));
    CHECK_THAT(told(folder, ""), Catch::Contains("modules opened: image; passed over: yaml_configuration\n"));
    CHECK_THAT(told(configured, "-d"), Catch::Contains("modules opened: yaml_configuration; passed over: image\n"));
    CHECK_THAT(told(configured, ""), Catch::Contains("modules opened: image, yaml_configuration; passed over: none\n"));
}

TEST_CASE("a verbose run tells how many octaves were too fine to be seen") {
    const TemporaryFolder folder;
    const auto told = [&](const std::string& turbulence) {
        const fs::path file =
            folder.write("told.scene",
                         "camera { location(0,0,-4); look_at(0,0,0); rays(1); } lights { ambient { } } objects { cube { "
                         "size(9,9,0.1); material { turbulence { " +
                             turbulence + " checkers { solid { } solid { colour(0,0,0); } } } } } }");
        return run(fmt::format("cd {} && {} -w -v --resolution 16x12 {}", quoted(folder.path()), quoted(LAPIDARY_PROGRAM),
                               quoted(file)))
            .output;
    };
    CHECK_THAT(told("octaves(1);"), Catch::Contains("\n0 octaves too fine"));
    // A pixel is about a third wide, so that octaves from the ninth on move nothing by a sixteenth of it.
    const std::string many = told("octaves(20);");
    CHECK_THAT(many, Catch::Matches("[^]*\\n[1-9][0-9]* octaves too fine to be seen\\n[^]*"));
}

TEST_CASE("textures are opened when they are named") {
    const TemporaryFolder folder;
    const auto libraries = libraries_opened(
        folder, "lights { ambient { } } objects { cube { material { checkers { solid { } solid { colour(0,0,0); } } } } }");
    CHECK(plugins_of(libraries) == std::set<std::string>{"lights/ambient.so", "materials/checkers.so", "materials/solid.so",
                                                         "objects/cube.so", "outputs/bmp.so"});
}

TEST_CASE("the module that reads YAML is opened for a configuration") {
    const TemporaryFolder folder;
    folder.write("lapidary.yaml", "threads: 1\n");
    CHECK(libraries_opened(folder, "lights { ambient { } } objects { sphere { } }").contains(yaml_module));
}

}  // namespace
}  // namespace lapidary
