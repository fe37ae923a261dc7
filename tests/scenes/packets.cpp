// SPDX-License-Identifier: MIT
//
// Packets of rays against one ray at a time: the same bits in every layer, for everything a World can hold.
#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>

#include "kernel/prepare/world.h"
#include "kernel/render/camera_rays.h"
#include "kernel/render/render.h"
#include "kernel/render/tile.h"
#include "kernel/render/tracer.h"
#include "support/catch.h"
#include "support/scenes.h"

using namespace lapidary;

namespace {

bool same_bits(const RaySample& a, const RaySample& b) {
    const auto equal = [](double x, double y) { return std::memcmp(&x, &y, sizeof x) == 0; };
    return equal(a.colour.r, b.colour.r) && equal(a.colour.g, b.colour.g) && equal(a.colour.b, b.colour.b) &&
           equal(a.depth, b.depth) && a.normal == b.normal && a.position == b.position && a.object == b.object &&
           a.material == b.material;
}

constexpr int columns = 131, rows = 97;

Ray ray_of(const CameraRays& camera, int x, int y) {
    Ray ray = camera.ray(x + 0.5, y + 0.5);
    ray.key = sample_key(x, y, 0);
    return ray;
}

// Part by part, as pictures are made: first a tile, then blocks of a size in it; returns how many rays were spared.
std::size_t trace_by_parts(Tracer& tracer, const CameraRays& camera, int block, std::vector<RaySample>& picture) {
    constexpr int tile = tile_size;
    std::size_t spared = 0;
    std::vector<Ray> rays;
    std::vector<RaySample> samples;
    std::vector<std::size_t> places;  // of rays in the picture
    const auto beam_of = [&](int x, int y, int size) {
        return camera.beam(x + 0.5, y + 0.5, std::min(x + size, columns) - 0.5, std::min(y + size, rows) - 0.5);
    };
    for (int y = 0; y < rows; y += block)
        for (int x = 0; x < columns; x += block) {
            const auto of_tile = beam_of(x / tile * tile, y / tile * tile, tile), of_block = beam_of(x, y, block);
            tracer.begin_tile(of_tile ? &*of_tile : nullptr);
            const bool is_whole = x + block <= columns && y + block <= rows;
            const auto known = tracer.begin_part(of_block ? &*of_block : nullptr, is_whole);
            rays.clear(), places.clear();
            for (const PixelPlace& place : places_in_part) {
                const int u = x + place.x, v = y + place.y;
                if (place.x >= block || place.y >= block || u >= columns || v >= rows) continue;
                rays.push_back(ray_of(camera, u, v));
                places.push_back(static_cast<std::size_t>(v) * columns + static_cast<std::size_t>(u));
            }
            samples.assign(rays.size(), RaySample{{}, known.value_or(Colour{})});
            if (!known) tracer.trace(rays, samples);
            spared += known ? rays.size() : 0;
            for (std::size_t i = 0; i < places.size(); ++i) picture[places[i]] = samples[i];
        }
    return spared;
}

// The pixels of a small picture that differ; `spared` counts those of which it was known beforehand that they show the
// background.
int differences(const std::string& text, std::size_t* spared = nullptr) {
    const auto built = test::build(text);
    for (const std::string& line : built->headlines()) UNSCOPED_INFO(line);
    REQUIRE(built->scene);
    Messages messages;
    const auto world = prepare_world(*built->scene, messages);
    const CameraRays camera(built->scene->camera, columns, rows);
    std::vector<Ray> rays;
    for (int y = 0; y < rows; ++y)
        for (int x = 0; x < columns; ++x) rays.push_back(ray_of(camera, x, y));
    std::vector<RaySample> packets(rays.size()), parts(rays.size()), larger_parts(rays.size()), single(rays.size());
    Tracer tracer(*world, built->scene->render, 0.001);
    tracer.trace(rays, packets);
    const std::size_t known = trace_by_parts(tracer, camera, block_size, parts);
    trace_by_parts(tracer, camera, part_size, larger_parts);
    if (spared) *spared = known;
    tracer.trace_one_by_one(true);
    tracer.trace(rays, single);
    int different = 0, met = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        different +=
            !same_bits(packets[i], single[i]) || !same_bits(parts[i], single[i]) || !same_bits(larger_parts[i], single[i]);
        met += single[i].object > 0;
    }
    CHECK(met > columns);  // something is to be seen
    return different;
}

const std::string head = R"(
camera { location(1, 2, -6); look_at(0, 0.2, 0); angle(50deg); rays(1); }
background(0.3, 0.4, 0.6);
lights { ambient { } point { location(-3, 6, -4); intensity(40); } direct { direction(1, -2, 1); }
         spot { location(4, 5, -3); direction(-4, -5, 3); angles(10deg, 30deg); intensity(30); } }
)";

}  // namespace

