// SPDX-License-Identifier: MIT
//
// Beams of camera rays: no box that a ray meets is lost, and those far beside all rays are.
#include "kernel/math/beam.h"

#include <random>

#include "kernel/prepare/hierarchy.h"
#include "kernel/render/camera_rays.h"
#include "support/catch.h"

using namespace lapidary;

namespace {

using Corner = std::array<float, 3>;

struct RelativeBox {
    Corner low, high;
};

// Around a point, given relative to an anchor as hierarchies do.
RelativeBox box_around(const Point& middle, double half, const Point& anchor) {
    const Vector at = middle - anchor;
    const auto below = [](double x) { return std::nextafter(static_cast<float>(x), -INFINITY); };
    const auto above = [](double x) { return std::nextafter(static_cast<float>(x), INFINITY); };
    return {{below(at.x - half), below(at.y - half), below(at.z - half)},
            {above(at.x + half), above(at.y + half), above(at.z + half)}};
}

double reach_of(const RelativeBox& box) {
    double reach = 0;
    for (std::size_t i = 0; i < 3; ++i)
        reach = std::fmax(reach, std::fmax(std::fabs(double{box.low[i]}), std::fabs(double{box.high[i]})));
    return 2 * reach;
}

struct Random {
    std::mt19937 engine;
    unsigned operator()() { return static_cast<unsigned>(engine()); }
    double number(double low, double high) { return std::uniform_real_distribution<double>(low, high)(engine); }
    Vector vector() {
        const double x = number(-1, 1), y = number(-1, 1), z = number(-1, 1);
        return {x, y, z};
    }

    // From a place within `size` of the origin, anywhere.
    Camera view_from_within(double size) {
        Camera view;
        view.location = to_point(size * vector());
        view.screen_centre = view.location + vector();
        view.angle = std::pow(10, number(-9, 0));
        return view;
    }
};

constexpr int columns = 640, rows = 480;

// The beam of a block of 8 x 8 pixels of any view, and a ray through the middle of a pixel of some quarter of it, one at the edge
// of the quarter at times.
struct Block {
    explicit Block(Random& random)
        : size(std::pow(10, random.number(-6, 6))), view(random.view_from_within(size)), camera(view, columns, rows) {
        const double x0 = std::floor(random.number(0, 600)), y0 = std::floor(random.number(0, 440));
        beam = camera.beam(x0 + 0.5, y0 + 0.5, x0 + 7.5, y0 + 7.5).value();
        quarter = random() % 4;
        ray = camera.ray(x0 + (quarter & 1) * 4.0 + random() % 4 + 0.5, y0 + (quarter & 2) * 2.0 + random() % 4 + 0.5);
        distance = size * std::pow(10, random.number(-6, 3));
        met = view.location + distance * ray.direction;
        anchor = view.location + distance * random.number(0, 2) * random.vector();
    }
    double size;
    Camera view;
    CameraRays camera;
    Beam beam;
    unsigned quarter;
    Ray ray;
    double distance;    // from the eye,
    Point met, anchor;  // of a place on the ray
};

}  // namespace

TEST_CASE("A beam meets every box that one of its rays meets, and none deeper than the ray, from any place and at any angle") {
    Random random{std::mt19937(11)};
    int lost = 0, too_deep = 0, deep = 0, beside = 0, kept_beside = 0;
    for (int i = 0; i < 20000; ++i) {
        const double size = std::pow(10, random.number(-6, 6));
        const Camera view = random.view_from_within(size);
        const CameraRays camera(view, columns, rows);
        const double x0 = random.number(0, 600), y0 = random.number(0, 440), width = random.number(0, 40),
                     height = random.number(0, 40);
        const auto beam = camera.beam(x0, y0, x0 + width, y0 + height);
        REQUIRE(beam);

        const double x = x0 + width * (random() % 3) / 2, y = y0 + height * (random() % 3) / 2;  // also at corners and edges
        const Ray ray = camera.ray(x, y);
        const double distance = size * std::pow(10, random.number(-6, 3));
        const Point met = view.location + distance * ray.direction;
        const Point anchor = view.location + (distance * random.number(0, 2)) * random.vector();
        const RelativeBox box = box_around(met, random.number(0, 0.01) * distance, anchor);
        const BeamAmongBoxes among_boxes(*beam, anchor, reach_of(box));
        lost += !among_boxes.may_meet(box.low, box.high);
        const double depth = DepthInBeam(*beam, anchor, reach_of(box))(box.low, box.high);
        too_deep += depth > distance, deep += depth > 0.5 * distance;

        // A box as far from the beam's rays as they run from the eye.
        const Point aside = met + distance * (random() % 2 ? camera.right() : camera.up());
        const RelativeBox other = box_around(aside, 0.1 * distance, anchor);
        if (*view.angle > 0.3) continue;
        ++beside;
        kept_beside += BeamAmongBoxes(*beam, anchor, reach_of(other)).may_meet(other.low, other.high);
    }
    CHECK(lost == 0);
    CHECK(too_deep == 0);
    CHECK(deep > 10000);
    CHECK(beside > 10000);
    CHECK(kept_beside < beside / 10);  // next to nothing, but where places are far off and rounding has to be allowed for
}

