// SPDX-License-Identifier: MIT
//
// lapidary scene: from the scene file to the pictures.
#include <fmt/format.h>

#include <algorithm>
#include <condition_variable>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <thread>
#include <tuple>

#include "apps/lapidary/command_line.h"
#include "apps/lapidary/console.h"
#include "apps/lapidary/displays.h"
#include "apps/lapidary/file_watch.h"
#include "apps/lapidary/interruption.h"
#include "apps/lapidary/legend.h"
#include "apps/lapidary/picture_files.h"
#include "apps/lapidary/preparation.h"
#include "apps/lapidary/render_record.h"
#include "apps/lapidary/replace_file.h"
#include "apps/lapidary/session.h"
#include "kernel/prepare/world.h"
#include "kernel/render/render.h"
#include "kernel/scene/print.h"
#include "lapidary/save_bytes.h"

namespace lapidary {

namespace {

// Looks after the renderer from the side, every few milliseconds: shows the progress, and stops the work when an output
// wants to, or when a file that it is made from was saved.
class Watch {
public:
    Watch(const Frame& frame, const std::vector<PictureFile>& pictures, std::optional<FileWatch>& files, Console& console)
        : thread_([this, &frame, &pictures, &files, &console] {
              std::unique_lock lock(mutex_);
              while (!done_.wait_for(lock, std::chrono::milliseconds(10), [this] { return over_; })) {
                  for (const PictureFile& picture : pictures)
                      if (picture.output->wants_to_stop()) Interruption::request();
                  if (files && files->changed()) Interruption::request();
                  console.show_progress(frame.progress());
              }
          }) {}

    ~Watch() {
        {
            const std::scoped_lock lock(mutex_);
            over_ = true;
        }
        done_.notify_one();
        thread_.join();
    }
    Watch(const Watch&) = delete;
    Watch& operator=(const Watch&) = delete;

private:
    std::mutex mutex_;
    std::condition_variable done_;
    bool over_ = false;
    std::thread thread_;
};

// What stays from one render to the next.
struct Kept {
    std::map<std::string, std::shared_ptr<Output>> displays;  // what shows the pictures, by keyword
    std::set<std::string> files;                              // that the scene is made from, as far as is known
};

// All that are there for the opening.
std::size_t count_plugins(const Registry& registry) {
    std::size_t count = 0;
    for (const PluginKind kind : {PluginKind::object, PluginKind::material, PluginKind::light, PluginKind::output})
        count += registry.keywords(kind).size();
    return count;
}

// To release a scene of many objects one by one takes longer than to trace it; the end of the process releases all at once.
template <class... T>
void keep_until_exit(T... things) {
    static const auto* const kept = new std::tuple<T...>(std::move(things)...);
    static_cast<void>(kept);
}

class RenderCommand {
public:
    RenderCommand(const RenderArguments& arguments, const Words& words, Kept& kept)
        : arguments_(arguments), kept_(kept), console_({!arguments.no_warnings, arguments.verbose || arguments.parse_only}) {
        console_.listen_to(messages_);
        record_.words = words;
    }

    ExitCode run() {
        record_.stages.begin("load");
        auto kept_session = std::make_unique<Session>(arguments_.scene, messages_);
        Session& session = *kept_session;
        // Before they are read.
        kept_.files.insert(arguments_.scene.file.string());
        if (arguments_.watch) watch(kept_.files);
        session.load();
        record_.files = session.files();
        if (arguments_.watch) watch(record_.files);
        const ExitCode code = carry_out(session);
        messages_.finish();
        record_.stages.end();
        record_.plugins = session.registry().opened();
        record_.plugins_passed_over = count_plugins(session.registry()) - record_.plugins.size();
        record_.modules = modules();
        keep_files(code);
        if (was_saved()) return code;
        if (code == ExitCode::success || code == ExitCode::interrupted) tell();
        if (arguments_.log) write_log();
        if (code == ExitCode::success && !arguments_.watch && (arguments_.hold || console_.is_terminal())) wait_for_viewer();
        if (!arguments_.watch) keep_until_exit(std::move(kept_session), record_.scene, record_.world);
        return code;
    }

    // Waits until one of the scene's files is saved. False: the user wants no more.
    bool wait_until_saved() {
        Interruption::listen();
        if (was_saved() && !Interruption::signalled()) return true;
        console_.say("waiting until " + arguments_.scene.file.string() + " is saved");
        const auto is_closed = [](const auto& display) { return display.second->wants_to_stop(); };
        while (!was_saved()) {
            if (Interruption::signalled() || std::ranges::any_of(kept_.displays, is_closed)) return false;
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
        }
        return true;
    }

private:
    template <class Files>
    void watch(const Files& files) {
        if (!saved_) saved_.emplace();
        for (const std::string& file : files) saved_->add(file);
    }
    bool was_saved() { return saved_ && saved_->changed(); }