TEST_CASE("Packets give the bits of single rays: products, with coincident faces and mirrors") {
    CHECK(differences(head + R"(objects {
        halfspace { material { solid { reflection(0.3); } } transform { translate(0, -1, 0); } }
        subtraction { intersection { cube { } sphere { radius(1.4); } }
                      sphere { radius(0.4); colour(0, 0, 0); transform { translate(0, 1.1, 0); } }
                      sphere { radius(0.4); transform { translate(-0.3, 0.2, -1.1); } } cylinder { radius(0.3); } }
        cube { colour(1, 0, 0); transform { scale(0.5); translate(2, -0.5, 0); } }
        cube { colour(0, 1, 0); transform { scale(0.5); translate(3, -0.5, 0); } }
        cone { transform { translate(-2.5, 0, 1); } } })") == 0);
}

TEST_CASE("Rays are spared where nothing is in reach, and only there") {
    const std::string balls =
        "objects { sphere { } subtraction { sphere { } sphere { radius(0.9); } transform { translate(2, 1, 1); } }";
    std::size_t spared = 0;
    CHECK(differences(head + balls + "}", &spared) == 0);
    CHECK(spared > std::size_t{columns} * rows / 4);
    const std::size_t spared_beside_balls = spared;
    CHECK(differences(head + balls + "halfspace { transform { rotx(180deg); translate(0, 5, 0); } } }", &spared) == 0);
    CHECK(spared > 0);  // below the horizon
    CHECK(spared < spared_beside_balls);
    for (const std::string place : {"translate(0, -5, 0);", "rotz(190deg); translate(0, 5, 0);", "translate(0, 50, 0);"}) {
        CHECK(differences(head + balls + "halfspace { transform { " + place + " } } }", &spared) == 0);
        CHECK(spared == 0);
    }
    CHECK(differences(head + balls + "plane { transform { translate(0, -5, 0); } } }", &spared) == 0);
    CHECK(spared == 0);
    const std::string from_inside =
        "camera { location(0, 0, 0); look_at(0.1, 0, 1); angle(100deg); rays(1); } lights { ambient { } }"
        "objects { sphere { material { solid { opacity(0); } } } sphere { transform { scale(0.3); translate(0, 0.4, 3); } } }";
    CHECK(differences(from_inside, &spared) == 0);
    CHECK(spared == 0);
    const std::string from_far =
        "camera { location(1e6, 3, 2e6); look_at(0, 0, 0); angle(0.0002deg); rays(1); } lights { ambient { } }" + balls + "}";
    CHECK(differences(from_far, &spared) == 0);
    CHECK(spared > 0);
    const std::string through_lens =
        "camera { location(1, 2, -6); look_at(0, 0, 0); aperture(0.1); points(0); rays(1); } lights { ambient { } }" + balls +
        "}";
    CHECK(differences(through_lens, &spared) == 0);
    CHECK(spared == 0);
}

TEST_CASE("Packets give the bits of single rays: trees that are no products, rings, sheets and their clips") {
    CHECK(differences(head + R"(objects {
        plane { transform { translate(0, -1, 0); } }
        intersection { plane { colour(1, 1, 0); transform { rotx(1); } } sphere { transform { translate(-2, 0, 0); } } }
        torus { colour(0.4, 0.8, 0.2); transform { rotx(0.7); translate(0.5, 0, -1); } }
        symdiff { sphere { } cube { transform { scale(0.8); translate(0.5, 0.5, 0.5); } } transform { translate(1.5, 0.3, 1); } }
        subtraction { torus { radii(1, 0.4); } } with { union { cube { transform { translate(1, 0, 0); } } torus { } } transform { roty(0.3); } } })") ==
          0);
}

TEST_CASE("Packets give the bits of single rays: needles and pancakes") {
    CHECK(differences(head + R"(objects {
        sphere { colour(0.9, 0.2, 0.1); transform { rotx(0.3); scale(1000, 0.5, 0.001); roty(0.7); } }
        cube { colour(0.2, 0.8, 0.1); transform { scale(0.001, 1, 300); roty(0.4); translate(0.5, 0, 0); } }
        subtraction { cone { transform { scale(1, 100, 0.01); } } sphere { transform { scale(0.5, 1, 0.5); } } } })") == 0);
}

