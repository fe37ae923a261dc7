// SPDX-License-Identifier: MIT
//
// The blocks that describe no object, with their properties declared once for reading and for printing: camera,
// screen, output, render.
#pragma once

#include <numbers>
#include <optional>

#include "kernel/registry/schema.h"
#include "kernel/scene/scene.h"

namespace lapidary {

// Width and height, as one value of two numbers.
struct Extent {
    double width = 0, height = 0;
};

template <>
struct MemberTraits<Extent> {
    static constexpr Shape shape = Shape::number;
    static constexpr int count = 2;
    static Extent from(const Value* v) { return {v[0].number, v[1].number}; }
    static void to(const Extent& m, std::vector<Value>& out) {
        out.push_back(number_value(m.width));
        out.push_back(number_value(m.height));
    }
};

struct ScreenBlock {
    std::optional<Point> location;
    std::optional<Extent> size;

    static void describe(Schema<ScreenBlock>& schema) {
        schema.summary("The window that the picture is seen through.");
        schema.add("location", &ScreenBlock::location).unit(Unit::length).help("Its centre in the world.");
        schema.add("size", &ScreenBlock::size).unit(Unit::length).above(0).arguments("w, h").help("Its width and height.");
    }
};

struct CameraBlock : Camera {
    std::optional<Point> look_at;

    static void describe(Schema<CameraBlock>& schema) {
        schema.summary("Where the picture is seen from.");
        schema.add("projection", &CameraBlock::projection, {"perspective", "orthographic"})
            .help("Rays from a point, or parallel ones.");
        schema.add("location", &CameraBlock::location).unit(Unit::length).help("Where the camera stands.");
        schema.add("look_at", &CameraBlock::look_at).unit(Unit::length).help("A point in the middle of the picture.");
        schema.add("up", &CameraBlock::up).help("The direction that is up in the picture.");
        schema.add("angle", &CameraBlock::angle)
            .unit(Unit::angle)
            .above(0)
            .below(std::numbers::pi)
            .help("Horizontal field of view, instead of the screen's size.");
        schema.add("focus", &CameraBlock::focus).unit(Unit::length).above(0).help("Distance of the plane that is sharp.");
        schema.add("aperture", &CameraBlock::aperture).unit(Unit::length).at_least(0).help("Lens diameter; 0 is a pinhole.");
        schema.add("points", &CameraBlock::points)
            .between(0, greatest_count)
            .help("Lens points calculated beforehand; 0: a new one for every ray.");
        schema.add("rays", &CameraBlock::rays)
            .between(1, greatest_count)
            .help("Rays a pixel; without it, as many as the error asks for.");
    }

    static constexpr double greatest_count = 1 << 20;
};

struct OutputBlock : OutputSettings {
    static constexpr int greatest_side = 65536;
    static constexpr double greatest_area = 1 << 28;  // pixels; 3 GB of colour

    static void describe(Schema<OutputBlock>& schema) {
        schema.summary("The picture's size and the files or windows that it goes to.");
        schema.add("resolution", &OutputBlock::width, &OutputBlock::height)
            .between(1, greatest_side)
            .arguments("w, h")
            .help("Width and height in pixels.");
        schema.add("name", &OutputBlock::name).help("The file; without extension, the writers add theirs.");
        schema.add("encoding", &OutputBlock::encoding_word, {"srgb", "linear"}).help("How 8- and 16-bit writers encode light.");
        schema.require("the picture must have at most 268 million pixels", [](const OutputBlock& output) {
            return static_cast<double>(output.width) * output.height <= greatest_area;
        });
    }

    enum class Encoding { srgb, linear };
    Encoding encoding_word = Encoding::srgb;
};

struct RenderBlock : RenderSettings {
    static void describe(Schema<RenderBlock>& schema) {
        schema.summary("How far the calculation goes.");
        schema.add("depth", &RenderBlock::depth).between(0, 1000).help("Reflections and refractions that a path may have.");
        schema.add("cutoff", &RenderBlock::cutoff)
            .between(0, 1)
            .help("Weight in the pixel below which a path ends; at least a quarter of an error that is asked for.");
        schema.add("error", &RenderBlock::error).above(0).at_most(1).help("Estimated error of a pixel that is good enough.");
        schema.add("filter", &RenderBlock::filter, {"box", "gaussian", "mitchell"}, &RenderBlock::filter_radius)
            .above(0)
            .at_most(16)
            .help("How a pixel weighs the light around its centre, and how many pixels far (each filter has its usual reach).");
    }
};

}  // namespace lapidary
