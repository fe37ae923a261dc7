// SPDX-License-Identifier: MIT
#include "apps/lapidary/logarithmic_chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace lapidary {

namespace {

using Point = LogarithmicChart::Point;
using Line = LogarithmicChart::Line;

// The drawing area and its margins, in pixels.
constexpr double left = 80, top = 50, width = 520, height = 360, right = 20, bottom = 60;

bool is_drawable(const Point& point) { return std::isfinite(point.x) && std::isfinite(point.y) && point.x > 0 && point.y > 0; }

// From values to pixels, along one axis.
class Axis {
public:
    Axis(double begin, double end) : begin_(begin), end_(end) {}

    // A tenth of a decade is left free at either end.
    void include(double value) {
        lowest_ = std::min(lowest_, std::log10(value) - 0.1);
        highest_ = std::max(highest_, std::log10(value) + 0.1);
    }
    double position(double value) const {
        return begin_ + (std::log10(value) - lowest_) / (highest_ - lowest_) * (end_ - begin_);
    }

    struct Mark {
        double value;
        bool is_labelled;
    };
    // 1, 2, 3 … 10, 20, 30 …, as far as they lie on the axis. Powers of ten are labelled; where the axis holds fewer than
    // two of them, twos and fives are, too.
    std::vector<Mark> marks() const {
        std::vector<Mark> marks;
        if (!(lowest_ < highest_)) return marks;
        const bool is_short = std::floor(highest_) - std::ceil(lowest_) < 1;
        for (double decade = std::floor(lowest_); decade <= highest_; ++decade)
            for (int digit = 1; digit < 10; ++digit) {
                const double exponent = decade + std::log10(digit);
                if (exponent < lowest_ || exponent > highest_) continue;
                const bool is_labelled = digit == 1 || (is_short && (digit == 2 || digit == 5));
                marks.push_back({digit * std::pow(10, decade), is_labelled});
            }
        return marks;
    }

private:
    double begin_, end_;
    double lowest_ = std::numeric_limits<double>::infinity(), highest_ = -std::numeric_limits<double>::infinity();
};

std::string escaped(const std::string& text) {
    std::string safe;
    for (const char c : text) {
        if (c == '<')
            safe += "&lt;";
        else if (c == '&')
            safe += "&amp;";
        else
            safe += c;
    }
    return safe;
}

class Drawing {
public:
    explicit Drawing(const LogarithmicChart& chart) : chart_(chart) {
        for (const Line& line : chart.lines)
            for (const Point& point : line.points)
                if (is_drawable(point)) x_.include(point.x), y_.include(point.y);
    }

    std::string svg() {
        svg_ = fmt::format(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" height=\"{1}\" "
            "font-family=\"sans-serif\" font-size=\"13\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n",
            left + width + right, top + height + bottom);
        text(left + width / 2, top - 20, "middle", chart_.title);
        draw_grid();
        for (const Line& line : chart_.lines) draw(line);
        draw_legend();
        return svg_ + "</svg>\n";
    }

private:
    void text(double x, double y, const char* anchor, const std::string& words, const std::string& more = "") {
        svg_ +=
            fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\"{}>{}</text>\n", x, y, anchor, more, escaped(words));
    }
    void stroke(double x0, double y0, double x1, double y1, const std::string& style) {
        svg_ += fmt::format("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" {}/>\n", x0, y0, x1, y1, style);
    }

    void draw_grid() {
        const auto style = [](const Axis::Mark& mark) {
            return fmt::format("stroke=\"{}\"", mark.is_labelled ? "#bbb" : "#eee");
        };
        for (const Axis::Mark& mark : x_.marks()) {
            const double x = x_.position(mark.value);
            stroke(x, top, x, top + height, style(mark));
            if (mark.is_labelled) text(x, top + height + 20, "middle", fmt::format("{:g}", mark.value));
        }
        for (const Axis::Mark& mark : y_.marks()) {
            const double y = y_.position(mark.value);
            stroke(left, y, left + width, y, style(mark));
            if (mark.is_labelled) text(left - 8, y + 4, "end", fmt::format("{:g}", mark.value));
        }
        svg_ += fmt::format("<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"none\" stroke=\"#444\"/>\n", left, top,
                            width, height);
        text(left + width / 2, top + height + 45, "middle", chart_.x_label);
        const double middle = top + height / 2;
        text(20, middle, "middle", chart_.y_label, fmt::format(" transform=\"rotate(-90 20 {})\"", middle));
    }

    static std::string style_of(const Line& line) {
        return fmt::format("stroke=\"{}\" stroke-width=\"2\"{}", line.colour, line.dashed ? " stroke-dasharray=\"6 4\"" : "");
    }

    void draw(const Line& line) {
        std::string path, dots;
        for (const Point& point : line.points) {
            if (!is_drawable(point)) continue;
            const double x = x_.position(point.x), y = y_.position(point.y);
            path += fmt::format("{}{:.1f},{:.1f}", path.empty() ? "" : " ", x, y);
            dots += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3\" fill=\"{}\"/>\n", x, y, line.colour);
        }
        if (path.empty()) return;
        svg_ += fmt::format("<polyline points=\"{}\" fill=\"none\" {}/>\n", path, style_of(line)) + dots;
    }

    void draw_legend() {
        double y = top + 20;
        for (const Line& line : chart_.lines) {
            stroke(left + width - 40, y - 4, left + width - 12, y - 4, style_of(line));
            text(left + width - 48, y, "end", line.name);
            y += 20;
        }
    }

    const LogarithmicChart& chart_;
    Axis x_{left, left + width}, y_{top + height, top};
    std::string svg_;
};

}  // namespace

std::string LogarithmicChart::to_svg() const { return Drawing(*this).svg(); }

}  // namespace lapidary