TEST_CASE("A beam and its quarter meet every ball that one of their rays touches, and those aside are left out") {
    Random random{std::mt19937(13)};
    int lost = 0, lost_by_quarter = 0, beside = 0, kept_beside = 0, in_one_quarter = 0;
    for (int i = 0; i < 20000; ++i) {
        const Block block(random);
        const Beam& beam = block.beam;
        // Touched from any side, or straight from beyond a plane: small balls, and some far larger than all else.
        const double radius = block.distance * std::pow(10, random.number(-9, 6));
        const std::array sides{
            -beam.inward[random() % 4], beam.to_right, -beam.to_right, beam.to_top, -beam.to_top, random.vector()};
        const Vector aside = normalize(sides[random() % sides.size()]);
        const double reach = 4 * block.distance;
        const BeamAmongBoxes among_boxes(beam, block.anchor, reach);
        const Ball touched = Ball::around(block.met + radius * aside, radius, block.anchor);
        lost += !among_boxes.may_meet(touched);
        const Corner low{-INFINITY, -INFINITY, -INFINITY}, high{INFINITY, INFINITY, INFINITY};
        const unsigned quarters = QuartersOfBeam(beam, block.anchor, reach).that_may_meet(low, high, touched);
        lost_by_quarter += (quarters & (1u << block.quarter)) == 0;

        // A ball as far from the beam's rays as they run from the eye; and a speck between pixels that are wide beside rounding.
        if (*block.view.angle > 0.3 || *block.view.angle < 1e-2) continue;
        const Vector to_side = random() % 2 ? block.camera.right() : block.camera.up();
        const Ball other = Ball::around(block.met + block.distance * to_side, 0.1 * block.distance, block.anchor);
        const Ball speck = Ball::around(block.met, 0, block.view.location);
        ++beside;
        kept_beside += among_boxes.may_meet(other);
        in_one_quarter += QuartersOfBeam(beam, block.view.location, reach).that_may_meet(low, high, speck) == 1u << block.quarter;
    }
    CHECK(lost == 0);
    CHECK(lost_by_quarter == 0);
    CHECK(beside > 2000);
    CHECK(kept_beside < beside / 10);
    CHECK(in_one_quarter > 0.95 * beside);
}

TEST_CASE("The quarter of a beam that a ray lies in meets every box that the ray meets, and those aside of it are left out") {
    Random random{std::mt19937(12)};
    int lost = 0, narrow = 0, in_one_quarter = 0;
    for (int i = 0; i < 20000; ++i) {
        const Block block(random);
        const RelativeBox box = box_around(block.met, random.number(0, 0.01) * block.distance, block.anchor);
        const unsigned quarters = QuartersOfBeam(block.beam, block.anchor, reach_of(box)).that_may_meet(box.low, box.high);
        lost += (quarters & (1u << block.quarter)) == 0;

        // Pixels that are wide beside the rounding of floats: what is next to nothing lies in one quarter.
        if (*block.view.angle < 1e-2) continue;
        const Point& eye = block.view.location;
        const RelativeBox speck = box_around(block.met, 0, eye);
        ++narrow;
        in_one_quarter +=
            QuartersOfBeam(block.beam, eye, reach_of(speck)).that_may_meet(speck.low, speck.high) == 1u << block.quarter;
    }
    CHECK(lost == 0);
    CHECK(narrow > 3000);
    CHECK(in_one_quarter > 0.95 * narrow);
}

TEST_CASE("A beam runs away from no endless box that one of its rays comes into, and from most that none does") {
    Random random{std::mt19937(13)};
    int lost = 0, missed_by_all = 0, left_behind = 0;
    for (int i = 0; i < 20000; ++i) {
        const double size = std::pow(10, random.number(-6, 6));
        const Camera view = random.view_from_within(size);
        const CameraRays camera(view, columns, rows);
        const double x0 = random.number(0, 600), y0 = random.number(0, 440), width = random.number(0, 40),
                     height = random.number(0, 40);
        const auto beam = camera.beam(x0, y0, x0 + width, y0 + height);
        REQUIRE(beam);

        // What is on one side of a plane across an axis, near the eye or far from it; the beam may run along the plane.
        double Point::*const at = std::array{&Point::x, &Point::y, &Point::z}[random() % 3];
        double Vector::*const along = at == &Point::x ? &Vector::x : at == &Point::y ? &Vector::y : &Vector::z;
        const double side = view.location.*at + size * std::pow(10, random.number(-12, 3)) * (random() % 2 ? 1 : -1);
        const bool is_above = random() % 2;
        Bounds box = Bounds::everything();
        Point& corner = is_above ? box.low : box.high;
        corner.*at = side;

        bool meets = is_above ? view.location.*at >= side : view.location.*at <= side;
        for (const double right : {0.0, 0.5, 1.0})
            for (const double down : {0.0, 0.5, 1.0}) {
                const double pace = camera.ray(x0 + width * right, y0 + height * down).direction.*along;
                meets |= is_above ? pace > 0 : pace < 0;
            }
        const bool runs_away = beam->runs_away_from(box);
        lost += meets && runs_away;
        missed_by_all += !meets, left_behind += runs_away;
    }
    CHECK(lost == 0);
    CHECK(missed_by_all > 4000);
    CHECK(left_behind > 0.95 * missed_by_all);
}

TEST_CASE("There is no beam through a lens, nor of parallel rays") {
    Camera lens;
    lens.aperture = 0.1, lens.points = 0;
    CHECK_FALSE(CameraRays(lens, 64, 48).beam(0, 0, 8, 8));
    Camera parallel;
    parallel.projection = Camera::Projection::orthographic;
    CHECK_FALSE(CameraRays(parallel, 64, 48).beam(0, 0, 8, 8));
}