TEST_CASE("Packets give the bits of single rays: a camera inside, and many operands") {
    CHECK(differences(R"(
        camera { location(0, 0, 0); angle(80deg); rays(1); }
        background(0.3, 0.4, 0.6);
        lights { ambient { } point { location(0.1, 0.2, 0.3); intensity(2); } }
        objects { subtraction { sphere { radius(4); } sphere { radius(3); }
                  repeat i (0, 30) { sphere { radius(0.4); transform { translate(3 * cos(i), 0.1 * i - 1.5, 3 * sin(i)); } } } }
                  sphere { radius(0.3); transform { translate(0, 0, 0.2); } } })") == 0);
}

TEST_CASE("Packets give the bits of single rays: lights with extent, textures with relief") {
    CHECK(differences(R"(
        camera { location(0, 1, -5); look_at(0, 0, 0); rays(1); }
        background(0.3, 0.4, 0.6);
        lights { ambient { } point { location(-3, 4, -4); radius(0.5); intensity(30); } direct { direction(1, -1, 1); angle(5deg); } }
        objects { sphere { material { sine { colour(1, 0.5, 0); reflection(0.4); bump(0.3); transform { scale(0.1); } } } }
                  halfspace { material { checkers { solid { reflection(0.5); } solid { colour(0, 0, 0); } } }
                              transform { translate(0, -1, 0); } } })") == 0);
}

TEST_CASE("Packets give the bits of single rays in the opaque scenes that come with the program") {
    for (const char* name : {"first.scene", "dice.scene", "trees.scene", "csg.scene"}) {
        CAPTURE(name);
        std::ifstream file(std::filesystem::path(LAPIDARY_SOURCE_FOLDER) / "scenes" / name);
        std::stringstream text;
        text << file.rdbuf();
        CHECK(differences(text.str()) == 0);
    }
}

TEST_CASE("Packets give the bits of single rays: glass cut, melted, nested and coloured, between mirrors") {
    CHECK(differences(head + R"(render { depth(6); }
        solid glass { refraction(1.5); shininess(60); }
        objects {
        halfspace { material { solid { reflection(0.3); } } transform { translate(0, -1, 0); } }
        cube { size(0.1, 1.5, 2); material { solid { reflection(0.8); } } transform { translate(-2, 0.5, 0); } }
        cube { size(0.1, 1.5, 2); material { solid { reflection(0.8); } } transform { translate(3, 0.5, 0); } }
        subtraction { sphere { } sphere { radius(0.6); transform { translate(0.2, 0.1, 0); } } material { glass; } }
        merge { sphere { radius(0.5); } sphere { radius(0.5); transform { translate(0.5, 0, 0); } }
                material { glass; } transform { translate(1.5, -0.5, 0); } }
        intersection { cube { size(0.5, 0.5, 0.5); } sphere { radius(0.7); } material { solid { refraction(1.3); colour(0.4, 0.9, 0.5); } }
                       transform { roty(0.6); translate(1.2, 0.7, -1); } }
        union { sphere { radius(0.6); material { solid { refraction(1.4); opacity(0.2); reflection(0.1); colour(0.9, 0.5, 0.3); } } }
                sphere { radius(0.3); priority(1); colour(0.9, 0.1, 0.1); } transform { translate(-1, -0.4, -1); } } })") == 0);
}

TEST_CASE(
    "Packets give the bits of single rays: glass that touches, overlaps and hides, with sheets and trees that are no products") {
    CHECK(differences(head + R"(render { depth(5); }
        objects {
        plane { transform { translate(0, -1, 0); } }
        plane { material { solid { refraction(1.2); opacity(0.4); } } transform { rotx(90deg); translate(0, 0, -2); } }
        cube { material { solid { refraction(1.5); } } transform { scale(0.5); } }
        cube { material { solid { refraction(1.3); colour(0.9, 0.9, 1); } } transform { scale(0.5); translate(1, 0, 0); } }
        cube { material { solid { refraction(1.5); } } transform { scale(0.5); translate(0, 1, 0); } }
        sphere { radius(0.3); colour(1, 0, 0); }
        sphere { radius(0.3); colour(1, 1, 0); transform { translate(0.5, 0.5, -0.5); } }
        torus { material { solid { refraction(1.5); shininess(30); } } transform { rotx(0.7); translate(-1.5, 0.5, 0); } }
        symdiff { sphere { } cube { transform { scale(0.8); translate(0.5, 0.5, 0.5); } } material { solid { refraction(1.4); } }
                  transform { scale(0.5); translate(2.2, 0.3, 1); } } })") == 0);
}

TEST_CASE("Packets give the bits of single rays: textured glass under lights with extent") {
    CHECK(differences(R"(
        camera { location(0, 1, -5); look_at(0, 0, 0); rays(1); }
        background(0.3, 0.4, 0.6);
        render { depth(3); }
        lights { ambient { } point { location(-3, 4, -4); radius(0.5); intensity(30); } direct { direction(1, -1, 1); angle(5deg); } }
        objects {
            sphere { material { checkers { solid { refraction(1.5); } solid { refraction(1.2); colour(0.9, 0.6, 0.6); }
                                           transform { scale(0.4); } } } }
            cube { material { noise { solid { refraction(1.3); } solid { colour(0.2, 0.4, 0.9); } solid { refraction(1.3); opacity(0.5); }
                                      transform { scale(0.5); } } } transform { scale(0.5); translate(1.6, 0, 0); } }
            cube { material { sine { refraction(1.4); colour(1, 0.5, 0.2); bump(0.1); transform { scale(0.2); } } }
                   transform { scale(0.5); translate(-1.7, 0, 0); } }
            halfspace { material { checkers { solid { reflection(0.5); } solid { colour(0, 0, 0); } } }
                        transform { translate(0, -1, 0); } } })") == 0);
}

TEST_CASE("Packets give the bits of single rays: a camera in glass, in a sea around a hidden and a shown ball") {
    CHECK(differences(R"(
        camera { location(0, 0, -1.5); angle(80deg); rays(1); }
        background(0.3, 0.4, 0.6);
        render { depth(5); }
        lights { ambient { } point { location(0.1, 2, -3); intensity(9); } }
        objects { halfspace { material { solid { refraction(1.33); colour(0.8, 0.9, 0.95); depth(3); } } transform { translate(0, 0.5, 0); } }
                  sphere { radius(0.5); colour(1, 0, 0); }
                  sphere { radius(0.5); colour(0, 1, 0); priority(1); transform { translate(0.8, 0.3, 0); } }
                  sphere { radius(0.4); material { solid { refraction(1.6); } } priority(2); transform { translate(-0.8, 0.2, 0); } } })") ==
          0);
}

TEST_CASE("Packets give the bits of single rays: faces that let light pass, under a light with extent") {
    CHECK(differences(R"(
        camera { location(0, 1, -5); look_at(0, 0, 0); rays(1); }
        background(0.3, 0.4, 0.6);
        render { depth(4); }
        lights { ambient { } point { location(-3, 4, -4); radius(0.5); intensity(30); } direct { direction(1, -1, 1); } }
        objects {
            sphere { material { solid { refraction(1.5); colour(0.9, 0.6, 0.6); } } }
            sphere { material { solid { refraction(1.5); colour(0.9, 0.6, 0.6); } } transform { translate(0.7, 0.2, -0.3); } }
            cube { material { solid { refraction(1); colour(0.2, 0.4, 0.9); } } transform { scale(0.5); translate(-1.7, 0, 0); } }
            sphere { radius(0.5); material { solid { refraction(1); colour(0.5, 0.9, 0.9); } } transform { translate(-1.2, 0, -0.7); } }
            sphere { radius(0.3); material { checkers { solid { refraction(1.5); } solid { refraction(1.5); colour(0.9, 0.9, 0.2); }
                                             transform { scale(0.1); } } } priority(1); transform { translate(0.3, 0, -0.5); } }
            sphere { radius(0.4); colour(0.9, 0.1, 0.1); transform { translate(-1.2, 0.2, 1); } }
            halfspace { material { checkers { solid { reflection(0.5); } solid { colour(0, 0, 0); } } }
                        transform { translate(0, -1, 0); } } })") == 0);
}

// Rays between the middles of pixels go beyond the tile that asks for them: no solid that stands at its border may be lost.
TEST_CASE("Packets give the bits of single rays: edges that are followed across the borders of tiles") {
    std::mt19937 random(29);
    std::uniform_real_distribution<double> coordinate(-1, 1);
    std::string text = "camera { screen { size(4/3, 1); } } lights { ambient { } point { location(-3, 4, -1); } } objects {";
    for (int i = 0; i < 1500; ++i)
        text += fmt::format("sphere {{ radius(0.02); colour({}, 0.5, 0.5); transform {{ translate({}, {}, {}); }} }}",
                            0.5 + 0.4 * coordinate(random), coordinate(random), coordinate(random), 2 + coordinate(random));
    const auto built = test::build(text + "}");
    REQUIRE(built->scene);
    Messages messages;
    const auto world = prepare_world(*built->scene, messages);
    for (const double error : {0.1, 0.03}) {
        CAPTURE(error);
        const auto picture = [&](bool one_by_one) {
            auto frame = std::make_unique<Frame>(columns, rows, LayerSet{});
            RenderOptions options;
            options.error = error, options.one_by_one = one_by_one;
            CHECK(render(*world, *built->scene, *frame, options).complete);
            return frame;
        };
        const auto of_packets = picture(false), of_single_rays = picture(true);
        CHECK(std::ranges::equal(of_packets->layer(Layer::colour), of_single_rays->layer(Layer::colour)));
    }
}
