// SPDX-License-Identifier: MIT
//
// terminal: draws the picture into a terminal of true colour, for those who look on from afar.
//
// A character cell is about twice as high as wide, so each holds two pixels: the upper half block in the foreground's
// colour, over the background's. A pixel there is the mean of the picture's pixels that fall into it, in linear light.

#include <lapidary/plugin.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>

namespace lapidary {

class Terminal final : public Output {
public:
    static void describe(Schema<Terminal>& schema) {
        schema.summary("Draws the picture in the terminal, in half blocks of true colour.");
        schema.add("columns", &Terminal::columns_).between(1, 1000).help("Characters of a line; without it, as many as fit.");
    }

    void begin(const FrameInfo& info) override {
        width_ = info.width, height_ = info.height;
        pixels_.assign(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_), {});
        is_terminal_ = isatty(STDOUT_FILENO) == 1;
        drawn_rows_ = 0;
        to_come_ = static_cast<long>(info.region.width()) * info.region.height();
        last_ = std::chrono::steady_clock::now();
    }

    void tile(const Frame& frame, const PixelRegion& region) override {
        take(frame, region);
        if (!is_terminal_) return;
        // As soon as there is a first view of all, then from time to time.
        const bool was_incomplete = to_come_ > 0;
        to_come_ -= static_cast<long>(region.width()) * region.height();
        const bool is_whole_now = was_incomplete && to_come_ <= 0;
        if (!is_whole_now && std::chrono::steady_clock::now() - last_ < std::chrono::milliseconds(200)) return;
        draw();
        last_ = std::chrono::steady_clock::now();
    }

    void finish(const Frame& frame, const FrameInfo& info, const std::filesystem::path&) override {
        take(frame, info.region);
        draw();
    }

private:
    using Encoded = std::array<int, 3>;

    std::size_t index(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
    }

    void take(const Frame& frame, const PixelRegion& region) {
        for (int y = region.y0; y < region.y1; ++y)
            for (int x = region.x0; x < region.x1; ++x) {
                const auto rgb = frame.pixel(Layer::colour, x, y);
                pixels_[index(x, y)] = {rgb[0], rgb[1], rgb[2]};
            }
    }

    // How many pixels the drawing has; the height is even.
    std::pair<int, int> drawing_size() const {
        winsize size{};
        const bool known = is_terminal_ && ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 && size.ws_row > 2;
        double columns = columns_.value_or(known ? size.ws_col : 80);
        // The whole picture stays on the screen, with a line below it.
        if (known && !columns_) columns = std::min(columns, 2.0 * (size.ws_row - 2) * width_ / height_);
        columns = std::clamp(columns, 1.0, static_cast<double>(width_));
        const int rows = std::max(1, static_cast<int>(std::lround(columns * height_ / width_ / 2)));
        return {static_cast<int>(columns), 2 * rows};
    }

    // The mean of the picture's pixels that fall into one of the drawing.
    Encoded mean(int x, int y, int columns, int rows) const {
        const auto range = [](int i, int count, int size) {
            const int from = static_cast<int>(static_cast<long>(i) * size / count);
            return std::pair(from, std::max(from + 1, static_cast<int>(static_cast<long>(i + 1) * size / count)));
        };
        const auto [x0, x1] = range(x, columns, width_);
        const auto [y0, y1] = range(y, rows, height_);
        Colour sum;
        for (int v = y0; v < y1; ++v)
            for (int u = x0; u < x1; ++u) {
                const auto& [r, g, b] = pixels_[index(u, v)];
                sum += Colour{r, g, b};
            }
        const Colour colour = 1.0 / ((x1 - x0) * (y1 - y0)) * sum;
        return {encoded(colour.r), encoded(colour.g), encoded(colour.b)};
    }

    static int encoded(double linear) {
        return linear > 0 ? static_cast<int>(std::lround(255 * srgb_encode(std::min(linear, 1.0)))) : 0;
    }

    void draw() {
        const auto [columns, rows] = drawing_size();
        std::string text;
        if (drawn_rows_ > 0) text = "\r\033[K\033[" + std::to_string(drawn_rows_) + "A";
        for (int y = 0; y < rows; y += 2) {
            Encoded foreground{-1, -1, -1}, background = foreground;
            for (int x = 0; x < columns; ++x) {
                set_colour(text, "38", foreground, mean(x, y, columns, rows));
                set_colour(text, "48", background, mean(x, y + 1, columns, rows));
                text += "▀";
            }
            text += "\033[0m\n";
        }
        drawn_rows_ = rows / 2;
        std::fwrite(text.data(), 1, text.size(), stdout);
        std::fflush(stdout);
    }

    // Says only what changes.
    static void set_colour(std::string& text, const char* ground, Encoded& now, const Encoded& wanted) {
        if (now == wanted) return;
        now = wanted;
        text += std::string("\033[") + ground + ";2;" + std::to_string(now[0]) + ";" + std::to_string(now[1]) + ";" +
                std::to_string(now[2]) + "m";
    }

    std::optional<int> columns_;
    int width_ = 0, height_ = 0;
    std::vector<std::array<float, 3>> pixels_;
    long to_come_ = 0;  // pixels of the first view
    bool is_terminal_ = false;
    int drawn_rows_ = 0;
    std::chrono::steady_clock::time_point last_;
};

LAPIDARY_PLUGIN(Terminal)

}  // namespace lapidary
