// SPDX-License-Identifier: MIT
//
// window: shows the picture while it grows.
//
// Everything of SDL happens in one thread, which owns the window and answers keys: Escape, q or closing stop the
// render (or end the show, when it is over), s saves what is there as a PNG file, + and - change the exposure, and the
// title tells the pixel under the mouse. The renderer's threads only copy finished tiles into a canvas and go on.
// A window that is taken away (destroyed by another program, the display gone) is as good as one that was closed.

#include <SDL.h>
#include <lapidary/image_library.h>
#include <lapidary/plugin.h>
#include <lapidary/save_bytes.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstdlib>
#include <future>
#include <mutex>
#include <span>
#include <stdexcept>
#include <thread>

#include "x11_window.h"

namespace lapidary {

namespace {

using Clock = std::chrono::steady_clock;

std::string decimal(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.4g", value);
    return text;
}

// The picture as it is shown: 8-bit sRGB, four bytes a pixel, blue first.
struct Shown {
    int width = 0, height = 0;
    std::vector<std::uint8_t> bytes;
};

PixelRegion bounds(const PixelRegion& a, const PixelRegion& b) {
    if (a.is_empty() || b.is_empty()) return a.is_empty() ? b : a;
    return {std::min(a.x0, b.x0), std::min(a.y0, b.y0), std::max(a.x1, b.x1), std::max(a.y1, b.y1)};
}

// What the renderer has given so far: linear colours, how they are shown, and what each pixel shows.
class Canvas {
public:
    void resize(const FrameInfo& info) {
        const std::scoped_lock lock(mutex_);
        shown_.width = info.width, shown_.height = info.height;
        const std::size_t pixels = static_cast<std::size_t>(info.width) * static_cast<std::size_t>(info.height);
        colours_.assign(pixels, {});
        shown_.bytes.assign(4 * pixels, 0);
        contents_.clear();
        legend_ = info.legend;
        changed_ = whole();
        to_come_ = static_cast<long>(info.region.width()) * info.region.height();
    }

    void take(const Frame& frame, const PixelRegion& region) {
        const std::scoped_lock lock(mutex_);
        for (int y = region.y0; y < region.y1; ++y) {
            const std::span<const float> row = frame.row(Layer::colour, region.x0, region.x1, y);
            for (std::size_t i = 0, pixel = index(region.x0, y); i < row.size(); i += 3, ++pixel)
                colours_[pixel] = {row[i], row[i + 1], row[i + 2]};
            encode(index(region.x0, y), index(region.x1, y));
            // A coarse first view tells of no objects.
            if (to_come_ <= 0) take_contents(frame, region.x0, region.x1, y);
        }
        changed_ = bounds(changed_, region);
        if (to_come_ <= 0) return;
        to_come_ -= static_cast<long>(region.width()) * region.height();
        if (to_come_ <= 0) first_view_.notify_one();
    }

    // Until a first view of the whole picture is there, but no longer than that.
    void wait_for_first_view(std::chrono::milliseconds longest) {
        std::unique_lock lock(mutex_);
        const bool is_there = to_come_ <= 0;
        first_view_.wait_for(lock, longest, [&] { return !is_there && to_come_ <= 0; });
    }
    bool has_first_view() const {
        const std::scoped_lock lock(mutex_);
        return to_come_ <= 0;
    }

    void expose(double exposure) {
        const std::scoped_lock lock(mutex_);
        exposure_ = static_cast<float>(exposure);
        encode(0, colours_.size());
        changed_ = whole();
    }

    // Gives what has changed since the last call to show(picture, region); false where that is nothing.
    template <class Use>
    bool give_changes(Use&& show) {
        const std::scoped_lock lock(mutex_);
        const PixelRegion region = std::exchange(changed_, {});
        if (!region.is_empty()) show(shown_, region);
        return !region.is_empty();
    }

    Shown shown() const {
        const std::scoped_lock lock(mutex_);
        return shown_;
    }

