// SPDX-License-Identifier: MIT
//
// T46: a random walk in a closed room, a box less many boxes that tile its cavity. Whatever the room's size and place, no ray
// gets out, none meets anything but the cavity's wall, and all find themselves in the cell that the face before them says.
#include <algorithm>
#include <array>
#include <cmath>

#include "kernel/csg/ray_through_world.h"
#include "stress/exact.h"
#include "support/measurement.h"
#include "support/solids.h"
#include "support/traced_scene.h"

namespace lapidary::test {
namespace {

struct Setting {
    double size, offset;
};

struct Cell {
    std::array<double, 3> low{0, 0, 0}, high{1, 1, 1};
};

// The unit cube cut into boxes at random places.
std::vector<Cell> cut(std::mt19937_64& random, std::size_t count) {
    std::uniform_real_distribution<double> uniform(0.2, 0.8);
    std::vector<Cell> cells(1);
    while (cells.size() < count) {
        Cell& cell = cells[random() % cells.size()];
        const std::size_t axis = random() % 3;
        Cell other = cell;
        cell.high[axis] = other.low[axis] = cell.low[axis] + uniform(random) * (cell.high[axis] - cell.low[axis]);
        cells.push_back(other);
    }
    return cells;
}

class Room {
public:
    Room(unsigned seed, const Setting& setting) : maker_(seed), setting_(setting) {
        std::vector<SceneNodePtr> pieces;
        for (const Cell& cell : cut(maker_.random, 31)) pieces.push_back(box(cell));
        auto all = std::make_shared<SceneNode>();
        all->operation = Operation::union_;
        all->operands = {maker_.combine(Operation::subtraction,
                                        {box({{-1, -1, -1}, {2, 2, 2}}), maker_.combine(Operation::union_, std::move(pieces))})};
        Scene scene;
        scene.root = all;
        Messages messages;
        world_ = prepare_world(scene, messages);
    }

    const World& world() const { return *world_; }

    // Where the cavity's middle is, and a point of it by its coordinates in the unit cube.
    Point middle() const {
        const double m = setting_.offset + 0.5 * setting_.size;
        return {m, m, m};
    }
    // How far a place is from the cavity's wall, in the room's size.
    double from_wall(const TwoPartPoint& p) const {
        const auto place = [&](double anchor, double offset) { return ((anchor - setting_.offset) + offset) / setting_.size; };
        double inside = infinity;
        for (double c : {place(p.anchor.x, p.offset.x), place(p.anchor.y, p.offset.y), place(p.anchor.z, p.offset.z)})
            inside = std::min({inside, c, 1 - c});
        return std::fabs(inside);
    }

private:
    SceneNodePtr box(const Cell& cell) {
        Factors factors = maker_.there_and_back(2);
        std::array<double, 3> half{}, middle{};
        for (std::size_t i = 0; i < 3; ++i) {
            half[i] = setting_.size * (cell.high[i] - cell.low[i]) / 2;
            middle[i] = setting_.size * (cell.high[i] + cell.low[i]) / 2;
        }
        factors.push_back(scale(half[0], half[1], half[2]));
        factors.push_back(translate(middle[0], middle[1], middle[2]));
        factors.push_back(translate(setting_.offset, setting_.offset, setting_.offset));
        return maker_.leaf("cube", factors);
    }

    SolidMaker maker_;
    Setting setting_;
    std::shared_ptr<const World> world_;
};

// A bounce off a face into a random direction of its open side, as secondary rays depart.
Ray bounce(const FaceHit& face, const Vector& arrived, Random& random) {
    const Vector outward = to_vector(face.normal);
    const Vector toward_viewer = dot(outward, arrived) > 0 ? -outward : outward;
    Vector direction = random.direction();
    if (dot(direction, toward_viewer) < 0) direction = -direction;
    Ray ray{face.point, direction, {}, {}};
    ray.departure = {face.leaf, face.surface_class, false, Departure::no_cell};
    ray.departure.inward = dot(direction, face.class_flipped ? -outward : outward) < 0;
    return ray;
}

void walk(int bounces) {
    const Setting setting =
        GENERATE(Setting{1, 0}, Setting{1, 1e6}, Setting{1e-6, 0}, Setting{1e-6, 1e3}, Setting{1e-6, 1e6}, Setting{1e6, 1e9});
    CAPTURE(setting.size, setting.offset);
    // Faces closer together than this count as one: the wall may stand off by as much.
    const double told_apart = 1e-9 + 128 * u * (setting.offset + 3 * setting.size) / setting.size;
    Measurement leaks({"T46", "rays out of a closed room", "", 0}),
        walls({"T46", "hits beside its wall", "of what is told apart", 1}),
        cells({"T46", "first cells that disagree", "of rays", 1e-6});
    const Room room(11, setting);
    TraceStatistics statistics;
    RayThroughWorld through(room.world(), statistics);
    Random random(12);
    const auto fresh = [&] {
        Ray ray{room.middle(), random.direction(), {}, {}};
        ray.departure.cell = Departure::no_cell;
        return ray;
    };
    Ray ray = fresh();
    for (int i = 0; i < bounces; ++i) {
        const Boundary boundary = leaks.timed([&] {
            through.start(ray);
            return through.next(0, {});
        });
        const bool stays = boundary.t < infinity && boundary.leaf >= 0;
        leaks.expect(stays);
        if (!stays) {
            ray = fresh();
            continue;
        }
        const FaceHit face = through.face(boundary);
        walls.record(room.from_wall(face.point) / told_apart);
        ray = bounce(face, ray.direction, random);
    }
    cells.record(static_cast<double>(statistics.first_cell_disagreements) / bounces);
}

}  // namespace

TEST_CASE("T46: no ray leaves a closed room, wherever it stands") { walk(3000); }

TEST_CASE("T46: a ray that finds itself in another cell is counted, and only rays from an edge do") {
    // A box of mirrors on a mirror, both turned: on the edge between them rounding decides which one a ray is sent from.
    const std::string mirrors = "material { solid { reflection(1); } } ";
    const std::string text = "render { depth(3); } lights { ambient { } } objects { halfspace { " + mirrors +
                             "transform { rotz(0.4); } } cube { " + mirrors + "transform { translate(1, 1, 0); rotz(0.4); } } }";
    const double c = std::cos(0.4), s = std::sin(0.4);
    const auto turned = [&](const Vector& v) { return Vector{c * v.x - s * v.y, s * v.x + c * v.y, v.z}; };
    Random random(13);
    TracedScene at_edge(text), beside(text);
    constexpr int rays = 5000;
    for (int i = 0; i < rays; ++i) {
        const Vector direction = turned({random.uniform(0.2, 1), -random.uniform(0.3, 1), random.uniform(-0.5, 0.5)});
        const Vector edge{0, 0, random.uniform(-0.5, 0.5)};
        at_edge.sample(to_point(turned(edge) - 3 * direction), direction);
        beside.sample(to_point(turned(edge - Vector{random.uniform(1e-6, 2), 0, 0}) - 3 * direction), direction);
    }
    CHECK(at_edge.statistics().first_cell_disagreements > 0);
    Measurement cells({"T46", "first cells that disagree beside an edge", "of rays", 0});
    CHECK(beside.statistics().mirrored_rays >= rays);
    cells.record(static_cast<double>(beside.statistics().first_cell_disagreements) /
                 static_cast<double>(beside.statistics().mirrored_rays));
}

TEST_CASE("T46: no ray leaves a closed room in ten million", "[.long]") { walk(10000000 / 6); }

}  // namespace lapidary::test
