// SPDX-License-Identifier: MIT
#include "apps/lapidary/render_record.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <ctime>

#include "apps/lapidary/progress.h"
#include "kernel/prepare/world.h"
#include "kernel/registry/registry.h"
#include "kernel/registry/search_path.h"
#include "kernel/scene/print.h"

namespace lapidary {

namespace {

double share(std::uint64_t part, std::uint64_t whole) {
    return whole ? static_cast<double>(part) / static_cast<double>(whole) : 0;
}

// Never rounds up to 100.
std::string percent(std::uint64_t part, std::uint64_t whole) {
    return part == whole ? "100 %" : fmt::format("{:.1f} %", std::min(100 * share(part, whole), 99.9));
}

std::string world_line(const World& world) {
    return fmt::format(
        "{} leaves in {} solids, {} left out as nothing is left of them or in their reach, {} sheets, {} lights, {} surfaces "
        "shared",
        world.leaves.size(), world.solids.size(), world.leaves_left_out, world.sheets.size(),
        world.lights.size() + world.ambient_lights.size(), world.surface_classes.size());
}

void add_trace(const TraceStatistics& trace, std::vector<std::string>& lines) {
    lines.push_back(fmt::format("{} camera rays, {} of them not sent as nothing is in reach, {} mirrored, {} refracted",
                                trace.camera_rays, trace.camera_rays_skipped, trace.mirrored_rays, trace.refracted_rays));
    lines.push_back(fmt::format("{} shadow rays, {} of them not sent as nothing is in reach, {} skipped",
                                trace.shadow_rays + trace.shadow_rays_spared, trace.shadow_rays_spared,
                                trace.shadow_rays_skipped));
    const std::uint64_t rays = trace.camera_rays + trace.mirrored_rays + trace.refracted_rays + trace.shadow_rays;
    lines.push_back(fmt::format("{} tests of objects, {:.1f} a ray", trace.object_tests, share(trace.object_tests, rays)));
    if (trace.march_steps) lines.push_back(fmt::format("{} boundaries met inside transparent matter", trace.march_steps));
    lines.push_back(fmt::format("{} octaves too fine to be seen", trace.octaves_faded));
    lines.push_back(fmt::format("rounding: {} slivers removed, {} rays began in another cell than expected, {} samples dropped",
                                trace.slivers_removed, trace.first_cell_disagreements, trace.non_finite_samples));
}

std::string list(const std::vector<std::string>& names) {
    std::string text;
    for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
    return text.empty() ? "none" : text;
}

// The words as a shell would take them.
std::string command_line(const Words& words) {
    std::string line = "lapidary";
    for (const std::string& word : words) {
        const bool plain = !word.empty() && word.find_first_not_of(
                                                "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789"
                                                "_-+=.,:/@%") == std::string::npos;
        line += ' ';
        if (plain) {
            line += word;
            continue;
        }
        line += '\'';
        for (const char c : word) line += c == '\'' ? std::string("'\\''") : std::string(1, c);
        line += '\'';
    }
    return line;
}

// Text as comment lines, whatever line ends it holds.
class Comment {
public:
    void title(const std::string& text) { body_ += "//\n// " + text + "\n"; }
    void line(const std::string& text) {
        body_ += "//   ";
        for (const char c : text) body_ += c == '\n' ? std::string("\n//   ") : std::string(1, c == '\r' ? ' ' : c);
        body_ += '\n';
    }
    const std::string& text() const { return body_; }

private:
    std::string body_;
};

std::string without_line_end(std::string text) {
    while (!text.empty() && text.back() == '\n') text.pop_back();
    return text;
}

}  // namespace

std::string summary(const RenderRecord& record) {
    const RenderReport& report = record.report.value();
    std::string text = fmt::format("{}x{} pixels in {}", record.scene->output.width, record.scene->output.height,
                                   format_duration(report.seconds));
    if (record.region) text = fmt::format("{}x{} of ", record.region->width(), record.region->height()) + text;
    if (report.finished < report.pixels) text += fmt::format(", {} finished", percent(report.finished, report.pixels));
    if (!record.scene->camera.rays)
        text +=
            fmt::format(", {} within an error of {:g}", percent(report.within_error, report.pixels), record.scene->render.error);
    return text;
}

std::vector<std::string> statistics(const RenderRecord& record) {
    std::vector<std::string> lines;
    lines.push_back(fmt::format("instruction set {}", kernel_level()));
    lines.push_back(fmt::format("{} plugins opened, {} passed over", record.plugins.size(), record.plugins_passed_over));
    lines.push_back(
        fmt::format("modules opened: {}; passed over: {}", list(record.modules.opened), list(record.modules.passed_over)));
    if (record.world) {
        lines.push_back(world_line(*record.world));
        lines.push_back("features: " + record.world->features.describe());
    }
    if (record.report) {
        lines.push_back(fmt::format("{} samples, {:.1f} a pixel", record.report->samples,
                                    share(record.report->samples, record.report->pixels)));
        add_trace(record.report->trace, lines);
        lines.push_back(fmt::format("traced in {:.1f} ms of processor time", 1e3 * record.report->processor_seconds));
        if (record.report->first_view)
            lines.push_back(fmt::format("first view after {:.1f} ms",
                                        1e3 * (record.stages.seconds_before("render") + *record.report->first_view)));
    }
    if (record.stopped_after) lines.push_back(fmt::format("stopped within {:.1f} ms", 1e3 * *record.stopped_after));
    for (const Stage& stage : record.stages.all())
        lines.push_back(fmt::format("{:<8} {:9.1f} ms, {:.1f} ms of processor time", stage.name, 1e3 * stage.seconds,
                                    1e3 * stage.processor_seconds));
    return lines;
}

std::string log_text(const RenderRecord& record, const std::vector<Message>& messages) {
    Comment comment;
    comment.title("Lapidary " LAPIDARY_VERSION ", " + fmt::format("{:%F %T} UTC", fmt::gmtime(std::time(nullptr))));
    comment.line(command_line(record.words));
    if (record.report) {
        comment.title(record.report->complete ? "Picture" : "Picture, interrupted");
        comment.line(summary(record));
        if (record.region)
            comment.line(fmt::format("only the region {},{},{},{}", record.region->x0, record.region->y0, record.region->x1,
                                     record.region->y1));
        for (const auto& picture : record.pictures) comment.line(picture.string());
    }
    comment.title("Files");
    for (const std::string& file : record.files) comment.line(file);
    comment.title("Plugins");
    for (const Plugin* plugin : record.plugins)
        comment.line(fmt::format("{} {}: {}", name_of(plugin->kind()), plugin->keyword(), plugin->file().string()));
    comment.title("Messages");
    for (const Message& message : messages) comment.line(without_line_end(message.format()));
    comment.title("Statistics");
    for (const std::string& line : statistics(record)) comment.line(line);
    if (!record.scene) return comment.text();
    comment.title("Scene, as it was understood");
    return comment.text() + "\n" + print_scene(*record.scene);
}

}  // namespace lapidary