    // What a pixel shows: "1 0.5 0.2, object ball, material red".
    std::string describe(int x, int y) const {
        const std::scoped_lock lock(mutex_);
        if (x < 0 || y < 0 || x >= shown_.width || y >= shown_.height) return "";
        const auto& [r, g, b] = colours_[index(x, y)];
        const std::string colour = decimal(r) + " " + decimal(g) + " " + decimal(b);
        if (!legend_) return colour;
        const Content content = contents_.empty() ? Content{} : contents_[index(x, y)];
        return colour + ", object " + name(legend_->objects, content.object) + ", material " +
               name(legend_->materials, content.material);
    }

private:
    struct Content {
        std::int32_t object = 0, material = 0;
    };

    PixelRegion whole() const { return {0, 0, shown_.width, shown_.height}; }
    std::size_t index(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(shown_.width) + static_cast<std::size_t>(x);
    }

    // As soon as there are some: coarse views need not wait for their memory.
    void take_contents(const Frame& frame, int x0, int x1, int y) {
        if (!frame.has(Layer::object) || !frame.has(Layer::material)) return;
        const auto objects = frame.row(Layer::object, x0, x1, y), materials = frame.row(Layer::material, x0, x1, y);
        for (std::size_t i = 0, pixel = index(x0, y); i < objects.size(); ++i, ++pixel) {
            const Content content{static_cast<std::int32_t>(objects[i]), static_cast<std::int32_t>(materials[i])};
            if (contents_.empty() && content.object == 0 && content.material == 0) continue;
            contents_.resize(colours_.size());
            contents_[pixel] = content;
        }
    }

    static const std::string& name(const std::vector<std::string>& names, int number) {
        return names[number >= 0 && static_cast<std::size_t>(number) < names.size() ? static_cast<std::size_t>(number) : 0];
    }

    // Pixels first to last. Where one is like the one before it, as in coarse views, it is shown alike.
    void encode(std::size_t first, std::size_t last) {
        for (std::size_t pixel = first; pixel < last; ++pixel) {
            std::uint8_t* const bytes = &shown_.bytes[4 * pixel];
            if (pixel > first && colours_[pixel] == colours_[pixel - 1]) {
                std::copy_n(bytes - 4, 4, bytes);
                continue;
            }
            const auto& [r, g, b] = colours_[pixel];
            bytes[0] = encoded(b), bytes[1] = encoded(g), bytes[2] = encoded(r), bytes[3] = 255;
        }
    }

    // By a table: the eye does not see the difference to the curve itself, and the whole picture is shown often.
    std::uint8_t encoded(float linear) const {
        constexpr int steps = 4096;
        static const auto table = [] {
            std::array<std::uint8_t, steps + 1> t{};
            for (int i = 0; i <= steps; ++i)
                t[static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(std::lround(255 * srgb_encode(i / double{steps})));
            return t;
        }();
        const float value = exposure_ * linear;
        if (!(value > 0)) return 0;
        return table[static_cast<std::size_t>(std::min(value, 1.0f) * steps + 0.5f)];
    }

    mutable std::mutex mutex_;
    std::vector<std::array<float, 3>> colours_;
    std::vector<Content> contents_;  // empty until there are some
    Shown shown_;
    float exposure_ = 1;
    std::shared_ptr<const Legend> legend_;
    PixelRegion changed_;  // since it was given last
    long to_come_ = 0;     // pixels of the first view
    std::condition_variable first_view_;
};

// What goes wrong in SDL is a sentence.
[[noreturn]] void fail(const char* what) { throw std::runtime_error(std::string(what) + ": " + SDL_GetError()); }

template <class T, void (*destroy)(T*)>
struct Destroy {
    void operator()(T* thing) const { destroy(thing); }
};
using SdlWindow = std::unique_ptr<SDL_Window, Destroy<SDL_Window, SDL_DestroyWindow>>;
using SdlRenderer = std::unique_ptr<SDL_Renderer, Destroy<SDL_Renderer, SDL_DestroyRenderer>>;
using SdlTexture = std::unique_ptr<SDL_Texture, Destroy<SDL_Texture, SDL_DestroyTexture>>;

// SDL while it is in use. The program handles signals itself.
struct Sdl {
    Sdl() {
        SDL_SetHint(SDL_HINT_NO_SIGNAL_HANDLERS, "1");
        SDL_SetHint(SDL_HINT_VIDEO_ALLOW_SCREENSAVER, "1");
        // A picture is shown a few times a second: that is no work, and no graphics driver has to be loaded for it.
        SDL_SetHint(SDL_HINT_FRAMEBUFFER_ACCELERATION, "0");
        // Not what SDL draws where nobody sees it; SDL_VIDEODRIVER still knows better.
        const char* const wayland = std::getenv("WAYLAND_DISPLAY");
        SDL_SetHint(SDL_HINT_VIDEODRIVER, wayland && *wayland ? "wayland,x11" : "x11");
        // SDL's own handler ends the program, and so does the one that Xlib has.
        survive_x11_errors();
        if (SDL_InitSubSystem(SDL_INIT_VIDEO) != 0) fail("there is no display");
        survive_x11_errors();
    }
    ~Sdl() {
        if (!is_taken_away) SDL_QuitSubSystem(SDL_INIT_VIDEO);
    }
    Sdl(const Sdl&) = delete;
    Sdl& operator=(const Sdl&) = delete;

