// SPDX-License-Identifier: MIT
//
// The program as its user meets it: words in, files, text and an exit status out.
#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "lapidary/image_library.h"
#include "support/catch.h"
#include "support/picture.h"
#include "support/run.h"
#include "support/temporary_folder.h"

namespace lapidary {
namespace {

namespace fs = std::filesystem;

constexpr const char* ball = R"(
camera { location(0, 0, -3); rays(1); }
output { resolution(32, 24); }
lights { ambient { }  direct { direction(1, -1, 2); } }
objects { sphere { colour(1, 0.5, 0.2); } }
)";

// The program in a folder of its own, without the user's configuration.
class Desk {
public:
    Desk() { folder.write("ball.scene", ball); }

    RunResult lapidary(const std::string& words, const std::string& before = "") const {
        return run(fmt::format("cd {0} && HOME={0} XDG_CONFIG_HOME={0} DISPLAY= WAYLAND_DISPLAY= {1} {2} {3}",
                               quoted(folder.path()), before, quoted(LAPIDARY_PROGRAM), words));
    }
    fs::path file(const std::string& name) const { return folder.path() / name; }
    bool has(const std::string& name) const { return fs::exists(file(name)); }
    std::string text(const std::string& name) const {
        std::ifstream stream(file(name), std::ios::binary);
        return {std::istreambuf_iterator<char>(stream), {}};
    }
    // Everything there is, hidden files as well.
    std::size_t files() const { return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder.path()), {})); }

    TemporaryFolder folder;
};

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST_CASE("a scene becomes a PNG file of its name, and nothing is said where nobody looks on") {
    const Desk desk;
    const RunResult result = desk.lapidary("ball.scene");
    CHECK(result.exit_code == 0);
    CHECK(result.output.empty());
    CHECK(desk.has("ball.png"));
    CHECK(desk.files() == 2);
}

TEST_CASE("the letters and the extension choose the format") {
    const Desk desk;
    CHECK(desk.lapidary("-b -t ball.scene").exit_code == 0);
    CHECK((desk.has("ball.bmp") && desk.has("ball.tga") && !desk.has("ball.png")));
    CHECK(desk.lapidary("ball.scene -o picture.exr").exit_code == 0);
    CHECK(desk.text("picture.exr").starts_with("\x76\x2f\x31\x01"));
    CHECK(desk.lapidary("ball.scene -o picture.JPG").exit_code == 0);
    CHECK(desk.text("picture.JPG").starts_with("\xff\xd8"));
    CHECK(desk.lapidary("ball.scene -o version.2").exit_code == 0);
    CHECK(desk.has("version.2.png"));
    CHECK(desk.lapidary("ball.scene -b -o other.png").exit_code == 0);
    CHECK((desk.has("other.bmp") && !desk.has("other.png")));
}

TEST_CASE("writers and name of the scene hold unless the command line knows better") {
    const Desk desk;
    desk.folder.write("two.scene",
                      std::string(ball) + "output { resolution(8, 6); name(\"pair.tga\"); png { bits(16); } exr { } }");
    CHECK(desk.lapidary("-s two.scene").exit_code == 0);
    CHECK((desk.has("pair.png") && desk.has("pair.exr") && !desk.has("pair.tga")));
    CHECK(desk.text("pair.png").at(24) == 16);  // bits a sample

    // The scene's own writer of the format that -o names keeps its properties.
    CHECK(desk.lapidary("-s two.scene -o one.png").exit_code == 0);
    CHECK((desk.has("one.png") && !desk.has("one.exr")));
    CHECK(desk.text("one.png").at(24) == 16);
}

TEST_CASE("two writers of one file are an error") {
    const Desk desk;
    desk.folder.write("twice.scene", std::string(ball) + "output { png { bits(16); } png { } }");
    const RunResult result = desk.lapidary("-s twice.scene");
    CHECK(result.exit_code == 4);
    CHECK(contains(result.output, "two writers would write 'twice.png'"));
}

