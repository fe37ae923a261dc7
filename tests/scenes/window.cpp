// SPDX-License-Identifier: MIT
//
// The window on a display of its own (Xvfb), driven as by a user (xdotool); the terminal's picture; and what happens
// where there is no display.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <iterator>
#include <utility>

#include "lapidary/image_library.h"
#include "support/catch.h"
#include "support/run.h"
#include "support/temporary_folder.h"

namespace lapidary {
namespace {

namespace fs = std::filesystem;

constexpr const char* ball = R"(
camera { location(0, 0, -3); }
output { resolution(200, 150); }
solid red { colour(1, 0, 0); } background(0, 0, 1);
lights { ambient { intensity(1); } }
objects { sphere { material { red; } } }
)";

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

bool have(const std::string& program) { return run("command -v " + program).exit_code == 0; }

// A display without a screen, gone after the test.
class VirtualDisplay {
public:
    VirtualDisplay() {
        // Xvfb chooses a free number and tells it. It must not begin anew whenever the last client has gone.
        const RunResult started = run(fmt::format(
            "cd {0}; Xvfb -displayfd 3 -screen 0 640x480x24 -fbdir . -nolisten tcp -noreset 3>number >/dev/null 2>&1 & "
            "echo $! > {0}/process; "
            "for i in $(seq 600); do [ -s {0}/number ] && [ $(wc -l <{0}/number) = 1 ] && break; sleep 0.1; "
            "done; cat {0}/number {0}/process",
            quoted(folder_.path())));
        std::size_t end = 0;
        number_ = std::stoi(started.output, &end);
        process_ = std::stoi(started.output.substr(end));
    }
    ~VirtualDisplay() { turn_off(); }
    VirtualDisplay(const VirtualDisplay&) = delete;
    VirtualDisplay& operator=(const VirtualDisplay&) = delete;

    void turn_off() {
        if (const int process = std::exchange(process_, 0)) run(fmt::format("kill {}", process));
    }
    std::string variable() const { return fmt::format("DISPLAY=:{}", number_); }
    RunResult tool(const std::string& words) const { return run(variable() + " " + words); }

    // What the screen shows, from the server's own memory: a file in the format of xwd, big-endian numbers in front.
    std::array<int, 3> colour_at(int x, int y) const {
        std::ifstream stream(folder_.path() / "Xvfb_screen0", std::ios::binary);
        const std::string screen{std::istreambuf_iterator<char>(stream), {}};
        const auto byte = [&](std::size_t at) { return static_cast<int>(static_cast<unsigned char>(screen.at(at))); };
        const auto number = [&](std::size_t index) {
            std::size_t value = 0;
            for (std::size_t i = 0; i < 4; ++i) value = value << 8 | static_cast<std::size_t>(byte(4 * index + i));
            return value;
        };
        const std::size_t header_size = number(0), bytes_per_line = number(12), colour_map_entries = number(19);
        const std::size_t at = header_size + 12 * colour_map_entries + static_cast<std::size_t>(y) * bytes_per_line +
                               4 * static_cast<std::size_t>(x);
        return {byte(at + 2), byte(at + 1), byte(at)};
    }

private:
    TemporaryFolder folder_;
    int number_ = 0, process_ = 0;
};

// A render in the background that keeps its window.
class Show {
public:
    Show(const VirtualDisplay& display, const std::string& options) : display_(display) {
        folder.write("ball.scene", ball);
        run(fmt::format(
            "(cd {0}; {1} HOME={0} timeout 600 {2} --hold {3} ball.scene >said 2>&1; echo $? >status) >/dev/null 2>&1 &",
            quoted(folder.path()), display.variable(), quoted(LAPIDARY_PROGRAM), options));
    }
    ~Show() {
        if (!is_over()) press("Escape");
        wait_for("status");
    }

    std::string title() const { return display_.tool("xdotool search --name '^ball' getwindowname").output; }
    // By the server's own keyboard, as soon as that belongs to the window. A key sent to the window itself would be two
    // messages, down and up, and the second one would find no window where the first one closed it.
    void press(const std::string& key) const {
        const auto has_focus = [&] { return display_.tool("xdotool getwindowfocus getwindowname").output.starts_with("ball"); };
        if (wait_until([&] { return has_focus() || is_over(); })) display_.tool("xdotool key " + key);
    }
    // As editors do: at once.
    void save(const std::string& scene) const { fs::rename(folder.write("saved.scene", scene), folder.path() / "ball.scene"); }
    // What takes the window away.
    void tool(const std::string& words) const { display_.tool("sh -c 'xdotool search --name ^ball " + words + "'"); }
    bool wait_for_title(const std::string& part) const {
        return wait_until([&] { return contains(title(), part); });
    }
    bool has(const std::string& file) const {
        std::error_code missing;
        const auto size = fs::file_size(folder.path() / file, missing);
        return !missing && size > 0;
    }
    bool wait_for(const std::string& file) const {
        return wait_until([&] { return has(file); });
    }
    std::string text(const std::string& file) const {
        std::ifstream stream(folder.path() / file);
        return {std::istreambuf_iterator<char>(stream), {}};
    }

