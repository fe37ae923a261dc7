// SPDX-License-Identifier: MIT
//
// Where plugins are found, which one wins, and why a library is refused. The libraries that do not fit are built here,
// from a few lines that need no header.
#include "kernel/registry/registry.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <thread>

#include "kernel/registry/search_path.h"
#include "support/catch.h"
#include "support/environment.h"
#include "support/temporary_folder.h"

namespace lapidary {
namespace {

namespace fs = std::filesystem;

const fs::path built_plugins = LAPIDARY_PLUGIN_FOLDER;

// A shared library made of `source`, quickly.
void build_library(const TemporaryFolder& folder, const fs::path& library, const std::string& source) {
    const fs::path file = folder.write("source.cpp", source);
    fs::create_directories((folder.path() / library).parent_path());
    const std::string command =
        fmt::format("'{}' -shared -fPIC -O0 -o '{}' '{}'", LAPIDARY_CXX, (folder.path() / library).string(), file.string());
    REQUIRE(std::system(command.c_str()) == 0);
}

// The fields of a descriptor, spelt out so that each can be made wrong.
std::string descriptor(std::uint32_t magic, std::uint32_t version, const std::string& abi_tag, PluginKind kind,
                       const std::string& functions = "0, 0") {
    return fmt::format(
        "extern \"C\" {{ struct {{ unsigned magic, version; const char* abi_tag; unsigned kind; void *schema, *create; }} "
        "lapidary_plugin = {{{}u, {}u, \"{}\", {}u, {}}}; }}",
        magic, version, abi_tag, static_cast<unsigned>(kind), functions);
}

void copy_plugin(const TemporaryFolder& folder, const char* from, const fs::path& to) {
    fs::create_directories((folder.path() / to).parent_path());
    fs::copy_file(built_plugins / from, folder.path() / to);
}

std::string refusal(const TemporaryFolder& folder, PluginKind kind, const std::string& keyword) {
    Registry registry({folder.path()});
    std::string reason;
    CHECK(registry.find(kind, keyword, reason) == nullptr);
    return reason;
}

std::string refused(const TemporaryFolder& folder, const char* library, const std::string& why) {
    return fmt::format("the plugin '{}' was refused: {}", (folder.path() / library).string(), why);
}

TEST_CASE("a plugin is its kind's folder and its file's stem") {
    Registry registry({built_plugins});
    std::string reason = "left over";
    const Plugin* sphere = registry.find(PluginKind::object, "sphere", reason);
    INFO(reason);
    REQUIRE(sphere);
    CHECK(reason.empty());
    CHECK(sphere->keyword() == "sphere");
    CHECK(sphere->kind() == PluginKind::object);
    CHECK(sphere->file().filename() == "sphere.so");
    CHECK(fs::relative(sphere->file(), built_plugins).string().find("..") == std::string::npos);
    CHECK(sphere->schema().find("radius"));
    CHECK(sphere->create_object() != nullptr);
    CHECK(registry.find(PluginKind::object, "sphere", reason) == sphere);
    CHECK(registry.find(PluginKind::light, "sphere", reason) == nullptr);
    CHECK(reason.empty());
}

TEST_CASE("nothing is opened before it is asked for") {
    Registry registry({built_plugins});
    CHECK_FALSE(registry.keywords(PluginKind::object).empty());
    CHECK(registry.opened().empty());
    std::string reason;
    registry.find(PluginKind::object, "sphere", reason);
    REQUIRE(registry.opened().size() == 1);
    CHECK(registry.opened()[0]->keyword() == "sphere");
}

TEST_CASE("asked for as another kind, a plugin makes nothing") {
    Registry registry({built_plugins});
    std::string reason;
    const Plugin* sphere = registry.find(PluginKind::object, "sphere", reason);
    REQUIRE(sphere);
    CHECK_THROWS_WITH(sphere->create_light(), "the plugin 'sphere' is of kind object, asked for light");
}

TEST_CASE("a keyword is made of letters, digits and underscores: nothing else reaches the disk") {
    Registry registry({built_plugins});
    std::string reason;
    for (const std::string keyword : {"", ".", "..", "../objects/sphere", "sphere.so", "sph ere", "/etc/passwd", "sphère"}) {
        CHECK(registry.find(PluginKind::object, keyword, reason) == nullptr);
        CHECK(reason.empty());
    }
    CHECK(registry.find(PluginKind::object, std::string("sphere\0", 7), reason) == nullptr);
}

TEST_CASE("the first match on the path wins, even where it is refused") {
    const TemporaryFolder first, second;
    copy_plugin(second, "objects/sphere.so", "objects/ball.so");
    Registry registry({first.path(), second.path()});
    std::string reason;
    const Plugin* ball = registry.find(PluginKind::object, "ball", reason);
    INFO(reason);
    REQUIRE(ball);
    CHECK(ball->file() == second.path() / "objects/ball.so");

    first.write("objects/ball.so", "not a library");
    CHECK(registry.find(PluginKind::object, "ball", reason) == ball);  // what was opened stays
    Registry fresh({first.path(), second.path()});
    CHECK(fresh.find(PluginKind::object, "ball", reason) == nullptr);
    CHECK(reason.find("first") == std::string::npos);
    CHECK(reason.find((first.path() / "objects/ball.so").string()) != std::string::npos);
}

TEST_CASE("of one folder, a library for the kernel's own instruction set is taken before the one for any machine") {
    REQUIRE_FALSE(kernel_level().empty());
    const TemporaryFolder first, second;
    const auto file_of_ball = [&] {
        Registry registry({first.path(), second.path()});
        std::string reason;
        const Plugin* ball = registry.find(PluginKind::object, "ball", reason);
        INFO(reason);
        REQUIRE(ball);
        CHECK(registry.keywords(PluginKind::object) == std::vector<std::string>{"ball"});
        CHECK(registry.list().front().file == ball->file());
        return ball->file();
    };
    const std::string own = kernel_level() + "/objects/ball.so", any = "objects/ball.so";
    copy_plugin(second, "objects/sphere.so", own);
    CHECK(file_of_ball() == second.path() / own);
    copy_plugin(first, "objects/sphere.so", any);  // a plugin of its author's that is built once
    CHECK(file_of_ball() == first.path() / any);
    copy_plugin(first, "objects/sphere.so", "x86-64-v9/objects/ball.so");
    CHECK(file_of_ball() == first.path() / any);
    copy_plugin(first, "objects/sphere.so", own);
    CHECK(file_of_ball() == first.path() / own);
}

TEST_CASE("a scene's folders come behind the command line's, in the order written") {
    Registry registry({"/command/line", "/environment", "/installed"}, 1);
    registry.insert_scene_folder("/scene/one");
    registry.insert_scene_folder("/scene/two");
    registry.insert_scene_folder("/scene/one");
    CHECK(registry.search_path() ==
          std::vector<fs::path>{"/command/line", "/scene/one", "/scene/two", "/environment", "/installed"});
}

TEST_CASE("the search path has the stated order") {
    const TemporaryFolder folder;
    const ScopedVariable variable("LAPIDARY_PLUGIN_PATH", "/environment/one::/environment/two:/command/line");
    const ScopedVariable loader_path("LD_LIBRARY_PATH", folder.path().string());
    const auto [path, from_command_line] =
        plugin_search_path({{"/command/line", "/command/line/"}, {"/user"}, {"/project", "/user"}});
    CHECK(from_command_line == 1);
    REQUIRE(path.size() > 5);
    CHECK(std::vector<fs::path>(path.begin(), path.begin() + 5) ==
          std::vector<fs::path>{"/command/line", "/environment/one", "/environment/two", "/user", "/project"});
    CHECK(path.back() == fs::canonical(kernel_folder()) / "lapidary" / "plugins");
    CHECK(std::ranges::count(path, folder.path()) == 0);
}

TEST_CASE("lists of folders are separated by colons") {
    CHECK(split_path_list("").empty());
    CHECK(split_path_list(":::").empty());
    CHECK(split_path_list("a") == std::vector<fs::path>{"a"});
    CHECK(split_path_list(":a::b/c:") == std::vector<fs::path>{"a", "b/c"});
}

TEST_CASE("a file that is no library is refused in the loader's words") {
    const TemporaryFolder folder;
    folder.write("objects/text.so", "radius(1); but not a library at all, whatever its name says, however long it may be");
    folder.write("objects/empty.so", "");
    fs::create_directories(folder.path() / "objects/folder.so");
    CHECK(refusal(folder, PluginKind::object, "text") ==
          refused(folder, "objects/text.so", "the dynamic loader cannot open it: invalid ELF header"));
    CHECK(refusal(folder, PluginKind::object, "empty") ==
          refused(folder, "objects/empty.so", "the dynamic loader cannot open it: file too short"));
    CHECK(refusal(folder, PluginKind::object, "folder").find("cannot open it: cannot read file data: Is a directory") !=
          std::string::npos);
}

TEST_CASE("a library that is cut off is refused") {
    const TemporaryFolder folder;
    copy_plugin(folder, "objects/sphere.so", "objects/half.so");
    const std::uintmax_t size = fs::file_size(folder.path() / "objects/half.so");
    for (const std::uintmax_t part : {size / 2, size / 4, std::uintmax_t{100}}) {
        fs::resize_file(folder.path() / "objects/half.so", part);
        CHECK(refusal(folder, PluginKind::object, "half") ==
              refused(folder, "objects/half.so", "the file is cut off before its end; build or copy it again"));
    }
}

TEST_CASE("a library without a descriptor is refused") {
    const TemporaryFolder folder;
    build_library(folder, "objects/other.so", "int answer() { return 42; }");
    CHECK(refusal(folder, PluginKind::object, "other") == refused(folder, "objects/other.so", "it exports no 'lapidary_plugin'"));
}

TEST_CASE("a descriptor that does not fit is refused before anything is called") {
    const std::string abi = plugin_abi_tag.text;
    const struct {
        std::string source, why;
    } cases[] = {
        {descriptor(42, plugin_interface_version, abi, PluginKind::object),
         "its 'lapidary_plugin' is not a plugin descriptor of Lapidary"},
        {descriptor(plugin_magic, 999, abi, PluginKind::object),
         fmt::format("it was built for version 999 of the plugin interface, this program has version {}; build it again",
                     plugin_interface_version)},
        {descriptor(plugin_magic, plugin_interface_version, "libc++ 8.24", PluginKind::object),
         fmt::format("it was built for the binary interface 'libc++ 8.24', this program has '{}'; build it again with the same "
                     "standard library and SDK",
                     abi)},
        {descriptor(plugin_magic, plugin_interface_version, abi, PluginKind::object), "its plugin descriptor is incomplete"},
        {descriptor(plugin_magic, plugin_interface_version, abi, PluginKind{77}, "(void*)1, (void*)1"),
         "its plugin descriptor is incomplete"},
        {descriptor(plugin_magic, plugin_interface_version, abi, PluginKind::light, "(void*)1, (void*)1"),
         "it is a plugin of kind 'light', not 'object'; move it to the folder lights/"},
    };
    for (const auto& [source, why] : cases) {
        const TemporaryFolder folder;
        build_library(folder, "objects/wrong.so", source);
        CHECK(refusal(folder, PluginKind::object, "wrong") == refused(folder, "objects/wrong.so", why));
    }
}

TEST_CASE("a library that needs what is not there is refused by name") {
    const TemporaryFolder folder;
    build_library(folder, "objects/needy.so", "extern \"C\" void missing_function(); void f() { missing_function(); }");
    CHECK(refusal(folder, PluginKind::object, "needy").find("undefined symbol: missing_function") != std::string::npos);
}

TEST_CASE("the list shows every file: usable, hidden and refused") {
    const TemporaryFolder first, second;
    copy_plugin(first, "objects/sphere.so", "objects/ball.so");
    copy_plugin(second, "objects/sphere.so", "objects/ball.so");
    copy_plugin(second, "lights/point.so", "objects/apple.so");
    second.write("objects/no-keyword.so", "");
    second.write("objects/readme.txt", "");
    Registry registry({first.path(), second.path(), "/does/not/exist"});
    CHECK(registry.keywords(PluginKind::object) == std::vector<std::string>{"apple", "ball"});
    CHECK(registry.keywords(PluginKind::output).empty());

    const std::vector<PluginListing> list = registry.list();
    REQUIRE(list.size() == 3);
    CHECK(list[0].keyword == "apple");
    CHECK_FALSE(list[0].usable);
    CHECK(list[0].reason == "it is a plugin of kind 'light', not 'object'; move it to the folder lights/");
    CHECK(list[1].file == first.path() / "objects/ball.so");
    CHECK(list[1].usable);
    CHECK_FALSE(list[1].hidden);
    CHECK(list[1].summary == "A solid ball.");
    CHECK(list[2].file == second.path() / "objects/ball.so");
    CHECK(list[2].hidden);
}

TEST_CASE("many threads may ask at once, and all are given the same plugin") {
    Registry registry({built_plugins});
    std::vector<const Plugin*> found(8);
    std::vector<std::thread> threads;
    for (std::size_t i = 0; i < found.size(); ++i)
        threads.emplace_back([&registry, &found, i] {
            std::string reason;
            registry.find(PluginKind::object, i % 2 ? "cube" : "torus", reason);
            found[i] = registry.find(PluginKind::object, "sphere", reason);
        });
    for (std::thread& thread : threads) thread.join();
    for (const Plugin* plugin : found) {
        CHECK(plugin != nullptr);
        CHECK(plugin == found[0]);
    }
}

TEST_CASE("objects outlive the registry that opened their library") {
    std::unique_ptr<Object> sphere;
    {
        Registry registry({built_plugins});
        std::string reason;
        const Plugin* plugin = registry.find(PluginKind::object, "sphere", reason);
        REQUIRE(plugin);
        sphere = plugin->create_object();
    }
    CHECK(sphere->bounds().contains({0, 0, 0}));
}

}  // namespace
}  // namespace lapidary