TEST_CASE("what cannot be understood is a usage error with a remedy") {
    const Desk desk;
    const auto refused = [&](const std::string& words, const std::string& sentence) {
        const RunResult result = desk.lapidary(words);
        INFO(words);
        CHECK(result.exit_code == 2);
        CHECK(result.output == "lapidary: " + sentence + "\n");
    };
    refused("--resolutoin 3x3 ball.scene",
            "there is no option '--resolutoin'; did you mean '--resolution'?; lapidary --help lists the options");
    refused("", "scene is required; lapidary --help lists the options");
    refused("ball.scene other.scene", "'other.scene' is one word too many; lapidary --help lists what is taken");
    refused("ball.scene --resolution 3", "--resolution takes two whole numbers above 0, as in 640x480, not '3'");
    refused("ball.scene --region 1,2,3", "--region takes four whole numbers, x0,y0,x1,y1, not '1,2,3'");
    refused("ball.scene --region 5,5,5,9", "--region 5,5,5,9 holds no pixel; x0 and y0 count from 0 and lie below x1 and y1");
    refused("ball.scene --region 0,0,33,9", "--region 0,0,33,9 reaches beyond the picture of 32x24; change one of them");
    refused("ball.scene --time soon", "--time takes a time above 0, as in 30s, 500ms, 2min or 1h, not 'soon'");
    for (const std::string number : {"0", "-1", "nan", "inf", "2", "0.1x", "a"}) {
        const std::string sentence = "takes numbers above 0, at most 1, not '" + number + "'; lapidary";
        refused("ball.scene --error=" + number, "--error: " + sentence + " --help lists the options");
        refused("converge ball.scene --errors=0.1," + number, "--errors: " + sentence + " converge --help lists the options");
    }
    refused("compare a.png b.png --rmse nan",
            "--rmse: takes numbers from 0 up, not 'nan'; lapidary compare --help lists the options");
    refused("help sphre", "there is no keyword 'sphre'; did you mean 'sphere'?; lapidary help lists them");
    CHECK(desk.files() == 1);
}

TEST_CASE("a scene with errors ends with status 3 and no picture") {
    const Desk desk;
    desk.folder.write("bad.scene", "objects { spere { } }");
    const RunResult result = desk.lapidary("bad.scene");
    CHECK(result.exit_code == 3);
    CHECK(contains(result.output, "bad.scene:1:11: error: "));
    CHECK_FALSE(desk.has("bad.png"));
    CHECK(desk.lapidary("nowhere.scene").exit_code == 3);
    CHECK(desk.files() == 2);
}

TEST_CASE("a write that fails is an error, leaves nothing half written, and spares the older file") {
    const Desk desk;
    const RunResult below_a_file = desk.lapidary("ball.scene -o ball.scene/picture.png");
    CHECK(below_a_file.exit_code == 4);
    CHECK(below_a_file.output ==
          "lapidary: error: 'ball.scene/picture.png' cannot be written: 'ball.scene' is not a folder; choose another place with "
          "-o\n");
    CHECK(contains(desk.lapidary("ball.scene -o far/away.png").output, "there is no folder 'far'"));
    const RunResult full = desk.lapidary("ball.scene -b -o /dev/full");
    CHECK(full.exit_code == 4);
    CHECK(full.output ==
          "lapidary: error: '/dev/full' cannot be written: No space left on device; choose another place with -o\n");
    CHECK(desk.lapidary("ball.scene -o .").exit_code == 4);
    CHECK(desk.files() == 1);

    // A disk that fills up while the file is written.
    desk.folder.write("ball.bmp", "older");
    const RunResult cut = desk.lapidary("ball.scene -b --resolution 200x200", "ulimit -f 8;");
    CHECK(cut.exit_code == 4);
    CHECK(contains(cut.output, "'ball.bmp' cannot be written: File too large"));
    CHECK(desk.text("ball.bmp") == "older");
    CHECK(desk.files() == 2);
}

