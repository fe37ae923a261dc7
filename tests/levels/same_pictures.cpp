// SPDX-License-Identifier: MIT
//
// The libraries are built for several instruction sets, and the dynamic loader chooses. The same pictures come of each, bit for
// bit. A process that the C library shows less of the machine stands for machines that have less; the functions of that library
// (sine, power) are then those of such a machine, too.
#include <fmt/format.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "kernel/prepare/world.h"
#include "kernel/registry/search_path.h"
#include "kernel/render/render.h"
#include "support/catch.h"
#include "support/fingerprint.h"
#include "support/run.h"
#include "support/scenes.h"

namespace lapidary::test {
namespace {

namespace fs = std::filesystem;

struct Level {
    std::string name;
    std::string hidden;  // what of the machine the C library must not see, so that this level is the best there is
    bool machine_has = true;
};

// A machine without AVX2 has no fused multiply-add either.
Level level_of(const std::string& name) {
    __builtin_cpu_init();
    const bool has_v3 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi2");
    const bool has_v4 = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
                        __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512dq") &&
                        __builtin_cpu_supports("avx512vl");
    if (name == "x86-64") return {name, "-AVX2,-FMA"};
    if (name == "x86-64-v3") return {name, "-AVX512F", has_v3};
    if (name == "x86-64-v4") return {name, "", has_v4};
    return {name, ""};
}

std::vector<Level> built_levels() {
    std::vector<Level> levels;
    std::istringstream names(LAPIDARY_LEVELS);
    for (std::string name; names >> name;) levels.push_back(level_of(name));
    return levels;
}

// What this program prints of a test on a machine of that level.
std::string output_at(const Level& level, const std::string& test) {
    const RunResult result = run(fmt::format("GLIBC_TUNABLES=glibc.cpu.hwcaps={} {} '{}'", level.hidden,
                                             quoted(fs::read_symlink("/proc/self/exe")), test));
    CHECK(result.exit_code == 0);
    return result.output;
}

std::uint64_t fingerprint_of_picture(const fs::path& file, int threads) {
    const auto built = build_file(file);
    for (const std::string& headline : built->headlines()) UNSCOPED_INFO(headline);
    REQUIRE(built->scene);
    const auto world = prepare_world(*built->scene, built->messages);
    Frame frame(48, 36, {Layer::depth, Layer::normal, Layer::position, Layer::object, Layer::samples});
    RenderOptions options;
    options.threads = threads;
    options.error = 0.05;
    CHECK(render(*world, *built->scene, frame, options).complete);
    Fingerprint fingerprint;
    for (const Layer layer : {Layer::colour, Layer::depth, Layer::normal, Layer::position, Layer::object, Layer::samples})
        for (const float value : frame.layer(layer)) fingerprint.add(value);
    return fingerprint.value();
}

// Run by the tests below, in processes of their own.
TEST_CASE("tell the instruction set", "[.told]") { fmt::print("level {}\n", kernel_level()); }

TEST_CASE("tell the bits of pictures", "[.told]") {
    // Objects of all forms, textures, relief, mirrors, glass, absorption, a lens, soft light.
    for (const char* name : {"dice", "csg", "matDemo", "extremeMaterialTest", "gallery/wood", "gallery/marble",
                             "gallery/turbulence", "gallery/sine", "light/studio"}) {
        const fs::path scene = fs::path(LAPIDARY_SOURCE_FOLDER) / "scenes" / fmt::format("{}.scene", name);
        const std::uint64_t bits = fingerprint_of_picture(scene, 1);
        CHECK(fingerprint_of_picture(scene, 2) == bits);
        fmt::print("{} {:016x}\n", name, bits);
    }
}

TEST_CASE("each level is taken where it is the best that the machine has, and all render the same bits") {
    const std::vector<Level> levels = built_levels();
    if (levels.size() < 2) WARN("only one instruction set is built: " LAPIDARY_LEVELS);
    std::string expected;
    for (const Level& level : levels) {
        if (!level.machine_has) {
            WARN("this machine lacks " << level.name << ", which therefore is not tried");
            continue;
        }
        CAPTURE(level.name);
        if (levels.size() > 1)
            CHECK(output_at(level, "tell the instruction set").find(fmt::format("level {}\n", level.name)) != std::string::npos);
        const std::string bits = output_at(level, "tell the bits of pictures");
        CHECK(bits.find("studio") != std::string::npos);
        if (expected.empty()) expected = bits;
        CHECK(bits == expected);
    }
}

}  // namespace
}  // namespace lapidary::test
