// SPDX-License-Identifier: MIT
//
// The option --watch: a scene is rendered again whenever one of its files is saved, in whatever way editors do that.
#include <fmt/format.h>

#include <fstream>
#include <iterator>
#include <string>

#include "support/catch.h"
#include "support/run.h"
#include "support/temporary_folder.h"

namespace lapidary {
namespace {

namespace fs = std::filesystem;

// The program in the background, which waits for saves.
class Watching {
public:
    explicit Watching(const TemporaryFolder& folder) : folder_(folder) {
        run(fmt::format(
            "cd {0}; HOME={0} XDG_CONFIG_HOME={0} timeout 600 {1} --watch -w ball.scene >said 2>&1 & echo $! >process",
            quoted(folder.path()), quoted(LAPIDARY_PROGRAM)));
    }
    ~Watching() { run(fmt::format("kill $(cat {})", quoted(folder_.path() / "process"))); }
    Watching(const Watching&) = delete;
    Watching& operator=(const Watching&) = delete;

    std::string said() const {
        std::ifstream stream(folder_.path() / "said");
        return {std::istreambuf_iterator<char>(stream), {}};
    }
    // After so many renders it waits for the next save.
    bool has_rendered(int times) const {
        return wait_until([&] {
            const std::string text = said(), remark = "waiting until ball.scene is saved\n";
            int count = 0;
            for (std::size_t at = text.find(remark); at != std::string::npos; at = text.find(remark, at + 1)) ++count;
            return count == times;
        });
    }

private:
    const TemporaryFolder& folder_;
};

TEST_CASE("an included file is watched, also while it is missing") {
    const TemporaryFolder folder;
    folder.write("ball.scene", "output { resolution(8, 6); } include \"part.inc\"");
    const std::string part = "lights { ambient { } } objects { sphere { } }";
    folder.write("part.inc", part);
    const Watching watching(folder);
    REQUIRE(watching.has_rendered(1));
    CHECK(watching.said().find("error") == std::string::npos);

    // As editors do: at once.
    fs::rename(folder.write("saved.inc", part + "\n"), folder.path() / "part.inc");
    REQUIRE(watching.has_rendered(2));
    CHECK(watching.said().find("error") == std::string::npos);

    fs::remove(folder.path() / "part.inc");
    REQUIRE(watching.has_rendered(3));
    CHECK(watching.said().find("ball.scene:1:38: error: ") != std::string::npos);
    fs::remove(folder.path() / "ball.png");
    fs::rename(folder.write("saved.inc", part), folder.path() / "part.inc");
    REQUIRE(watching.has_rendered(4));
    CHECK(fs::exists(folder.path() / "ball.png"));

    // The scene itself.
    fs::rename(folder.path() / "ball.scene", folder.path() / "moved.scene");
    REQUIRE(watching.has_rendered(5));
    fs::remove(folder.path() / "ball.png");
    fs::rename(folder.path() / "moved.scene", folder.path() / "ball.scene");
    REQUIRE(watching.has_rendered(6));
    CHECK(fs::exists(folder.path() / "ball.png"));
}

}  // namespace
}  // namespace lapidary