    // A scene with errors may be one whose included file is missing for a moment.
    void keep_files(ExitCode code) {
        if (code != ExitCode::scene) kept_.files.clear();
        kept_.files.insert(record_.files.begin(), record_.files.end());
    }

    // A window that is open shows the next picture, too.
    void keep_displays() {
        for (PictureFile& picture : pictures_)
            if (picture.path.empty())
                picture.output = kept_.displays.emplace(picture.plugin->keyword(), picture.output).first->second;
    }

    ExitCode carry_out(Session& session) {
        record_.stages.begin("build");
        const auto scene = session.build();
        if (!scene) return ExitCode::scene;
        pictures_ = choose_pictures(*scene, session.registry(), {arguments_.name.value_or(""), arguments_.formats}, messages_);
        if (messages_.has_errors()) return ExitCode::output;
        choose_displays(pictures_, session.registry(), {arguments_.no_window, arguments_.full_screen, arguments_.preview},
                        messages_);
        keep_displays();
        record_.scene = as_rendered(*scene);
        return arguments_.parse_only ? show_scene() : make_pictures(*record_.scene, session);
    }

    // The scene with the command line's wishes, as it goes into the log.
    std::shared_ptr<const Scene> as_rendered(Scene scene) const {
        if (arguments_.error) {
            scene.render.error = *arguments_.error;
            scene.camera.rays.reset();
        }
        if (arguments_.time) scene.camera.rays.reset();
        if (arguments_.samples) scene.camera.rays = arguments_.samples;
        scene.output.writers.clear();
        for (const PictureFile& picture : pictures_)
            if (!picture.path.empty()) scene.output.writers.push_back({picture.output, picture.plugin, {}});
        return std::make_shared<Scene>(std::move(scene));
    }

    ExitCode show_scene() {
        record_.stages.begin("prepare");
        record_.world = prepare_world(*record_.scene, messages_);
        fmt::print("{}", print_scene(*record_.scene));
        return ExitCode::success;
    }

    int threads(const Session& session) const {
        return arguments_.threads.value_or(session.configurations().threads().value_or(0));
    }

    ExitCode make_pictures(const Scene& scene, Session& session) {
        for (const PictureFile& picture : pictures_)
            if (!picture.path.empty()) require_writable(picture.path);
        if (arguments_.log) require_writable(log_file());

        FrameInfo info = frame_info(scene);
        if (arguments_.region) record_.region = info.region;

        record_.stages.begin("prepare");
        record_.world = prepare_world(scene, messages_, {.threads = threads(session)});
        if (messages_.has_errors()) return ExitCode::scene;
        record_.stages.begin("open");
        if (is_shown()) info.legend = legend_of(*record_.world);
        begin(info);
        Frame frame(info.width, info.height, layers());
        record_.stages.begin("render");
        std::optional<Preparation> preparation(std::in_place, pictures_, is_shown());
        record_.report = render_frame(*record_.world, scene, session, info.region, *preparation, frame);
        if (was_saved()) return ExitCode::interrupted;  // nobody wants this picture any more
        record_.stages.begin("write");
        preparation.reset();
        for (PictureFile& picture : pictures_) finish(picture, frame, info);
        record_.stages.end();
        if (Interruption::requested() && !record_.report->complete) return ExitCode::interrupted;
        if (!record_.report->complete)
            messages_.warning({},
                              "the time was too short to look at every pixel once; the others show what is near, or black: allow "
                              "more with --time");
        return ExitCode::success;
    }

    RenderReport render_frame(const World& world, const Scene& scene, Session& session, const PixelRegion& region,
                              Preparation& preparation, Frame& frame) {
        Interruption::listen();
        RenderOptions options;
        options.threads = threads(session);
        options.region = region;
        options.samples = arguments_.samples;
        options.error = arguments_.error;
        options.time = arguments_.time;
        options.one_by_one = arguments_.one_by_one;
        options.sequence = arguments_.sequence;
        options.preview = is_shown();
        options.cancel = &Interruption::requested();
        options.on_begin = [&preparation] { preparation.begin(); };
        options.on_tile = [this](const Frame& finished, const PixelRegion& tile) {
            for (PictureFile& picture : pictures_) picture.output->tile(finished, tile);
        };
        const Watch watch(frame, pictures_, saved_, console_);
        const RenderReport report = render(world, scene, frame, options);
        if (!report.complete) record_.stopped_after = Interruption::seconds_since_request();
        console_.end_progress();
        return report;
    }

