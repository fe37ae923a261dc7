// SPDX-License-Identifier: MIT
//
// lapidary converge: whether pictures keep the error asked for, and what that costs, as a table and as a chart.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

#include "apps/lapidary/command_line.h"
#include "apps/lapidary/console.h"
#include "apps/lapidary/convergence.h"
#include "apps/lapidary/interruption.h"
#include "apps/lapidary/logarithmic_chart.h"
#include "apps/lapidary/replace_file.h"
#include "apps/lapidary/session.h"
#include "kernel/prepare/world.h"
#include "lapidary/save_bytes.h"

namespace lapidary {

namespace {

constexpr double usual_longer_side = 160;
// Of an error that is judged, this much may be the reference's.
constexpr double trusted_part = 0.2;

// The same shape, small enough for a reference of many samples.
void make_small(OutputSettings& output) {
    const double scale = usual_longer_side / std::max(output.width, output.height);
    if (scale >= 1) return;
    output.width = std::max(1, static_cast<int>(output.width * scale + 0.5));
    output.height = std::max(1, static_cast<int>(output.height * scale + 0.5));
}

void write_text(const std::string& text, const std::filesystem::path& file) {
    replace_file(file, [&](const std::filesystem::path& beside) { save_bytes(std::as_bytes(std::span(text)), beside); });
}

std::string table(const Convergence& convergence) {
    std::string text = "requested_error,rmse,largest_error,within_twice,samples_per_pixel,seconds,processor_seconds\n";
    for (const ConvergencePoint& point : convergence.points)
        text += fmt::format("{:g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g}\n", point.requested, point.measured.rmse,
                            point.measured.largest, point.measured.within_twice, point.samples_per_pixel, point.seconds,
                            point.processor_seconds);
    return text;
}

// The promise is kept where the measured line runs to the left of the promised one.
LogarithmicChart chart(const Convergence& convergence, const std::string& title) {
    LogarithmicChart::Line promised{"promised: the error asked for", "#c33", true, {}},
        measured{"measured: RMSE", "#236", false, {}};
    for (const ConvergencePoint& point : convergence.points) {
        promised.points.push_back({point.requested, point.seconds});
        measured.points.push_back({point.measured.rmse, point.seconds});
    }
    return {title, "error", "run time in seconds", {promised, measured}};
}

class ConvergeCommand {
public:
    explicit ConvergeCommand(const ConvergeArguments& arguments) : arguments_(arguments), console_({true, false}) {
        console_.listen_to(messages_);
    }

    ExitCode run() {
        Session session(arguments_.scene, messages_);
        session.load();
        const auto built = session.build();
        if (!built) return ExitCode::scene;
        Scene scene = *built;
        if (!arguments_.sized) make_small(scene.output);
        const auto world = prepare_world(scene, messages_);
        require_writable(file("csv"));
        require_writable(file("svg"));

        const Convergence convergence = measure_convergence(*world, scene, options(session));
        if (!convergence.points.empty()) write(convergence, scene);
        if (!convergence.complete) return ExitCode::interrupted;
        return tell(convergence);
    }

private:
    ConvergenceOptions options(const Session& session) {
        Interruption::listen();
        ConvergenceOptions options;
        options.errors = arguments_.errors;
        options.reference_samples = arguments_.reference_samples;
        options.threads = arguments_.threads.value_or(session.configurations().threads().value_or(0));
        options.cancel = &Interruption::requested();
        options.on_point = [](const ConvergencePoint& point) {
            fmt::print("error {:<8g} RMSE {:<10.4g} largest {:<8.3g} within twice {:6.2f} %  {:8.1f} samples a pixel  {:.3g} s\n",
                       point.requested, point.measured.rmse, point.measured.largest, 100 * point.measured.within_twice,
                       point.samples_per_pixel, point.seconds);
            std::fflush(stdout);
        };
        return options;
    }

    void write(const Convergence& convergence, const Scene& scene) const {
        const std::string title =
            fmt::format("{}, {}x{}: run time against error", scene.title, scene.output.width, scene.output.height);
        write_text(table(convergence), file("csv"));
        write_text(chart(convergence, title).to_svg(), file("svg"));
    }

    ExitCode tell(const Convergence& convergence) const {
        fmt::print("reference: {} samples a pixel, itself off by {:.2g}, {:.3g} s\nwrote {} and {}\n",
                   arguments_.reference_samples, convergence.reference_error, convergence.reference_seconds, file("csv").string(),
                   file("svg").string());
        const bool kept = std::ranges::all_of(convergence.points, &ConvergencePoint::keeps_promise);
        if (!kept)
            fmt::print(
                "the error asked for is not kept everywhere: RMSE at most it, and 99 % of the pixels within twice of it\n");
        if (convergence.reference_error > trusted_part * std::ranges::min(arguments_.errors))
            fmt::print("the reference is too coarse to judge the smallest errors by: give more --reference-samples\n");
        return kept ? ExitCode::success : ExitCode::difference;
    }

    // dice.scene has dice.convergence.csv.
    std::filesystem::path file(const std::string& extension) const {
        std::filesystem::path name = arguments_.name;
        if (name.empty()) name = arguments_.scene.file.stem() += ".convergence";
        return name += "." + extension;
    }

    const ConvergeArguments& arguments_;
    Messages messages_;
    Console console_;
};

}  // namespace

ExitCode converge_command(const Words& words) {
    const auto arguments = parse_converge(words);
    return arguments ? ConvergeCommand(*arguments).run() : ExitCode::success;
}

}  // namespace lapidary
