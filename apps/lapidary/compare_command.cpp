// SPDX-License-Identifier: MIT
//
// lapidary compare: how far two pictures differ, channel value by channel value. Files of whole numbers are compared as
// they are encoded; where only one of the two is, it is first taken back to linear values.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "apps/lapidary/command_line.h"
#include "apps/lapidary/replace_file.h"
#include "kernel/math/colour.h"
#include "lapidary/image_library.h"
#include "lapidary/save_bytes.h"

namespace lapidary {

namespace {

// The channels that both pictures have, as indices into each.
struct CommonChannels {
    std::vector<Picture::Channel> channels;
    std::vector<std::size_t> first, second;
};

CommonChannels common_channels(const Picture& a, const Picture& b) {
    CommonChannels common;
    for (std::size_t i = 0; i < a.channels.size(); ++i)
        for (std::size_t k = 0; k < b.channels.size(); ++k)
            if (a.channels[i].name == b.channels[k].name) {
                common.channels.push_back({a.channels[i].name});
                common.first.push_back(i);
                common.second.push_back(k);
            }
    return common;
}

const std::vector<float>& floats(const Picture& picture) { return std::get<std::vector<float>>(picture.samples); }

void linearise(Picture& picture) {
    for (float& value : std::get<std::vector<float>>(picture.samples)) value = static_cast<float>(srgb_decode(value));
    picture.linear = true;
}

struct Comparison {
    double sum_of_squares = 0, largest = 0;
    std::size_t values = 0, pixels = 0, beyond = 0;
    std::size_t largest_pixel = 0;
    Picture difference;

    double rmse() const { return values ? std::sqrt(sum_of_squares / static_cast<double>(values)) : 0; }
    double share() const { return pixels ? static_cast<double>(beyond) / static_cast<double>(pixels) : 0; }
};

// Equal values do not differ, even where they are infinite (the depth of nothing); a value that is not a number differs
// infinitely from all others.
double distance(float a, float b) {
    if (a == b || (std::isnan(a) && std::isnan(b))) return 0;
    const double d = std::abs(static_cast<double>(a) - static_cast<double>(b));
    return std::isnan(d) ? std::numeric_limits<double>::infinity() : d;
}

Comparison compare(const Picture& a, const Picture& b, double tolerance) {
    const CommonChannels common = common_channels(a, b);
    if (common.channels.empty()) throw std::runtime_error("the pictures have no channel in common");
    Comparison result;
    result.pixels = static_cast<std::size_t>(a.width) * static_cast<std::size_t>(a.height);
    std::vector<float> differences;
    for (std::size_t pixel = 0; pixel < result.pixels; ++pixel) {
        double worst = 0;
        for (std::size_t c = 0; c < common.channels.size(); ++c) {
            const double d = distance(floats(a)[pixel * a.channels.size() + common.first[c]],
                                      floats(b)[pixel * b.channels.size() + common.second[c]]);
            worst = std::max(worst, d);
            result.sum_of_squares += d * d;
            ++result.values;
            differences.push_back(static_cast<float>(d));
        }
        if (worst > tolerance) ++result.beyond;
        if (worst > result.largest) result.largest = worst, result.largest_pixel = pixel;
    }
    result.difference.width = result.difference.full_width = a.width;
    result.difference.height = result.difference.full_height = a.height;
    result.difference.channels = common.channels;
    result.difference.samples = std::move(differences);
    return result;
}

// In linear floats where the name asks for them, otherwise as a PNG of 8 bits.
void write_difference(const ImageLibrary& library, Picture difference, const std::filesystem::path& file) {
    const std::string extension = file.extension().string();
    difference.format = extension == ".exr"   ? "openexr"
                        : extension == ".tga" ? "targa"
                        : extension.empty()   ? "png"
                                              : extension.substr(1);
    if (difference.format != "openexr") {
        std::vector<std::uint8_t> bytes;
        for (const float value : floats(difference))
            bytes.push_back(static_cast<std::uint8_t>(std::lround(255 * std::min(value, 1.0f))));
        difference.samples = std::move(bytes);
    }
    replace_file(file, [&](const std::filesystem::path& beside) { save_bytes(library.encode(difference), beside); });
}

}  // namespace

ExitCode compare_command(const Words& words) {
    const auto arguments = parse_compare(words);
    if (!arguments) return ExitCode::success;
    if (!arguments->difference.empty()) require_writable(arguments->difference);

    const ImageLibrary& library = *load_image_library();
    Picture first = library.decode(arguments->first), second = library.decode(arguments->second);
    if (first.width != second.width || first.height != second.height) {
        fmt::print("different sizes: {}x{} and {}x{}\n", first.width, first.height, second.width, second.height);
        return ExitCode::difference;
    }
    if (first.linear != second.linear) linearise(first.linear ? second : first);

    const Comparison result = compare(first, second, arguments->tolerance);
    fmt::print("RMSE     {:.6g}\n", result.rmse());
    fmt::print("maximum  {:.6g}", result.largest);
    if (result.largest > 0)
        fmt::print(" at pixel {},{}", result.largest_pixel % static_cast<std::size_t>(first.width),
                   result.largest_pixel / static_cast<std::size_t>(first.width));
    fmt::print("\nbeyond {:g}: {} of {} pixels ({:.4g} %)\n", arguments->tolerance, result.beyond, result.pixels,
               100 * result.share());
    if (!arguments->difference.empty()) write_difference(library, result.difference, arguments->difference);

    const bool by_rmse = !arguments->rmse || result.rmse() <= *arguments->rmse;
    // A bound on the mean alone says nothing about single pixels.
    const bool by_share = (arguments->rmse && !arguments->limits_pixels) || result.share() <= arguments->share;
    return by_rmse && by_share ? ExitCode::success : ExitCode::difference;
}

}  // namespace lapidary
