// SPDX-License-Identifier: MIT
//
// A render that is told to stop, at moments that nobody chose: it ends at once, and what is done is a picture.
#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <fstream>
#include <iterator>
#include <random>
#include <stdexcept>
#include <thread>
#include <vector>

#include "kernel/prepare/world.h"
#include "kernel/render/tracer.h"
#include "lapidary/image_library.h"
#include "support/catch.h"
#include "support/environment.h"
#include "support/run.h"
#include "support/scenes.h"
#include "support/temporary_folder.h"

namespace lapidary {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
using Milliseconds = std::chrono::duration<double, std::milli>;

constexpr int width = 320, height = 240;
const fs::path scenes = fs::path(LAPIDARY_SOURCE_FOLDER) / "scenes";

// The program at work on more samples than it will ever take, in a folder of its own.
class Render {
public:
    explicit Render(const fs::path& scene, const std::vector<std::string>& options = {}) {
        const std::string picture = (folder_.path() / "picture.png").string();
        const std::string said = (folder_.path() / "said").string();
        std::vector<std::string> words{LAPIDARY_PROGRAM, "-w", "--samples", "100000",      "--resolution",
                                       "320x240",        "-o", picture,     scene.string()};
        words.insert(words.end(), options.begin(), options.end());
        std::vector<char*> arguments;
        for (std::string& word : words) arguments.push_back(word.data());
        arguments.push_back(nullptr);

        const ScopedVariable home("HOME", folder_.path()), configuration("XDG_CONFIG_HOME", folder_.path());
        posix_spawn_file_actions_t actions;
        posix_spawn_file_actions_init(&actions);
        posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, said.c_str(), O_WRONLY | O_CREAT, 0600);
        REQUIRE(posix_spawn(&process_, LAPIDARY_PROGRAM, &actions, nullptr, arguments.data(), environ) == 0);
        posix_spawn_file_actions_destroy(&actions);
    }
    ~Render() {
        if (!is_running_) return;
        kill(process_, SIGKILL);
        wait();
    }
    Render(const Render&) = delete;
    Render& operator=(const Render&) = delete;

    // Waits until the program listens to signals; before the first pixel there is nothing to save, and they do what they always
    // do.
    void wait_until_listening() const {
        const std::string status = "/proc/" + std::to_string(process_) + "/status";
        const bool listens = wait_until([&] {
            std::ifstream stream(status);
            for (std::string line; std::getline(stream, line);)
                if (line.starts_with("SigCgt:")) return (std::stoull(line.substr(7), nullptr, 16) >> (SIGTERM - 1) & 1) != 0;
            return false;
        });
        REQUIRE(listens);
    }
    void send(int signal) const { kill(process_, signal); }
    // The exit status; -1 where a signal ended it.
    int wait() {
        int status = 0;
        waitpid(process_, &status, 0);
        is_running_ = false;
        return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    }

    // What is there after it, hidden files as well.
    std::vector<std::string> files() const {
        std::vector<std::string> names;
        for (const auto& entry : fs::directory_iterator(folder_.path())) names.push_back(entry.path().filename().string());
        std::ranges::sort(names);
        return names;
    }
    Picture picture() const { return load_image_library()->decode(folder_.path() / "picture.png"); }
    std::string bytes(const std::string& file) const {
        std::ifstream stream(folder_.path() / file, std::ios::binary);
        return {std::istreambuf_iterator<char>(stream), {}};
    }
    // The milliseconds that stand behind some words of what was said.
    double said(const std::string& words) const {
        const std::string text = bytes("said");
        const std::size_t at = text.find(words);
        INFO(text);
        REQUIRE(at != std::string::npos);
        return std::stod(text.substr(at + words.size()));
    }

private:
    TemporaryFolder folder_;
    pid_t process_ = -1;
    bool is_running_ = true;
};

struct Stop {
    double work = 0, exit = 0, write = 0;  // milliseconds after the signal: end of the work, end of all; of that, writing
};

// Signals so long after the first pixel is begun.
Stop stop_after(Milliseconds moment, int signal, const fs::path& scene) {
    Render render(scene, {"-v"});
    render.wait_until_listening();
    std::this_thread::sleep_for(moment);
    const auto begin = Clock::now();
    render.send(signal);
    CHECK(render.wait() == 130);
    const double exit = Milliseconds(Clock::now() - begin).count();

    CHECK(render.files() == std::vector<std::string>{"picture.png", "said"});
    const Picture picture = render.picture();
    CHECK(picture.width == width);
    CHECK(picture.height == height);
    // The file itself says that it is not finished.
    CHECK(render.bytes("picture.png").find("interrupted after ") != std::string::npos);
    return {render.said("stopped within "), exit, render.said("write ")};
}

