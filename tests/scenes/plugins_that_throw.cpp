// SPDX-License-Identifier: MIT
//
// Exceptions that leave a plugin become a message that names it.
#include <fmt/format.h>

#include <filesystem>
#include <string>

#include "kernel/interfaces/light.h"
#include "kernel/registry/registry.h"
#include "support/catch.h"
#include "support/run.h"
#include "support/temporary_folder.h"

namespace lapidary {
namespace {

// Throws when it is made for the time given by the macro: the first is the specimen that defaults are read from.
constexpr const char* bomb = R"(
#include <lapidary/plugin.h>
#include <stdexcept>
namespace lapidary {
class Bomb final : public Light {
public:
    static void describe(Schema<Bomb>& schema) { schema.summary("A light that is not."); }
    Bomb() {
        static int made = 0;
        if (++made == THROWS_AT) THROWN;
    }
    Illumination toward(const Point&, const LightSample&) const override { return {}; }
};
LAPIDARY_PLUGIN(Bomb)
}
)";

TEST_CASE("what a plugin throws is reported with its name") {
    const TemporaryFolder folder;
    const auto source = folder.write("bomb.cpp", bomb);
    std::filesystem::create_directory(folder.path() / "lights");
    const auto build = [&](const char* keyword, int throws_at, const char* thrown) {
        const RunResult built = run(fmt::format(
            "{} -std=c++20 -shared -fPIC -O0 -fvisibility=hidden -I {} -I {}/sdk -DTHROWS_AT={} '-DTHROWN={}' -o {} {}",
            quoted(LAPIDARY_CXX), quoted(LAPIDARY_SOURCE_FOLDER), quoted(LAPIDARY_SOURCE_FOLDER), throws_at, thrown,
            quoted(folder.path() / "lights" / (std::string(keyword) + ".so")), quoted(source)));
        INFO(built.output);
        REQUIRE(built.exit_code == 0);
    };
    Registry registry({folder.path()});
    std::string reason;

    build("early", 1, "throw std::runtime_error(\"no fuse\")");
    const auto early = folder.path() / "lights" / "early.so";
    CHECK(registry.find(PluginKind::light, "early", reason) == nullptr);
    CHECK(reason == fmt::format("the plugin '{}' was refused: its description failed: no fuse", early.string()));

    build("late", 2, "throw 42");
    const auto late = folder.path() / "lights" / "late.so";
    const Plugin* plugin = registry.find(PluginKind::light, "late", reason);
    INFO(reason);
    REQUIRE(plugin);
    CHECK_THROWS_WITH(plugin->create_light(),
                      fmt::format("the plugin 'late' ({}) cannot make its light: an exception of unknown type", late.string()));
    CHECK(plugin->create_light() != nullptr);
}

}  // namespace
}  // namespace lapidary