    // The window is not ours any more. Then nothing is given back: SDL would wait for the server's answers about it.
    std::atomic<bool> is_taken_away = false;
};

// Lives in the thread that shows it.
class Show {
public:
    Show(Sdl& sdl, Canvas& canvas, const FrameInfo& info, bool full_screen) : sdl_(sdl), canvas_(canvas), title_(info.title) {
        const Uint32 flags = SDL_WINDOW_RESIZABLE | static_cast<Uint32>(full_screen ? SDL_WINDOW_FULLSCREEN_DESKTOP : 0);
        const auto [width, height] = fitting_size(info);
        window_.reset(SDL_CreateWindow(title_.c_str(), SDL_WINDOWPOS_CENTERED, SDL_WINDOWPOS_CENTERED, width, height, flags));
        if (!window_) fail("no window can be opened");
        renderer_.reset(SDL_CreateRenderer(window_.get(), -1, SDL_RENDERER_SOFTWARE));
        if (!renderer_) fail("nothing can be drawn into a window");
        survive_the_end_of_x11(window_.get(), sdl_.is_taken_away);
    }
    ~Show() {
        if (!sdl_.is_taken_away) return;
        static_cast<void>(texture_.release());
        static_cast<void>(renderer_.release());
        static_cast<void>(window_.release());
    }
    Show(const Show&) = delete;
    Show& operator=(const Show&) = delete;

    // Handles what has happened within a short time, and shows what is new. False: the user wants no more.
    //
    // SDL could wait, too, but wakes itself by messages to the window on a second connection to the display: one that comes
    // after the window's end is an error, and one after the display's end is the end of the program.
    bool step(const std::string& progress) {
        canvas_.wait_for_first_view(std::chrono::milliseconds(10));
        SDL_Event event;
        while (SDL_PollEvent(&event) == 1)
            if (!handle(event)) return false;
        if (sdl_.is_taken_away) return false;
        draw();
        show_title(progress);
        return true;
    }

private:
    // As large as the picture, where the display has room for that.
    static std::pair<int, int> fitting_size(const FrameInfo& info) {
        SDL_Rect usable{0, 0, info.width, info.height};
        SDL_GetDisplayUsableBounds(0, &usable);
        const double scale = std::min({1.0, double(usable.w) / info.width, double(usable.h) / info.height});
        return {std::max(1, int(info.width * scale)), std::max(1, int(info.height * scale))};
    }

    bool handle(const SDL_Event& event) {
        switch (event.type) {
            case SDL_QUIT:
                return false;
            case SDL_MOUSEMOTION:
                mouse_ = {event.motion.x, event.motion.y};
                break;
            case SDL_WINDOWEVENT:
                if (event.window.event == SDL_WINDOWEVENT_LEAVE) mouse_.reset();
                uncovered_ = true;
                break;
            case SDL_KEYDOWN:
                return press(event.key.keysym.sym);
            case SDL_SYSWMEVENT:
                if (is_destruction(event, window_.get())) sdl_.is_taken_away = true;
                break;
            default:
                break;
        }
        return true;
    }