    TemporaryFolder folder;

private:
    bool is_over() const { return has("status"); }

    const VirtualDisplay& display_;
};

bool can_show() {
    if (have("Xvfb") && have("xdotool")) return true;
    WARN("Xvfb and xdotool are not installed: the window is not tested");
    return false;
}

std::array<int, 3> colour_at(const Picture& picture, int x, int y) {
    std::array<int, 3> colour{};
    for (std::size_t c = 0; c < 3; ++c)
        colour[c] = static_cast<int>(std::lround(
            255 * std::get<std::vector<float>>(
                      picture.samples)[static_cast<std::size_t>(y * picture.width + x) * picture.channels.size() + c]));
    return colour;
}

TEST_CASE("the window shows the picture, tells of pixels, saves, and closes on Escape") {
    if (!can_show()) return;
    const VirtualDisplay display;
    const Show show(display, "");
    REQUIRE(show.wait_for_title("ball"));
    REQUIRE(show.wait_for("ball.png"));

    display.tool("sh -c 'xdotool search --name ^ball mousemove --window %1 100 75'");
    CHECK(show.wait_for_title("100,75: 1 0 0, object sphere on line 6, material red"));
    show.press("s");
    REQUIRE(show.wait_for("ball-1.png"));
    CHECK(show.wait_for_title("saved ball-1.png"));
    const Picture saved = load_image_library()->decode(show.folder.path() / "ball-1.png");
    CHECK(saved.width == 200);
    CHECK(colour_at(saved, 100, 75) == std::array{255, 0, 0});
    CHECK(colour_at(saved, 1, 1) == std::array{0, 0, 255});
    show.press("minus");
    CHECK(show.wait_for_title("exposure -0.5"));

    show.press("Escape");
    REQUIRE(show.wait_for("status"));
    CHECK(show.text("status") == "0\n");
    CHECK(show.text("said") == "");
}

TEST_CASE("what is on the screen is the picture") {
    if (!can_show()) return;
    const VirtualDisplay display;
    const Show show(display, "");
    REQUIRE(show.wait_for("ball.png"));
    REQUIRE(show.wait_for_title("ball"));
    // The window stands in the middle of a screen of 640x480.
    CHECK(wait_until([&] { return display.colour_at(320, 240) == std::array{255, 0, 0}; }));
    CHECK(display.colour_at(320 - 95, 240 - 70) == std::array{0, 0, 255});
}

TEST_CASE("the option --watch shows the scene anew in the same window when it is saved") {
    if (!can_show()) return;
    const VirtualDisplay display;
    const Show show(display, "--watch");
    REQUIRE(wait_until([&] { return display.colour_at(320, 240) == std::array{255, 0, 0}; }));
    // The picture is seen before it is finished; after that the program says that it waits.
    const auto wait_for_renders = [&](int renders) {
        return wait_until([&] {
            const std::string said = show.text("said"), remark = "waiting until ball.scene is saved\n";
            int count = 0;
            for (std::size_t at = said.find(remark); at != std::string::npos; at = said.find(remark, at + 1)) ++count;
            return count == renders;
        });
    };
    REQUIRE(wait_for_renders(1));
    std::string changed = ball;
    changed.replace(changed.find("colour(1, 0, 0)"), 15, "colour(0, 1, 0)");
    show.save(changed + "\n");
    CHECK(wait_until([&] { return display.colour_at(320, 240) == std::array{0, 255, 0}; }));
    REQUIRE(wait_for_renders(2));

    // A mistake is reported, and mended by the next save.
    show.save("objects { spere { } }");
    CHECK(wait_until([&] { return contains(show.text("said"), "ball.scene:1:11: error: "); }));
    REQUIRE(wait_for_renders(3));
    changed.replace(changed.find("colour(0, 1, 0)"), 15, "colour(1, 1, 1)");
    show.save(changed);
    CHECK(wait_until([&] { return display.colour_at(320, 240) == std::array{255, 255, 255}; }));
    REQUIRE(wait_for_renders(4));
    show.press("Escape");
    REQUIRE(show.wait_for("status"));
    CHECK(show.text("status") == "0\n");
}

TEST_CASE("Escape stops a render: what is done is written, and the status says interrupted") {
    if (!can_show()) return;
    const VirtualDisplay display;
    const Show show(display, "--samples 800 --resolution 640x480");  // many tiles: the time that is left is soon known
    REQUIRE(show.wait_for_title(" %"));
    CHECK(show.wait_for_title(" left"));
    show.press("Escape");
    REQUIRE(show.wait_for("status"));
    CHECK(show.text("status") == "130\n");
    CHECK(contains(show.text("said"), "interrupted: ball.png"));
    CHECK(fs::exists(show.folder.path() / "ball.png"));
}

TEST_CASE("a window that is taken away was closed: what is done is written") {
    if (!can_show()) return;
    const std::string way = GENERATE(as<std::string>{}, "destroyed", "cut off", "without display");
    CAPTURE(way);
    VirtualDisplay display;
    const Show show(display, "--samples 5000");
    REQUIRE(show.wait_for_title("ball, "));
    if (way == "destroyed")
        show.tool("windowclose");
    else if (way == "cut off")
        show.tool("windowkill");
    else
        display.turn_off();
    REQUIRE(show.wait_for("status"));
    CHECK(show.text("status") == "130\n");
    const std::string said = show.text("said");
    CAPTURE(said);
    CHECK(said.starts_with("interrupted: ball.png: "));
    CHECK(std::count(said.begin(), said.end(), '\n') == 1);
    CHECK(load_image_library()->decode(show.folder.path() / "ball.png").width == 200);
}

TEST_CASE("without a display there is one line of warning, and the picture") {
    const TemporaryFolder folder;
    folder.write("ball.scene", ball);
    const auto lapidary = [&](const std::string& display, const std::string& words) {
        return run(fmt::format("cd {0} && HOME={0} WAYLAND_DISPLAY= DISPLAY={1} {2} {3} ball.scene", quoted(folder.path()),
                               display, quoted(LAPIDARY_PROGRAM), words));
    };
    const RunResult asked = lapidary("", "-f -o asked");
    CHECK(asked.exit_code == 0);
    CHECK(asked.output ==
          "warning: there is no display (neither DISPLAY nor WAYLAND_DISPLAY is set); the picture is rendered without window\n");
    CHECK(fs::exists(folder.path() / "asked.png"));

    const RunResult dead = lapidary(":987", "-o dead");
    CHECK(dead.exit_code == 0);
    CHECK(contains(dead.output, "warning: there is no display: "));
    CHECK(std::count(dead.output.begin(), dead.output.end(), '\n') == 1);
    CHECK(fs::exists(folder.path() / "dead.png"));

    CHECK(lapidary("", "-o quiet").output.empty());
    CHECK(lapidary(":987", "-w -o quiet").output.empty());
}

TEST_CASE("the option --preview draws the picture in half blocks of true colour") {
    const TemporaryFolder folder;
    folder.write("ball.scene", ball);
    const RunResult result = run(fmt::format("cd {0} && HOME={0} WAYLAND_DISPLAY= DISPLAY= {1} --preview ball.scene",
                                             quoted(folder.path()), quoted(LAPIDARY_PROGRAM)));
    CHECK(result.exit_code == 0);
    CHECK(std::count(result.output.begin(), result.output.end(), '\n') == 30);  // 80 columns, 60 pixels high
    CHECK(result.output.starts_with("\033[38;2;0;0;255m\033[48;2;0;0;255m▀"));
    CHECK(contains(result.output, "255;0;0m"));
    CHECK_FALSE(contains(result.output, "\033[30A"));  // drawn once where it is no terminal
}

// Milliseconds from the start of the program's work until a first, coarse picture is whole.
double first_view(const std::string& scene, const std::string& resolution, const VirtualDisplay* display) {
    const TemporaryFolder folder;
    const RunResult result =
        run(fmt::format("cd {0} && HOME={0} WAYLAND_DISPLAY= {1} {2} -v {3} --samples 1 --resolution {4} -o view {5}",
                        quoted(folder.path()), display ? display->variable() : "DISPLAY=", quoted(LAPIDARY_PROGRAM),
                        display ? "" : "--preview", resolution, quoted(fs::path(LAPIDARY_SOURCE_FOLDER) / "scenes" / scene)));
    REQUIRE(result.exit_code == 0);
    const std::string words = "first view after ";
    const std::size_t at = result.output.find(words);
    REQUIRE(at != std::string::npos);
    return std::stod(result.output.substr(at + words.size()));
}

// Other tests take their share of the processors meanwhile: here the time is not judged.
TEST_CASE("a first view of the whole picture is told of") { CHECK(first_view("dice.scene", "160x120", nullptr) > 0); }

// What is promised, on a machine that does nothing else.
TEST_CASE("a first view of the whole picture is there within 100 ms", "[.long]") {
    const VirtualDisplay display;
    for (const char* scene : {"dice.scene", "matDemo.scene", "extremeMaterialTest.scene", "gallery/turbulence.scene"})
        for (const char* resolution : {"640x480", "1920x1080"}) {
            CAPTURE(scene, resolution);
            CHECK(first_view(scene, resolution, nullptr) < 100);
            CHECK(first_view(scene, resolution, &display) < 100);
        }
}

}  // namespace
}  // namespace lapidary