TEST_CASE("a link to a picture stays a link") {
    const Desk desk;
    fs::create_directory(desk.file("store"));
    fs::create_symlink("store/real.bmp", desk.file("ball.bmp"));
    CHECK(desk.lapidary("ball.scene -b").exit_code == 0);
    CHECK(fs::is_symlink(desk.file("ball.bmp")));
    CHECK(fs::is_regular_file(desk.file("store/real.bmp")));
}

TEST_CASE("the option --set changes what the scene says") {
    const Desk desk;
    REQUIRE(desk.lapidary("ball.scene -b -o plain").exit_code == 0);
    REQUIRE(desk.lapidary("ball.scene -b -o moved --set camera.location=0.5,0,-3 --set background=1/2,0,0").exit_code == 0);
    desk.folder.write("written.scene", R"(
        camera { location(0.5, 0, -3); rays(1); }
        background(0.5, 0, 0);
        output { resolution(32, 24); }
        lights { ambient { }  direct { direction(1, -1, 2); } }
        objects { sphere { colour(1, 0.5, 0.2); } })");
    REQUIRE(desk.lapidary("written.scene -b").exit_code == 0);
    CHECK(read_bmp_pixels(desk.file("moved.bmp")) == read_bmp_pixels(desk.file("written.bmp")));
    CHECK(read_bmp_pixels(desk.file("moved.bmp")) != read_bmp_pixels(desk.file("plain.bmp")));
}

TEST_CASE("the option --set reaches nested and named blocks") {
    const Desk desk;
    desk.folder.write("named.scene", "objects { union { sphere pearl { radius(1); } } } lights { ambient { } }");
    const RunResult result = desk.lapidary("-d named.scene --set pearl.radius=0.25 --set camera.screen.size=3,2");
    CHECK(result.exit_code == 0);
    CHECK(contains(result.output, "radius(0.25)"));
    CHECK(contains(result.output, "size(3, 2)"));
}

TEST_CASE("the encoding of the output block holds for a writer that the scene does not name") {
    const Desk desk;
    REQUIRE(desk.lapidary("ball.scene -b -o curved --set background=0.5,0.5,0.5").exit_code == 0);
    REQUIRE(desk.lapidary("ball.scene -b -o straight --set background=0.5,0.5,0.5 --set output.encoding=linear").exit_code == 0);
    CHECK(read_bmp_pixels(desk.file("curved.bmp")).at(0) == 188);
    CHECK(read_bmp_pixels(desk.file("straight.bmp")).at(0) == 128);
}

TEST_CASE("mistakes in --set are placed in the setting") {
    const Desk desk;
    const auto refused = [&](const std::string& setting, const std::string& part) {
        const RunResult result = desk.lapidary("ball.scene --set '" + setting + "'");
        INFO(setting << "\n" << result.output);
        CHECK(result.exit_code == 3);
        CHECK(contains(result.output, part));
    };
    refused("camera", "--set takes block.property=value, as in camera.location=0,1,-5, not 'camera'");
    refused("camera.location=0,1", "--set camera.location=0,1:1:1: error: ");
    refused("camera.loction=0,1,2", "did you mean 'location'?");
    refused("camra.location=0,1,2", "did you mean 'camera'?");
    refused("camera.focus=1); rays(4", "is not what stands between the parentheses of one property");
}

TEST_CASE("regions put together are the picture") {
    const Desk desk;
    REQUIRE(desk.lapidary("ball.scene -b -o whole").exit_code == 0);
    REQUIRE(desk.lapidary("ball.scene -b -o top --region 0,0,32,10").exit_code == 0);
    REQUIRE(desk.lapidary("ball.scene -b -o bottom --region 0,10,32,24 -j 3").exit_code == 0);
    const auto whole = read_bmp_pixels(desk.file("whole.bmp")), top = read_bmp_pixels(desk.file("top.bmp"));
    auto joined = read_bmp_pixels(desk.file("bottom.bmp"));  // rows stand from the bottom
    REQUIRE(joined.size() == 32 * 14 * 3);
    joined.insert(joined.end(), top.begin(), top.end());
    CHECK(joined == whole);
}

