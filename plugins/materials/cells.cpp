// SPDX-License-Identifier: MIT
//
// cells: space divided among scattered seeds (Worley's cells, crackle): every point belongs to the seed nearest to it, and
// the cells are dealt at random to any number of materials.
//
// There is one seed in every unit cube of the lattice, somewhere in it. Cells are convex, with flat faces: between
// two seeds a and b runs the plane on which both are equally far. Along the line o + t d it is met at
//
//     t = ((a + b)/2 - o).(b - a) / d.(b - a).

#include <lapidary/plugin.h>

namespace lapidary {

namespace {

// SplitMix64's finisher: every bit of the result depends on every bit of x.
std::uint64_t scramble(std::uint64_t x) {
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9;
    x = (x ^ (x >> 27)) * 0x94d049bb133111eb;
    return x ^ (x >> 31);
}

struct Seed {
    Point point;
    std::uint64_t hash = 0;

    bool operator==(const Seed& other) const { return hash == other.hash && point == other.point; }
};

struct Nearest {
    Seed seed;
    double distance_squared = infinity, second_squared = infinity;  // of the nearest and of the next
};

}  // namespace

class Cells final : public Selection<Cells> {
public:
    static void describe(Schema<Cells>& schema) {
        schema.summary("Irregular cells about scattered seeds, dealt at random to any number of materials.");
        schema.add("jitter", &Cells::jitter_)
            .between(0, 1)
            .help("How far seeds may lie from the middles of unit cubes; 0: the cells are these cubes.");
        schema.children("children", &Cells::children_).help("The materials; each cell gets one of them.");
    }

    std::int64_t choose(const Point& p) const { return child_of(nearest(p).seed); }

    // From cell to cell until the material changes.
    Crossing next_cut(const MaterialLine& line, double from, double to) const {
        if (children_.size() < 2 || !(length_squared(line.direction) > 0)) return {};
        Seed here = nearest(line.at(from)).seed;
        for (int cells = 0; cells < most_cells && from < to; ++cells) {
            Seed next = here;
            const double t = leave(line, here, next, from, to);
            if (!(t < to)) return {};
            if (t > from && child_of(here) != child_of(next)) return {t, Normal(next.point - here.point)};
            from = std::fmax(from, t);
            here = next;
        }
        return {};
    }

    // A step of length s changes either distance by no more than s.
    double clearance_of_cuts(const Point& p) const {
        const Nearest n = nearest(p);
        return (std::fmin(std::sqrt(n.second_squared), surely_searched) - std::sqrt(n.distance_squared)) / 2;
    }

    const std::vector<Child>& children() const { return children_; }

private:
    // Two neighbours in three have different materials even where there are only a few; a line that finds none in so
    // many cells is taken to meet none.
    static constexpr int most_cells = 4096;
    // Seeds nearer than this are at most two lattice cubes away.
    static constexpr double surely_searched = 2;

    // Where the line leaves the cell of `here`, and the cell it comes to. No cell reaches farther than sqrt(3) from its
    // seed, the diagonal of a cube; so the line is out at the end of that ball. Whose cell it is in there gives a plane to
    // cross before; if the line then is in the cell of another seed yet, there is a nearer plane, and so on until none is.
    double leave(const MaterialLine& line, const Seed& here, Seed& next, double from, double to) const {
        double t = std::fmin(to, ball_end(line, here.point));
        for (Seed other = nearest(line.at(t)).seed; !(other == here) && !(other == next); other = nearest(line.at(t)).seed) {
            const Vector way = other.point - here.point;
            const double pace = dot(line.direction, way);
            const Point middle = here.point + 0.5 * way;
            const double crossing = dot(middle - line.origin, way) / pace;
            if (!(pace > 0) || !(crossing < t)) break;
            next = other;
            t = crossing;
            if (t <= from) break;
        }
        return next == here ? infinity : t;
    }

    static double ball_end(const MaterialLine& line, const Point& centre) {
        const Vector o = line.origin - centre;
        const double dd = length_squared(line.direction);
        const double closest = -dot(o, line.direction) / dd;
        const double distance_squared = length_squared(o + closest * line.direction);
        return closest + std::sqrt(std::fmax(0, 3.01 - distance_squared) / dd);
    }

    std::int64_t child_of(const Seed& seed) const { return static_cast<std::int64_t>(seed.hash % children_.size()); }

    Seed seed_in(double x, double y, double z) const {
        const auto bits = [](double cell) {
            return std::fabs(cell) < 0x1p62 ? static_cast<std::uint64_t>(static_cast<std::int64_t>(cell)) : 0;
        };
        std::uint64_t h = scramble(bits(x) + 0x9e3779b97f4a7c15);
        h = scramble(h ^ bits(y));
        h = scramble(h ^ bits(z));
        // Three times 21 bits of the hash, as places from 0 to 1.
        const auto place = [&](int shift) {
            const double unit = static_cast<double>(h >> shift & 0x1fffff) * 0x1p-21;
            return 0.5 + jitter_ * (unit - 0.5);
        };
        return {{x + place(0), y + place(21), z + place(42)}, scramble(h)};
    }

    // The seed of the point's own cube lies within sqrt(3), so no farther than two cubes away need be looked at,
    // and of these only where the cube itself comes near enough.
    Nearest nearest(const Point& p) const {
        const double x = std::floor(p.x), y = std::floor(p.y), z = std::floor(p.z);
        Nearest found;
        const auto look = [&](int i, int j, int k) {
            const Seed seed = seed_in(x + i, y + j, z + k);
            const double distance_squared = length_squared(p - seed.point);
            if (distance_squared < found.distance_squared) {
                found = {seed, distance_squared, found.distance_squared};
            } else if (distance_squared < found.second_squared) {
                found.second_squared = distance_squared;
            }
        };
        const auto gap_squared = [](double c, double cell, int i) {
            const double gap = i > 0 ? cell + i - c : i < 0 ? c - (cell + i + 1) : 0;
            return gap * gap;
        };
        static constexpr int from_the_middle[5] = {0, -1, 1, -2, 2};
        for (int k : from_the_middle)
            for (int j : from_the_middle) {
                const double gap = gap_squared(p.z, z, k) + gap_squared(p.y, y, j);
                if (gap > found.second_squared) continue;
                for (int i : from_the_middle)
                    if (gap + gap_squared(p.x, x, i) <= found.second_squared) look(i, j, k);
            }
        return found;
    }

    double jitter_ = 1;
    std::vector<Child> children_;
};

LAPIDARY_PLUGIN(Cells)

}  // namespace lapidary
