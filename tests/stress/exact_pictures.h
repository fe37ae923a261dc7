// SPDX-License-Identifier: MIT
//
// What the pictures of scenes/precision must show: closed forms in 200-bit arithmetic, pixel by pixel, on the numbers as they
// are written. They know nothing of the renderer.
#pragma once

#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "stress/exact.h"

namespace lapidary::test {

// Which of a scene's colours a pixel shows.
enum class Shown { background, first, second };

// Where a line runs inside something convex.
struct ExactSpan {
    Exact in, out;
    bool is_empty() const { return !(in < out); }
};

class ExactPicture {
public:
    struct View {
        ExactVector eye;
        Exact width;  // of the screen, which stands about the world's origin and is 4:3
    };

    // One of "flush", "abutting" and "speck".
    ExactPicture(const std::string& scene, int width, int height) : width_(width), height_(height) {
        struct Description {
            View view;
            Shown (*shown)(const ExactVector&, const ExactVector&);
        };
        const View box{{1.25, 1.5, -4.5}, 4.75}, speck{{0, 0, -1}, Exact("4e-6")};
        const std::map<std::string, Description> scenes{
            {"flush", {box, shown_of_flush}}, {"abutting", {box, shown_of_abutting}}, {"speck", {speck, shown_of_speck}}};
        const Description& description = scenes.at(scene);
        shown_ = description.shown;
        eye_ = description.view.eye;
        forward_ = {-eye_.x, -eye_.y, -eye_.z};
        // right = y × forward, up = forward × right.
        right_ = with_length({forward_.z, 0, -forward_.x}, description.view.width);
        up_ = with_length({forward_.y * right_.z - forward_.z * right_.y, forward_.z * right_.x - forward_.x * right_.z,
                           forward_.x * right_.y - forward_.y * right_.x},
                          description.view.width * 3 / 4);
    }

    // Nothing where the answer changes within a millionth of a pixel: there rounding may decide.
    std::optional<Shown> at(int column, int row) const {
        const Exact x = Exact(column) + 0.5, y = Exact(row) + 0.5, little = 1e-6;
        const Shown middle = at(x, y);
        for (int side : {-1, 1})
            if (at(x + side * little, y) != middle || at(x, y + side * little) != middle) return {};
        return middle;
    }

private:
    static ExactVector with_length(const ExactVector& v, const Exact& length) {
        const Exact factor = length / sqrt(dot(v, v));
        return {factor * v.x, factor * v.y, factor * v.z};
    }

    // A place in pixels from the top left.
    Shown at(const Exact& x, const Exact& y) const {
        const ExactVector across = test::at(forward_, right_, x / width_ - 0.5);
        return shown_(eye_, test::at(across, up_, Exact(0.5) - y / height_));
    }

    static ExactSpan box(const ExactVector& o, const ExactVector& d, const ExactVector& low, const ExactVector& high) {
        ExactSpan span{-1e300, 1e300};
        const auto slab = [&](const Exact& from, const Exact& pace, const Exact& below, const Exact& above) {
            if (pace == 0) {
                if (from <= below || from >= above) span = {1, -1};
                return;
            }
            const Exact a = (below - from) / pace, b = (above - from) / pace;
            span = {std::max(span.in, std::min(a, b)), std::min(span.out, std::max(a, b))};
        };
        slab(o.x, d.x, low.x, high.x);
        slab(o.y, d.y, low.y, high.y);
        slab(o.z, d.z, low.z, high.z);
        return span;
    }

    // Where a t^2 + 2 b t + c < 0.
    static ExactSpan between_roots(const Exact& a, const Exact& b, const Exact& c) {
        const Exact discriminant = b * b - a * c;
        if (discriminant <= 0) return {1, -1};
        const Exact root = sqrt(discriminant);
        return {(-b - root) / a, (-b + root) / a};
    }

    // Through the hole one sees its wall, or out of its other end.
    static Shown shown_of_flush(const ExactVector& o, const ExactVector& d) {
        const ExactSpan solid = box(o, d, {-1, -1, -1}, {1, 1, 1});
        if (solid.is_empty()) return Shown::background;
        const ExactSpan slab = box(o, d, {-1e300, -1e300, -1}, {1e300, 1e300, 1});
        const ExactSpan tube = between_roots(d.x * d.x + d.y * d.y, o.x * d.x + o.y * d.y, o.x * o.x + o.y * o.y - Exact(9) / 16);
        const ExactSpan hole{std::max(slab.in, tube.in), std::min(slab.out, tube.out)};
        if (hole.is_empty() || solid.in < hole.in) return Shown::first;
        return hole.out < solid.out ? Shown::second : Shown::background;
    }

    static Shown shown_of_abutting(const ExactVector& o, const ExactVector& d) {
        const ExactSpan whole = box(o, d, {-1, -1, -1}, {0, 1, 1}), rest = box(o, d, {0, -1, -1}, {1, 0, 1});
        if (whole.is_empty() && rest.is_empty()) return Shown::background;
        if (whole.is_empty() || rest.is_empty()) return rest.is_empty() ? Shown::first : Shown::second;
        return whole.in < rest.in ? Shown::first : Shown::second;
    }

    static Shown shown_of_speck(const ExactVector& o, const ExactVector& d) {
        const Exact radius("1e-6");
        return between_roots(dot(d, d), dot(o, d), dot(o, o) - radius * radius).is_empty() ? Shown::background : Shown::first;
    }

    int width_, height_;
    Shown (*shown_)(const ExactVector&, const ExactVector&) = nullptr;
    ExactVector eye_{0, 0, 0}, forward_{0, 0, 0}, right_{0, 0, 0}, up_{0, 0, 0};
};

}  // namespace lapidary::test