    // What shows the picture may fail; what writes it may not.
    void begin(const FrameInfo& info) {
        std::erase_if(pictures_, [&](const PictureFile& picture) {
            try {
                picture.output->begin(info_for(picture, info));
                return false;
            } catch (const std::exception& error) {
                if (!picture.path.empty())
                    throw OutputError(fmt::format("'{}' cannot be written: {}", picture.path.string(), error.what()));
                messages_.warning({},
                                  fmt::format("{}; the picture is rendered without {}", error.what(), picture.plugin->keyword()));
                return true;
            }
        });
    }

    // Whether somebody looks on while the picture grows.
    bool is_shown() const {
        return std::ranges::any_of(pictures_, [](const PictureFile& picture) { return picture.path.empty(); });
    }

    // Lets the user look at what is shown until it is closed.
    void wait_for_viewer() const {
        const auto is_open = [](const PictureFile& picture) { return picture.output->stays_open(); };
        while (std::ranges::any_of(pictures_, is_open) && !Interruption::requested())
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }

    LayerSet layers() const {
        LayerSet layers;
        for (const PictureFile& picture : pictures_) layers.add(picture.output->layers());
        return layers;
    }

    FrameInfo frame_info(const Scene& scene) const {
        FrameInfo info;
        info.width = scene.output.width, info.height = scene.output.height;
        info.region = arguments_.region.value_or(PixelRegion{0, 0, info.width, info.height});
        if (info.region.x1 > info.width || info.region.y1 > info.height)
            throw UsageError(fmt::format("--region {},{},{},{} reaches beyond the picture of {}x{}; change one of them",
                                         info.region.x0, info.region.y0, info.region.x1, info.region.y1, info.width,
                                         info.height));
        info.title = scene.title;
        info.metadata = {{"Software", "Lapidary " LAPIDARY_VERSION}, {"Scene", arguments_.scene.file.filename().string()}};
        return info;
    }

    static FrameInfo info_for(const PictureFile& picture, FrameInfo info) {
        info.path = picture.path;
        return info;
    }

    void finish(PictureFile& picture, const Frame& frame, const FrameInfo& info) {
        const FrameInfo own = info_for(picture, info);
        if (picture.path.empty()) return picture.output->finish(frame, own, {});
        replace_file(picture.path, [&](const std::filesystem::path& file) { picture.output->finish(frame, own, file); });
        record_.pictures.push_back(picture.path);
    }

    // A line for who looks on; the statistics where they were asked for.
    void tell() {
        if (record_.report && (console_.is_terminal() || arguments_.verbose || !record_.report->complete)) {
            const std::string state = record_.report->complete ? "" : "interrupted: ";
            for (const auto& picture : record_.pictures) console_.say(state + picture.string() + ": " + summary(record_));
        }
        for (const std::string& line : statistics(record_)) console_.remark(line);
    }

    // Beside the first picture: dice.png has dice.log.
    std::filesystem::path log_file() const {
        for (const PictureFile& picture : pictures_)
            if (!picture.path.empty()) return std::filesystem::path(picture.path).replace_extension("log");
        return arguments_.scene.file.stem() += ".log";
    }

    void write_log() {
        const std::string text = log_text(record_, messages_.all());
        replace_file(log_file(), [&](const std::filesystem::path& file) { save_bytes(std::as_bytes(std::span(text)), file); });
        console_.remark("wrote " + log_file().string());
    }

    const RenderArguments& arguments_;
    Kept& kept_;
    Messages messages_;
    Console console_;
    std::vector<PictureFile> pictures_;
    RenderRecord record_;
    std::optional<FileWatch> saved_;  // for --watch
};

// Renders whenever the scene is saved, until the user has seen enough.
ExitCode render_repeatedly(const RenderArguments& arguments, const Words& words) {
    Kept kept;
    for (;;) {
        RenderCommand command(arguments, words, kept);
        const ExitCode code = command.run();
        if (!command.wait_until_saved()) return code;
        Interruption::withdraw();
    }
}

}  // namespace

ExitCode render_command(const Words& words) {
    const auto arguments = parse_render(words);
    if (!arguments) return ExitCode::success;
    if (arguments->watch) return render_repeatedly(*arguments, words);
    Kept kept;
    return RenderCommand(*arguments, words, kept).run();
}

}  // namespace lapidary