TEST_CASE("the option -d shows the scene and writes nothing") {
    const Desk desk;
    const RunResult result = desk.lapidary("-d ball.scene");
    CHECK(result.exit_code == 0);
    CHECK(contains(result.output, "sphere {"));
    CHECK(contains(result.output, "features: "));
    CHECK(desk.files() == 1);
}

TEST_CASE("where there are too many mistakes to tell, the last line counts the rest") {
    const Desk desk;
    std::string text = "objects {\n";
    for (int i = 0; i < 103; ++i) text += "    spere { }\n";
    desk.folder.write("bad.scene", text + "}\n");
    const RunResult result = desk.lapidary("bad.scene");
    CHECK(result.exit_code == 3);
    CHECK(result.output.ends_with("and 3 more errors\n"));
}

TEST_CASE("the log of a scene is a scene that gives the same picture") {
    const Desk desk;
    REQUIRE(desk.lapidary("ball.scene -b -l -o first --samples 3 --set camera.location=1,1,-3").exit_code == 0);
    const std::string log = desk.text("first.log");
    CHECK(contains(log, "//   lapidary ball.scene -b -l -o first --samples 3 --set camera.location=1,1,-3"));
    CHECK(contains(log, "object sphere: "));
    CHECK(contains(log, "//   ball.scene\n"));
    CHECK(contains(log, "ms of processor time\n"));
    fs::rename(desk.file("first.log"), desk.file("again.scene"));
    const RunResult again = desk.lapidary("again.scene");  // the format stands in the log
    INFO(again.output);
    REQUIRE(again.exit_code == 0);
    CHECK(again.output.empty());
    CHECK(read_bmp_pixels(desk.file("again.bmp")) == read_bmp_pixels(desk.file("first.bmp")));
}

TEST_CASE("the option -s keeps warnings from the screen but not from the log") {
    const Desk desk;
    desk.folder.write("warned.scene", std::string(ball) + "camera { location(0, 0, -4); }");
    CHECK(contains(desk.lapidary("warned.scene").output, "warning: "));
    const RunResult silent = desk.lapidary("-s -l warned.scene");
    CHECK(silent.output.empty());
    CHECK(contains(desk.text("warned.log"), "warning: "));
}

TEST_CASE("a log is written of a scene with errors, too") {
    const Desk desk;
    desk.folder.write("bad.scene", "objects { spere { } }");
    CHECK(desk.lapidary("-l bad.scene").exit_code == 3);
    CHECK(contains(desk.text("bad.log"), "//   bad.scene:1:11: error: "));
}

TEST_CASE("check lists the messages, for people and for programs") {
    const Desk desk;
    desk.folder.write("bad.scene", "objects {\n  spere { }\n  cube { size(1); }\n}");
    const RunResult people = desk.lapidary("check bad.scene");
    CHECK(people.exit_code == 3);
    CHECK(contains(people.output, "bad.scene: 2 errors, "));

    const RunResult programs = desk.lapidary("check --json bad.scene");
    CHECK(programs.exit_code == 3);
    const auto json = nlohmann::json::parse(programs.output);
    CHECK(json.at("errors") == 2);
    CHECK(json.at("messages").at(0).at("line") == 2);
    CHECK(json.at("messages").at(0).at("column") == 3);
    CHECK(json.at("messages").at(0).at("severity") == "error");

    const RunResult good = desk.lapidary("check --json ball.scene");
    CHECK(good.exit_code == 0);
    CHECK(nlohmann::json::parse(good.output).at("messages").empty());
    CHECK(desk.files() == 2);
}

