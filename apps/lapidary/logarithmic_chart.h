// SPDX-License-Identifier: MIT
//
// A chart with two logarithmic axes, as SVG: lines through points, a grid at powers of ten, a legend.
#pragma once

#include <string>
#include <vector>

namespace lapidary {

struct LogarithmicChart {
    struct Point {
        double x = 0, y = 0;  // what is not above 0 has no logarithm and is not drawn
    };
    struct Line {
        std::string name;
        std::string colour;  // as CSS has it
        bool dashed = false;
        std::vector<Point> points;
    };

    std::string title, x_label, y_label;
    std::vector<Line> lines;

    std::string to_svg() const;
};

}  // namespace lapidary
