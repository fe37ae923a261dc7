// SPDX-License-Identifier: MIT
//
// The frame: layers that were asked for, and progress that never falls.

#include "kernel/render/frame.h"

#include <set>
#include <string_view>

#include "support/catch.h"

using namespace lapidary;

TEST_CASE("colour is always kept, other layers only where asked for") {
    const Frame plain(4, 3, {});
    CHECK(plain.has(Layer::colour));
    CHECK_FALSE(plain.has(Layer::depth));
    const Frame frame(4, 3, {Layer::normal});
    CHECK(frame.has(Layer::colour));
    CHECK(frame.has(Layer::normal));
    CHECK(frame.layer(Layer::normal).size() == 36);
    CHECK(frame.layer(Layer::depth).empty());
}

TEST_CASE("layers have names of their own") {
    std::set<std::string_view> names;
    for (int i = 0; i < layer_count; ++i) names.insert(name_of(static_cast<Layer>(i)));
    CHECK(names.size() == layer_count);
    CHECK(channels_of(Layer::colour) == 3);
    CHECK(channels_of(Layer::depth) == 1);
}

TEST_CASE("a pixel is its own stretch of the layer, row by row") {
    Frame frame(4, 3, {});
    frame.pixel(Layer::colour, 1, 2)[1] = 5;
    CHECK(frame.layer(Layer::colour)[(2 * 4 + 1) * 3 + 1] == 5);
}

TEST_CASE("progress never falls and never passes the end") {
    Frame frame(4, 3, {});
    frame.raise_progress(0.5);
    frame.raise_progress(0.25);
    CHECK(frame.progress() == 0.5);
    frame.raise_progress(7);
    CHECK(frame.progress() == 1);
}