    bool press(SDL_Keycode key) {
        switch (key) {
            case SDLK_ESCAPE:
            case SDLK_q:
                return false;
            case SDLK_s:
                save();
                break;
            case SDLK_PLUS:
            case SDLK_EQUALS:
            case SDLK_KP_PLUS:
                expose(+1);
                break;
            case SDLK_MINUS:
            case SDLK_KP_MINUS:
                expose(-1);
                break;
            default:
                break;
        }
        return true;
    }

    // In steps of half a stop.
    void expose(int steps) {
        half_stops_ += steps;
        canvas_.expose(std::exp2(0.5 * half_stops_));
    }

    // At most a fifth of the time, so that showing a large picture does not hold up making it.
    void draw() {
        const auto begin = Clock::now();
        if (begin < next_draw_) return;
        // Parts of it are worth showing only where the whole lets wait for itself.
        if (begin < show_parts_from_ && !canvas_.has_first_view()) return;
        const bool is_new = canvas_.give_changes([this](const Shown& shown, const PixelRegion& region) { load(shown, region); });
        if (!is_new && !std::exchange(uncovered_, false)) return;
        SDL_RenderClear(renderer_.get());
        SDL_RenderCopy(renderer_.get(), texture_.get(), nullptr, nullptr);
        SDL_RenderPresent(renderer_.get());
        const auto end = Clock::now();
        next_draw_ = end + 4 * (end - begin);
    }

    void load(const Shown& shown, const PixelRegion& region) {
        if (!texture_ || texture_width_ != shown.width || texture_height_ != shown.height) {
            texture_width_ = shown.width, texture_height_ = shown.height;
            texture_.reset(SDL_CreateTexture(renderer_.get(), SDL_PIXELFORMAT_ARGB8888, SDL_TEXTUREACCESS_STREAMING,
                                             texture_width_, texture_height_));
            if (!texture_) fail("the picture cannot be shown");
            SDL_RenderSetLogicalSize(renderer_.get(), texture_width_, texture_height_);
        }
        const SDL_Rect rectangle{region.x0, region.y0, region.width(), region.height()};
        const std::size_t first =
            static_cast<std::size_t>(region.y0) * static_cast<std::size_t>(shown.width) + static_cast<std::size_t>(region.x0);
        SDL_UpdateTexture(texture_.get(), &rectangle, &shown.bytes[4 * first], 4 * shown.width);
    }

    // The picture as it is shown, under the next free name.
    void save() {
        const Shown shown = canvas_.shown();
        Picture picture;
        picture.format = "png";
        picture.width = picture.full_width = shown.width, picture.height = picture.full_height = shown.height;
        picture.channels = {{"R"}, {"G"}, {"B"}};
        picture.linear = false;
        std::vector<std::uint8_t> samples;
        for (std::size_t i = 0; i < shown.bytes.size(); i += 4)
            samples.insert(samples.end(), {shown.bytes[i + 2], shown.bytes[i + 1], shown.bytes[i]});
        picture.samples = std::move(samples);
        std::filesystem::path file;
        for (int n = 1; file.empty() || std::filesystem::exists(file); ++n) file = title_ + "-" + std::to_string(n) + ".png";
        try {
            save_bytes(load_image_library()->encode(picture), file);
            remark_ = "saved " + file.string();
        } catch (const std::exception& error) {
            remark_ = file.string() + " cannot be written: " + error.what();
        }
    }

    void show_title(const std::string& progress) {
        std::string title = title_ + progress;
        if (half_stops_ != 0) title += ", exposure " + std::string(half_stops_ > 0 ? "+" : "") + decimal(0.5 * half_stops_);
        if (mouse_)
            if (const std::string pixel = canvas_.describe(mouse_->first, mouse_->second); !pixel.empty())
                title += ", " + std::to_string(mouse_->first) + "," + std::to_string(mouse_->second) + ": " + pixel;
        if (!remark_.empty()) title += ", " + remark_;
        if (title == shown_title_) return;
        shown_title_ = title;
        SDL_SetWindowTitle(window_.get(), title.c_str());
    }

