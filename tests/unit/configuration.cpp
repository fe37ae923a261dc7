// SPDX-License-Identifier: MIT
//
// The configuration files of user and project: what they set, and what is said about mistakes in them.
#include "loaders/config/configuration.h"

#include <fmt/format.h>

#include <fstream>

#include "support/catch.h"
#include "support/environment.h"
#include "support/temporary_folder.h"

namespace lapidary {
namespace {

namespace fs = std::filesystem;

struct Loaded {
    Configuration configuration;
    std::vector<std::string> messages;  // "line:column: text"
};

Loaded load(const TemporaryFolder& folder, std::string_view text) {
    Sources sources;
    Messages messages;
    Loaded loaded;
    loaded.configuration = load_configuration(folder.write("lapidary.yaml", text), sources, messages);
    for (const Message& message : messages.all()) {
        const char* const severity = message.severity == Severity::warning ? "warning: " : "";
        loaded.messages.push_back(fmt::format("{}:{}: {}{}", message.line, message.column, severity, message.text));
    }
    return loaded;
}

std::vector<std::string> messages_of(std::string_view text) { return load(TemporaryFolder(), text).messages; }

using Texts = std::vector<std::string>;

TEST_CASE("a configuration sets folders and threads") {
    const TemporaryFolder folder;
    const ScopedVariable home("HOME", folder.path().string());
    for (const char* name : {"plugins", "mine", "parts"}) fs::create_directory(folder.path() / name);
    const auto [configuration, messages] = load(folder,
                                                "# of the project\n"
                                                "plugin_path: [ ~/plugins, ./mine, / ]\n"
                                                "include_path: parts\n"
                                                "threads: 4\n");
    CHECK(messages.empty());
    CHECK(configuration.plugin_path == std::vector<fs::path>{folder.path() / "plugins", folder.path() / "mine", "/"});
    CHECK(configuration.include_path == std::vector<fs::path>{folder.path() / "parts"});
    CHECK(configuration.threads == 4);
}

TEST_CASE("an empty configuration sets nothing") {
    for (const char* text : {"", "\n", "# nothing\n", "---\n", "{}"}) CHECK(messages_of(text).empty());
}

TEST_CASE("a folder that does not exist is warned of") {
    CHECK(messages_of("include_path: /does/not/exist") ==
          Texts{"1:15: warning: there is no folder '/does/not/exist'; it is passed over"});
}

TEST_CASE("an unknown setting is an error with the nearest name") {
    CHECK(messages_of("threads: 2\nplugins_path: x\n") ==
          Texts{"2:1: unknown setting 'plugins_path'; did you mean 'plugin_path'?; the settings are include_path, plugin_path, "
                "threads"});
}

TEST_CASE("a setting given twice is an error at the second place") {
    CHECK(messages_of("threads: 2\nthreads: 3\n") ==
          Texts{"2:1: the setting 'threads' was already given in line 1; keep one of the two"});
}

TEST_CASE("a value of the wrong kind is an error at its place") {
    const std::string threads = "'threads' takes a whole number from 0 to 4096; 0 means as many as the machine has";
    CHECK(messages_of("threads: many") == Texts{"1:10: " + threads});
    CHECK(messages_of("threads: 4.5") == Texts{"1:10: " + threads});
    CHECK(messages_of("threads: -1") == Texts{"1:10: " + threads});
    CHECK(messages_of("threads: 99999999999999999999") == Texts{"1:10: " + threads});
    CHECK(messages_of("threads: [1]") == Texts{"1:10: " + threads});
    CHECK(messages_of("threads:\n") == Texts{"1:1: " + threads});
    const std::string folders = "a folder is expected, or a list of folders: [one, two]";
    CHECK(messages_of("include_path: {a: b}") == Texts{"1:15: " + folders});
    CHECK(messages_of("include_path: [/, [b]]") == Texts{"1:19: " + folders});
    CHECK(messages_of("plugin_path:\n") == Texts{"1:1: " + folders});
}

TEST_CASE("what is not a list of settings is an error") {
    CHECK(messages_of("- a\n- b\n") ==
          Texts{"1:1: a configuration is made of lines 'setting: value'; the settings are include_path, plugin_path, threads"});
    CHECK(messages_of("[a]: b\n") ==
          Texts{"1:1: the name of a setting is a word; the settings are include_path, plugin_path, threads"});
    CHECK(messages_of("threads: 1\n---\nthreads: 2\n").size() == 1);
}

TEST_CASE("what is not YAML is an error with a place, and never a crash") {
    for (const std::string& text :
         {std::string("threads: [1"), std::string("a: b: c"), std::string("\t- x"), std::string("&a [*a, *b]"),
          std::string(100000, '['), std::string("\xff\xfe\x00\x01", 4), std::string("? "), std::string("!!binary x"),
          std::string("threads: &a [*a]"), std::string("\0", 1), "{" + std::string(50000, '{')})
        CHECK_FALSE(messages_of(text).empty());
}

TEST_CASE("a file that does not exist says nothing; one that cannot be read is an error") {
    const TemporaryFolder folder;
    Sources sources;
    Messages messages;
    load_configuration(folder.path() / "none.yaml", sources, messages);
    load_configuration({}, sources, messages);
    CHECK(messages.all().empty());
    load_configuration(folder.path(), sources, messages);
    REQUIRE(messages.errors() == 1);
    CHECK(messages.all()[0].text ==
          fmt::format("cannot read the configuration '{}': it is not a file; remove it or put a file there",
                      folder.path().string()));
}

TEST_CASE("the user's file is where the desktop's rules say") {
    const ScopedVariable home("HOME", "/home/somebody");
    {
        const ScopedVariable configuration("XDG_CONFIG_HOME", "/elsewhere");
        CHECK(user_configuration_file() == "/elsewhere/lapidary/config.yaml");
    }
    const ScopedVariable configuration("XDG_CONFIG_HOME", "");
    CHECK(user_configuration_file() == "/home/somebody/.config/lapidary/config.yaml");
}

TEST_CASE("the project knows better than the user, and both add folders") {
    Configurations both;
    CHECK_FALSE(both.threads());
    both.user.threads = 2;
    CHECK(both.threads() == 2);
    both.project.threads = 5;
    CHECK(both.threads() == 5);
    both.user.include_path = {"/a"};
    both.project.include_path = {"/b"};
    CHECK(both.include_path() == std::vector<fs::path>{"/a", "/b"});
}

}  // namespace
}  // namespace lapidary
