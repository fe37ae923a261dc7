// SPDX-License-Identifier: MIT
//
// lapidary scene: from the scene file to the pictures.
#include <fmt/format.h>

#include <condition_variable>
#include <mutex>
#include <thread>

#include "apps/lapidary/command_line.h"
#include "apps/lapidary/console.h"
#include "apps/lapidary/interruption.h"
#include "apps/lapidary/picture_files.h"
#include "apps/lapidary/replace_file.h"
#include "apps/lapidary/session.h"
#include "apps/lapidary/stages.h"
#include "kernel/prepare/world.h"
#include "kernel/render/render.h"

namespace lapidary {

namespace {

// Looks after the renderer from the side, every few milliseconds: shows the progress, and stops the work when an output
// wants to.
class Watch {
public:
    Watch(const Frame& frame, const PixelRegion& region, const std::vector<PictureFile>& pictures, Console& console)
        : thread_([this, &frame, &pictures, &console, pixels = static_cast<double>(region.width()) * region.height()] {
              std::unique_lock lock(mutex_);
              while (!done_.wait_for(lock, std::chrono::milliseconds(10), [this] { return over_; })) {
                  for (const PictureFile& picture : pictures)
                      if (picture.output->wants_to_stop()) Interruption::request();
                  console.show_progress(static_cast<double>(frame.finished()) / pixels);
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

class RenderCommand {
public:
    explicit RenderCommand(const RenderArguments& arguments)
        : arguments_(arguments), console_({!arguments.no_warnings, arguments.verbose || arguments.parse_only}) {
        console_.listen_to(messages_);
    }

    ExitCode run() {
        const ExitCode code = render_scene();
        stages_.end();
        return code;
    }

private:
    ExitCode render_scene() {
        stages_.begin("load");
        Session session(arguments_.scene, messages_);
        session.load();
        stages_.begin("build");
        const auto scene = session.build();
        if (!scene) return ExitCode::scene;
        if (arguments_.parse_only) {
            prepare_world(*scene, messages_);
            return ExitCode::success;
        }

        pictures_ = choose_pictures(*scene, session.registry(), {arguments_.name.value_or(""), arguments_.formats}, messages_);
        if (messages_.has_errors()) return ExitCode::output;
        for (const PictureFile& picture : pictures_)
            if (!picture.path.empty()) require_writable(picture.path);

        const FrameInfo info = frame_info(*scene);
        Frame frame(info.width, info.height, layers());
        for (PictureFile& picture : pictures_) picture.output->begin(info_for(picture, info));

        stages_.begin("prepare");
        const auto world = prepare_world(*scene, messages_);
        stages_.begin("render");
        const RenderReport report = render_frame(*world, *scene, session, info.region, frame);
        stages_.begin("write");
        for (PictureFile& picture : pictures_) finish(picture, frame, info);
        return report.complete ? ExitCode::success : ExitCode::interrupted;
    }

    RenderReport render_frame(const World& world, const Scene& scene, Session& session, const PixelRegion& region, Frame& frame) {
        Interruption::listen();
        RenderOptions options;
        options.threads = arguments_.threads.value_or(session.configurations().threads().value_or(0));
        options.region = region;
        options.samples = arguments_.samples;
        options.error = arguments_.error;
        options.time = arguments_.time;
        options.cancel = &Interruption::requested();
        options.on_tile = [this](const Frame& finished, const PixelRegion& tile) {
            for (PictureFile& picture : pictures_) picture.output->tile(finished, tile);
        };
        const Watch watch(frame, region, pictures_, console_);
        return render(world, scene, frame, options);
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
        console_.remark(fmt::format("wrote {}", picture.path.string()));
    }

    const RenderArguments& arguments_;
    Messages messages_;
    Console console_;
    Stages stages_;
    std::vector<PictureFile> pictures_;
};

}  // namespace

ExitCode render_command(const Words& words) {
    const auto arguments = parse_render(words);
    return arguments ? RenderCommand(*arguments).run() : ExitCode::success;
}

}  // namespace lapidary
