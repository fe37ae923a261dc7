// SPDX-License-Identifier: MIT
//
// A new primitive is one new file: an ellipsoid is put beside the others in a copy of the plugins' folder, built with
// nothing else edited, and used like any other keyword.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>

#include "support/catch.h"
#include "support/installation.h"
#include "support/picture.h"
#include "support/run.h"
#include "support/temporary_folder.h"

namespace lapidary {
namespace {

namespace fs = std::filesystem;

constexpr const char* ellipsoid = R"(// ellipsoid: a ball with three radii.
//
// Dividing each coordinate by its radius makes it the unit ball, which the line crosses at the same t.

#include <lapidary/plugin.h>

namespace lapidary {

class Ellipsoid final : public ConvexObject<Ellipsoid> {
public:
    static void describe(Schema<Ellipsoid>& schema) {
        schema.summary("A ball with three radii.");
        schema.add("radii", &Ellipsoid::radii_).unit(Unit::length).above(0).help("Along the three axes.");
    }

    Bounds bounds() const override { return Bounds::box(radii_.x, radii_.y, radii_.z); }

    Span span(const LocalLine& line) const {
        const Vector m{line.closest.x / radii_.x, line.closest.y / radii_.y, line.closest.z / radii_.z};
        const Vector d{line.direction.x / radii_.x, line.direction.y / radii_.y, line.direction.z / radii_.z};
        const double middle = -dot(m, d) / dot(d, d);
        const Span unit = ball_span({to_point(m + middle * d), d}, 1);
        return {unit.in + middle, unit.out + middle};
    }

    Normal normal(const Hit& hit) const override {
        return {hit.local.x / (radii_.x * radii_.x), hit.local.y / (radii_.y * radii_.y), hit.local.z / (radii_.z * radii_.z)};
    }

private:
    Vector radii_{1, 1, 1};
};

LAPIDARY_PLUGIN(Ellipsoid)

}  // namespace lapidary
)";

std::string scene_of(const std::string& object) {
    return "camera { location(0,0,-6); rays(1); screen { location(0,0,-3); size(4,3); } }\n"
           "lights { direct { direction(1,-1,2); } }\n"
           "objects { " +
           object + " }\n";
}

TEST_CASE("a new primitive is one new file") {
    const Installation installation;
    const TemporaryFolder tree;
    for (const char* folder : {"plugins", "sdk"})
        fs::copy(fs::path(LAPIDARY_SOURCE_FOLDER) / folder, tree.path() / folder, fs::copy_options::recursive);
    // Stands for the rest of the tree, which is taken as installed: building the kernel again would take minutes.
    tree.write("CMakeLists.txt",
               "cmake_minimum_required(VERSION 3.25)\n"
               "project(copy LANGUAGES CXX)\n"
               "find_package(lapidary REQUIRED)\n"
               "add_library(lapidary::flags INTERFACE IMPORTED)\n"
               "add_subdirectory(plugins)\n");

    tree.write("plugins/objects/ellipsoid.cpp", ellipsoid);

    const RunResult built = installation.build(tree.path(), tree.path() / "build", "lapidary_objects_ellipsoid");
    INFO(built.output);
    REQUIRE(built.exit_code == 0);
    fs::copy_file(tree.path() / "build/lib/lapidary/plugins/objects/ellipsoid.so",
                  installation.prefix() / "lib/lapidary/plugins/objects/ellipsoid.so");

    const RunResult help = run(installation.program() + " help ellipsoid");
    INFO(help.output);
    CHECK(help.exit_code == 0);
    CHECK(help.output.find("ellipsoid: A ball with three radii.") != std::string::npos);
    CHECK(help.output.find("radii(x, y, z)") != std::string::npos);

    const auto picture_of = [&](const std::string& object, const char* name) {
        const fs::path scene = tree.write(std::string(name) + ".scene", scene_of(object));
        const fs::path picture = tree.path() / (std::string(name) + ".bmp");
        const RunResult rendered =
            run(fmt::format("{} --resolution 120x90 -o {} {}", installation.program(), quoted(picture), quoted(scene)));
        INFO(rendered.output);
        CHECK(rendered.exit_code == 0);
        return read_bmp_pixels(picture);
    };
    const auto found = picture_of("ellipsoid { radii(2, 1, 0.5); transform { rotz(30deg); } }", "ellipsoid");
    const auto expected = picture_of("sphere { transform { scale(2, 1, 0.5); rotz(30deg); } }", "sphere");
    REQUIRE(found.size() == 120 * 90 * 3);
    CHECK(std::ranges::count(found, 0) < 120 * 90 * 3 - 1000);  // it is to be seen
    CHECK(count_differences(found, expected) <= 10);

    const fs::path wrong = tree.write("wrong.scene", scene_of("elipsoid { radii(2, 1, 0.5); }"));
    const RunResult refused = run(installation.program() + " check " + quoted(wrong));
    CHECK(refused.exit_code != 0);
    CHECK(refused.output.find("did you mean 'ellipsoid'") != std::string::npos);
}

}  // namespace
}  // namespace lapidary