    Sdl& sdl_;
    Canvas& canvas_;
    std::string title_, shown_title_, remark_;
    SdlWindow window_;
    SdlRenderer renderer_;
    SdlTexture texture_;
    int texture_width_ = 0, texture_height_ = 0;
    bool uncovered_ = false;  // something of it, by another window
    Clock::time_point next_draw_, show_parts_from_ = Clock::now() + std::chrono::milliseconds(100);
    int half_stops_ = 0;
    std::optional<std::pair<int, int>> mouse_;
};

}  // namespace

class Window final : public Output {
public:
    static void describe(Schema<Window>& schema) {
        schema.summary("Shows the picture while it grows.");
        schema.add("full_screen", &Window::full_screen_, {"no", "yes"}).help("Fill the whole screen.");
    }

    ~Window() override {
        closing_ = true;
        if (thread_.joinable()) thread_.join();
    }

    LayerSet layers() const override { return {Layer::object, Layer::material}; }

    // Throws where there is no display.
    void begin(const FrameInfo& info) override {
        progress_ = 0, seconds_ = 0;
        begin_ = Clock::now();
        if (thread_.joinable()) return canvas_.resize(info);  // the same window for the next picture
        // Why it could not be opened, as text: an exception would be released by two threads.
        std::promise<std::string> opened;
        std::future<std::string> result = opened.get_future();
        thread_ = std::thread([this, info, promise = std::move(opened)]() mutable { run(info, promise); });
        canvas_.resize(info);  // large pictures take as long as the opening
        if (const std::string reason = result.get(); !reason.empty()) throw std::runtime_error(reason);
    }

    void tile(const Frame& frame, const PixelRegion& region) override {
        canvas_.take(frame, region);
        progress_ = frame.progress();
        seconds_ = std::chrono::duration<double>(Clock::now() - begin_).count();
    }

    void finish(const Frame& frame, const FrameInfo& info, const std::filesystem::path&) override { tile(frame, info.region); }

    bool wants_to_stop() const override { return stopped_; }
    bool stays_open() const override { return thread_.joinable() && !stopped_; }

private:
    void run(const FrameInfo& info, std::promise<std::string>& opened) {
        bool is_open = false;
        try {
            Sdl sdl;
            Show show(sdl, canvas_, info, full_screen_ == Choice::yes);
            is_open = true;
            opened.set_value("");
            while (!closing_ && show.step(progress())) continue;
            stopped_ = true;  // before SDL has put everything away
        } catch (const std::exception& error) {
            // A window that fails later is as good as one that was closed.
            if (!is_open) opened.set_value(error.what());
        }
        stopped_ = true;
    }

    std::string progress() const {
        const double done = progress_, seconds = seconds_;
        if (done >= 1) return "";
        const std::string percent = ", " + std::to_string(static_cast<int>(100 * done)) + " %";
        // As fast as up to now; too early, nobody knows.
        return done > 0 && seconds > 1 ? percent + ", " + duration(seconds * (1 - done) / done) + " left" : percent;
    }

    static std::string duration(double seconds) {
        const double minutes = std::ceil(seconds / 60);
        if (seconds <= 60) return std::to_string(static_cast<int>(std::ceil(seconds))) + " s";
        return minutes < 1e6 ? std::to_string(static_cast<int>(minutes)) + " min" : "a long time";
    }

    enum class Choice { no, yes };
    Choice full_screen_ = Choice::no;

    Canvas canvas_;
    Clock::time_point begin_;
    std::atomic<double> progress_{0}, seconds_{0};  // of the render: how much of it is done, how long it has taken for that
    std::atomic<bool> closing_{false}, stopped_{false};
    std::thread thread_;
};

LAPIDARY_PLUGIN(Window)

}  // namespace lapidary