// The worst and the middle one of some measured times.
struct Spread {
    explicit Spread(std::vector<double> times) {
        std::ranges::sort(times);
        median = times[times.size() / 2], worst = times.back();
    }
    double median = 0, worst = 0;
};

void stop_at_random_moments(int moments, double allowed) {
    constexpr std::array signals{SIGINT, SIGTERM, SIGHUP};
    const std::array hard{scenes / "extremeMaterialTest.scene", scenes / "dice.scene", scenes / "matDemo.scene"};
    std::mt19937 random(7);
    std::uniform_real_distribution<double> moment(0, 400);
    std::vector<double> work, exit_without_write;
    for (int i = 0; i < moments; ++i) {
        const auto n = static_cast<std::size_t>(i);
        const Stop stop = stop_after(Milliseconds(moment(random)), signals[n % signals.size()], hard[n / 2 % hard.size()]);
        work.push_back(stop.work);
        exit_without_write.push_back(stop.exit - stop.write);
    }
    const Spread worked(work), exited(exit_without_write);
    INFO("work ends after " << worked.median << " ms, at worst " << worked.worst << "; the program, apart from writing, after "
                            << exited.median << " ms, at worst " << exited.worst);
    CHECK(worked.worst < allowed);
    CHECK(exited.worst < allowed);
}

// Other tests run at the same time and take their share of the processors: here the time is not judged.
TEST_CASE("a signal ends a render, and what is done is a picture") { stop_at_random_moments(8, infinity); }

// What is promised, on a machine that does nothing else.
TEST_CASE("a signal ends a render within 50 ms at a hundred random moments", "[.long]") { stop_at_random_moments(100, 50); }

TEST_CASE("an interrupted render says so unasked") {
    Render render(scenes / "dice.scene");
    render.wait_until_listening();
    render.send(SIGINT);
    CHECK(render.wait() == 130);
    CHECK(render.bytes("said").starts_with("interrupted: "));
    auto texts = render.picture().texts;
    CHECK(texts["ImageDescription"].find("interrupted after ") != std::string::npos);
}

TEST_CASE("a second signal ends the program without a picture, and leaves nothing behind") {
    for (int i = 0; i < 3; ++i) {
        Render render(scenes / "extremeMaterialTest.scene");
        render.wait_until_listening();
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
        render.send(SIGTERM);
        std::this_thread::sleep_for(std::chrono::milliseconds(2 * i));
        render.send(SIGINT);
        CHECK(render.wait() == 130);
        // Either it came before the picture's last byte, or the picture is whole.
        const std::vector<std::string> files = render.files();
        if (files != std::vector<std::string>{"said"}) {
            CHECK(files == std::vector<std::string>{"picture.png", "said"});
            CHECK(render.picture().width == width);
        }
    }
}

// A path that splits at every face, until the recursion ends: more faces than anybody waits for.
constexpr const char* hall_of_glass = R"(
render { depth(1000); cutoff(0); }
lights { ambient { } }
objects { repeat i (0, 19) { sphere { radius(0.4); material { solid { refraction(1.5); } } transform { translate(0.05, 0.1, i + 2); } } } }
)";

TEST_CASE("a tracer that is told to stop leaves its paths where they are") {
    const auto built = test::build(hall_of_glass);
    for (const std::string& headline : built->headlines()) FAIL_CHECK(headline);
    REQUIRE(built->scene);
    const auto world = prepare_world(*built->scene, built->messages);
    Tracer tracer(*world, built->scene->render, 0);
    std::atomic<bool> stop{false};
    int met = 0;
    tracer.stop_when(&stop);
    tracer.observe([&](const PathEvent&) {
        if (++met > 2000) throw std::runtime_error("the paths go on");
        if (met == 1000) stop = true;
    });
    const std::array rays{Ray{{}, {0, 0, 1}, {}, {}}, Ray{{}, {0, 0, 1}, {}, {}}};
    std::array<RaySample, 2> samples;
    tracer.trace(rays, samples);
    CHECK(met == 1000);
}

}  // namespace
}  // namespace lapidary
