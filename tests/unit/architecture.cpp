// SPDX-License-Identifier: MIT
//
// The arrows between the folders: apps -> loaders -> kernel <- sdk <- plugins. What a file may include follows from where it
// stands, packages have few places, and the kernel never spells a plugin's name.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "support/catch.h"

namespace lapidary {
namespace {

namespace fs = std::filesystem;

const fs::path root = LAPIDARY_SOURCE_FOLDER;
const std::vector<std::string> kinds = {"objects", "materials", "lights", "outputs"};

std::string text_of(const fs::path& file) {
    std::ifstream stream(file);
    return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

// The C++ files of a folder, relative to the root.
std::vector<std::string> sources_of(const char* folder) {
    std::vector<std::string> sources;
    for (const auto& entry : fs::recursive_directory_iterator(root / folder))
        if (entry.path().extension() == ".cpp" || entry.path().extension() == ".h")
            sources.push_back(fs::relative(entry.path(), root).generic_string());
    return sources;
}

std::vector<std::string> includes_of(const std::string& source) {
    static const std::regex include(R"re((?:^|\n)\s*#\s*include\s*[<"]([^>"]*)[>"])re");
    const std::string text = text_of(root / source);
    std::vector<std::string> includes;
    for (auto found = std::sregex_iterator(text.begin(), text.end(), include); found != std::sregex_iterator(); ++found)
        includes.push_back((*found)[1]);
    return includes;
}

bool starts_with_any(const std::string& text, const std::vector<std::string>& beginnings) {
    return std::ranges::any_of(beginnings, [&](const std::string& beginning) { return text.starts_with(beginning); });
}

// Of the project's own folders, a folder's files include these alone.
void check_arrows(const char* folder, const std::vector<std::string>& may_include) {
    const std::vector<std::string> own = {"apps/", "kernel/", "lapidary/", "loaders/", "plugins/", "sdk/", "support/", "tests/"};
    const std::vector<std::string> sources = sources_of(folder);
    CHECK_FALSE(sources.empty());
    for (const std::string& source : sources)
        for (const std::string& include : includes_of(source)) {
            if (!starts_with_any(include, own) || starts_with_any(include, may_include)) continue;
            FAIL_CHECK(source << " includes " << include);
        }
}

TEST_CASE("the kernel includes nothing of the other folders") { check_arrows("kernel", {"kernel/"}); }
TEST_CASE("the SDK stands on the kernel") { check_arrows("sdk", {"kernel/", "lapidary/"}); }
TEST_CASE("plugins see only the SDK") { check_arrows("plugins", {"lapidary/"}); }
TEST_CASE("loaders stand on the kernel") { check_arrows("loaders", {"kernel/", "loaders/"}); }
TEST_CASE("programs stand on loaders and kernel") { check_arrows("apps", {"apps/", "kernel/", "loaders/", "lapidary/"}); }

TEST_CASE("every package has few places") {
    const struct {
        std::string package;
        std::vector<std::string> places;
    } rules[] = {{"boost/dll", {"kernel/registry/"}},
                 {"tbb/", {"kernel/render/", "kernel/prepare/"}},
                 {"oneapi/", {"kernel/render/", "kernel/prepare/"}},
                 {"yaml-cpp/", {"loaders/"}},
                 {"OpenImageIO/", {"plugins/outputs/"}},
                 {"SDL", {"plugins/outputs/"}},
                 {"X11/", {"plugins/outputs/"}},
                 {"CLI/", {"apps/"}},
                 {"catch2/", {"tests/support/"}}};
    for (const char* folder : {"apps", "kernel", "loaders", "plugins", "sdk", "tests"})
        for (const std::string& source : sources_of(folder))
            for (const std::string& include : includes_of(source))
                for (const auto& [package, places] : rules)
                    if (include.starts_with(package) && !starts_with_any(source, places))
                        FAIL_CHECK(source << " includes " << include);
}

TEST_CASE("the kernel never spells a plugin's name") {
    std::set<std::string> names;
    for (const std::string& kind : kinds)
        for (const auto& entry : fs::directory_iterator(root / "plugins" / kind))
            if (entry.path().extension() == ".cpp") names.insert(entry.path().stem().string());
    REQUIRE(names.size() > 10);
    for (const std::string& source : sources_of("kernel")) {
        static const std::regex comment("//[^\n]*");
        const std::string text = std::regex_replace(text_of(root / source), comment, "");
        for (const std::string& name : names)
            if (text.find('"' + name + '"') != std::string::npos) FAIL_CHECK(source << " spells \"" << name << '"');
    }
}

// Vectors wider than the machine's are taken apart by g++, seven times as slow and without a word; libraries of vectors fall back
// as silently. Plain loops become as wide as the instruction set that a library is built for.
TEST_CASE("vectors are made by the compiler") {
    for (const char* folder : {"kernel", "sdk", "plugins"})
        for (const std::string& source : sources_of(folder)) {
            const std::string text = text_of(root / source);
            for (const char* word :
                 {"vector_size", "vector_type", "intrin.h", "__m128", "__m256", "__m512", "experimental/simd", "hwy/"})
                if (text.find(word) != std::string::npos) FAIL_CHECK(source << " spells " << word);
        }
}

TEST_CASE("every source begins with its licence") {
    for (const char* folder : {"apps", "kernel", "loaders", "plugins", "sdk", "tests"})
        for (const std::string& source : sources_of(folder))
            if (!text_of(root / source).starts_with("// SPDX-License-Identifier: MIT\n")) FAIL_CHECK(source);
}

}  // namespace
}  // namespace lapidary