TEST_CASE("plugins lists what was found, and what was refused with the reason") {
    const Desk desk;
    desk.folder.write("mine/objects/broken.so", "this is no library");
    const RunResult result = desk.lapidary("plugins --plugin-path mine");
    CHECK(result.exit_code == 0);
    CHECK(contains(result.output, "objects/sphere.so"));
    CHECK(contains(result.output, "mine/objects/broken.so"));
    CHECK(contains(result.output, "refused: "));
}

TEST_CASE("help explains plugins and the language, and lists both") {
    const Desk desk;
    CHECK(contains(desk.lapidary("help torus").output, "radii("));
    CHECK(contains(desk.lapidary("help camera").output, "look_at("));
    CHECK(contains(desk.lapidary("help union").output, "all points of either"));
    const std::string list = desk.lapidary("help").output;
    CHECK((contains(list, " sphere") && contains(list, " png") && contains(list, " union")));
    for (const std::string words :
         {"-?", "--help", "check --help", "plugins --help", "help --help", "compare --help", "--version"}) {
        INFO(words);
        CHECK(desk.lapidary(words).exit_code == 0);
    }
}

TEST_CASE("compare measures, and its status tells whether the pictures differ") {
    const Desk desk;
    REQUIRE(desk.lapidary("ball.scene -o a.png --set background=0,0,0").exit_code == 0);
    REQUIRE(desk.lapidary("ball.scene -o b.png --set background=0,0,0.5 --set output.png.encoding=linear").exit_code == 0);
    REQUIRE(desk.lapidary("ball.scene -o c.png --resolution 8x8").exit_code == 0);

    const RunResult same = desk.lapidary("compare a.png a.png");
    CHECK(same.exit_code == 0);
    CHECK(contains(same.output, "RMSE     0\n"));
    const RunResult other = desk.lapidary("compare a.png b.png --difference d.png");
    CHECK(other.exit_code == 5);
    CHECK(contains(other.output, "of 768 pixels"));
    CHECK(desk.has("d.png"));
    CHECK(desk.lapidary("compare a.png b.png --tolerance 1").exit_code == 0);
    CHECK(desk.lapidary("compare a.png b.png --share 1").exit_code == 0);
    CHECK(desk.lapidary("compare a.png b.png --rmse 1").exit_code == 0);
    CHECK(desk.lapidary("compare a.png b.png --rmse 0.001").exit_code == 5);
    CHECK(desk.lapidary("compare a.png c.png").exit_code == 5);
    CHECK(desk.lapidary("compare a.png nowhere.png").exit_code == 1);
}

TEST_CASE("converge measures the errors, and writes them as a table and as a chart") {
    const Desk desk;
    const RunResult result = desk.lapidary("converge ball.scene --errors 0.03,0.01 --reference-samples 256 -j 2");
    INFO(result.output);
    CHECK(result.exit_code == 0);
    const std::string table = desk.text("ball.convergence.csv"), chart = desk.text("ball.convergence.svg");
    CHECK(std::count(table.begin(), table.end(), '\n') == 3);
    CHECK(
        table.starts_with("requested_error,rmse,largest_error,within_twice,samples_per_pixel,seconds,processor_seconds\n0.03,"));
    CHECK(contains(table, "\n0.01,"));
    CHECK(contains(chart, "<svg "));
    CHECK(contains(chart, "promised"));
    CHECK(desk.files() == 3);

    // What no number of samples can reach is told by the status; 16 of them are no reference for it, either.
    const RunResult missed = desk.lapidary("converge ball.scene --errors 0.0001 --reference-samples 16 -o missed");
    INFO(missed.output);
    CHECK(missed.exit_code == 5);
    CHECK(desk.has("missed.csv"));
    CHECK(desk.has("missed.svg"));
    CHECK(desk.lapidary("converge nothing.scene").exit_code == 3);
}

}  // namespace
}  // namespace lapidary
