// SPDX-License-Identifier: MIT
//
// Errors by numbers of samples: how fast they fall, and how many samples an error takes.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <map>
#include <string>

namespace lapidary::test {

struct ErrorLadder {
    std::map<int, double> rmse;  // by samples a pixel

    // The a of RMSE ~ n^-a, by least squares over the logarithms.
    double exponent(int from, int to) const {
        double n = 0, x = 0, y = 0, xx = 0, xy = 0;
        for (const auto& [samples, error] : rmse) {
            if (samples < from || samples > to) continue;
            const double u = std::log(samples), v = std::log(error);
            n += 1, x += u, y += v, xx += u * u, xy += u * v;
        }
        return -(n * xy - x * y) / (n * xx - x * x);
    }

    // "4:0.031 8:0.018 …"
    std::string steps() const {
        std::string text;
        for (const auto& [samples, error] : rmse) text += fmt::format(" {}:{:.2g}", samples, error);
        return text;
    }

    // How many samples have this error.
    double samples_for(double error) const {
        auto after = rmse.begin();
        while (std::next(after, 2) != rmse.end() && std::next(after)->second > error) ++after;
        const auto& [n0, e0] = *after;
        const auto& [n1, e1] = *std::next(after);
        const double part = (std::log(e0) - std::log(error)) / (std::log(e0) - std::log(e1));
        return n0 * std::pow(static_cast<double>(n1) / n0, part);
    }
};

}  // namespace lapidary::test
