// SPDX-License-Identifier: MIT
#include "kernel/prepare/hierarchy.h"

#include <oneapi/tbb/parallel_invoke.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <tuple>
#include <utility>

#include "kernel/math/outward.h"
#include "kernel/math/standard_arithmetic.h"

namespace lapidary {

namespace {

constexpr std::size_t bin_count = 16;
constexpr std::size_t few = 8;              // so few items are sorted, and every cut between them is tried
constexpr std::size_t worth_a_task = 4096;  // items
constexpr int depth_limit = 100;            // the traversal's stack holds 128 entries; beyond it, cut in the middle

// The low ends, and the high ones with the other sign, so that both grow downward: one instruction includes all six. Two lanes
// mean nothing.
struct alignas(32) Box {
    std::array<float, 8> ends{INFINITY, INFINITY, INFINITY, 0, INFINITY, INFINITY, INFINITY, 0};

    float low(std::size_t axis) const { return ends[axis]; }
    float high(std::size_t axis) const { return -ends[4 + axis]; }
    float width(std::size_t axis) const { return -ends[4 + axis] - ends[axis]; }

    void include(const Box& other) {
        for (std::size_t i = 0; i < ends.size(); ++i) ends[i] = other.ends[i] < ends[i] ? other.ends[i] : ends[i];
    }
    // In double: the squares of very large sizes are beyond a float.
    double half_area() const {
        const double x = width(0), y = width(1), z = width(2);
        return x * y + y * z + z * x;
    }
    std::size_t widest_axis() const {
        std::size_t widest = 0;
        for (const std::size_t axis : {1, 2})
            if (width(axis) > width(widest)) widest = axis;
        return widest;
    }
};

// An item with its box, relative to the anchor and rounded outward. The item's number stands in a lane that means nothing, as
// entries are moved often.
struct Entry {
    Box box;

    std::int32_t item() const { return std::bit_cast<std::int32_t>(box.ends[3]); }
    float twice_centre(std::size_t axis) const { return box.low(axis) + box.high(axis); }
    // The middle, doubled, as a box.
    Box twice_centre() const {
        Box centre;
        for (std::size_t i = 0; i < 4; ++i) {
            const float sum = box.ends[i] - box.ends[4 + i];
            centre.ends[i] = sum, centre.ends[4 + i] = -sum;
        }
        return centre;
    }
};

// Whether floats hold a box.
bool fits_floats(const Bounds& box) {
    constexpr double largest = 1e30;
    const auto fits = [](const Point& p) {
        return std::fabs(p.x) < largest && std::fabs(p.y) < largest && std::fabs(p.z) < largest;
    };
    return fits(box.low) && fits(box.high);
}

Entry make_entry(const Bounds& bounds, const Point& anchor, std::int32_t item) {
    const Vector low = bounds.low - anchor, high = bounds.high - anchor;
    return {{{float_below(low.x), float_below(low.y), float_below(low.z), std::bit_cast<float>(item), float_below(-high.x),
              float_below(-high.y), float_below(-high.z), 0}}};
}

// A number of entries, and the box around them.
struct Part {
    Box box;
    std::size_t count = 0;

    void include(const Entry& entry) {
        box.include(entry.box);
        ++count;
    }
    void include(const Part& other) {
        box.include(other.box);
        count += other.count;
    }
    double cost() const { return box.half_area() * static_cast<double>(count); }
};

Part all_of(std::span<const Entry> entries) {
    Part part;
    for (const Entry& entry : entries) part.include(entry);
    return part;
}

// The box around the middles of entries, doubled.
Box box_of_centres(std::span<const Entry> entries) {
    Box box;
    for (const Entry& entry : entries) box.include(entry.twice_centre());
    return box;
}

// Two neighbouring ranges of entries.
struct Cut {
    std::array<Part, 2> halves;
    std::size_t first_right = 0;  // the bin in which the right one begins
};

// Between which of the bins to cut, the first and last of which hold something: where area times number, left and right, is
// least.
Cut cheapest_cut(std::span<const Part> bins) {
    std::array<Part, bin_count> right;
    Part sum;
    for (std::size_t bin = bins.size() - 1; bin > 0; --bin) {
        sum.include(bins[bin]);
        right[bin] = sum;
    }
    Cut cut;
    double least = infinity;
    sum = Part();
    for (std::size_t bin = 1; bin < bins.size(); ++bin) {
        sum.include(bins[bin - 1]);
        const double cost = sum.cost() + right[bin].cost();
        if (cost < least || bin == 1) {
            least = cost;
            cut = {{sum, right[bin]}, bin};
        }
    }
    return cut;
}

void sort_along(std::size_t axis, std::span<Entry> entries) {
    std::sort(entries.begin(), entries.end(), [axis](const Entry& a, const Entry& b) {
        return std::make_tuple(a.twice_centre(axis), a.item()) < std::make_tuple(b.twice_centre(axis), b.item());
    });
}

// Every entry a bin of its own.
std::array<Part, 2> cut_few(std::span<Entry> entries, std::size_t axis) {
    sort_along(axis, entries);
    std::array<Part, few> bins;
    for (std::size_t i = 0; i < entries.size(); ++i) bins[i].include(entries[i]);
    return cheapest_cut({bins.data(), entries.size()}).halves;
}

std::array<Part, 2> cut_in_the_middle(std::span<Entry> entries, std::size_t axis) {
    sort_along(axis, entries);
    const std::size_t middle = entries.size() / 2;
    return {all_of(entries.first(middle)), all_of(entries.subspan(middle))};
}

// Brings those entries to the front that belong there. Every entry is swapped, be it with one of its own kind: which kind comes
// next cannot be foreseen, and a wrong guess would cost more.
template <class BelongsToFront>
void bring_to_front(std::span<Entry> entries, BelongsToFront belongs_to_front) {
    std::size_t front = 0;
    for (Entry& entry : entries) {
        const bool belongs = belongs_to_front(entry);
        std::swap(entry, entries[front]);
        front += belongs ? 1 : 0;
    }
}

// Brings the entries into two groups, the left one first.
std::array<Part, 2> cut(std::span<Entry> entries, int depth) {
    if (entries.size() == 2) return {all_of(entries.first(1)), all_of(entries.last(1))};
    const Box centres = box_of_centres(entries);
    const std::size_t axis = centres.widest_axis();
    const float low = centres.low(axis);
    const float per_bin = bin_count / centres.width(axis);
    if (depth >= depth_limit || !(per_bin < INFINITY)) return cut_in_the_middle(entries, axis);
    if (entries.size() <= few) return cut_few(entries, axis);

    const auto bin_of = [&](const Entry& entry) {
        return std::min(static_cast<std::size_t>((entry.twice_centre(axis) - low) * per_bin), bin_count - 1);
    };
    std::array<Part, bin_count> bins;
    for (const Entry& entry : entries) bins[bin_of(entry)].include(entry);
    const Cut cheapest = cheapest_cut(bins);
    bring_to_front(entries, [&](const Entry& entry) { return bin_of(entry) < cheapest.first_right; });
    return cheapest.halves;
}

// A float box of a node, padded by what 1e-6 of its size is.
void set_box(Hierarchy::Node& node, std::size_t child, const Box& box) {
    double size = 0;
    for (std::size_t i = 0; i < 3; ++i) size = std::max<double>(size, box.width(i));
    for (std::size_t i = 0; i < 3; ++i) {
        node.low[child][i] = float_below(box.low(i) - 1e-6 * size);
        node.high[child][i] = float_above(box.high(i) + 1e-6 * size);
    }
}

// The subtree over two entries or more. It fills one node less than it has entries, from `first` on, so that each subtree's
// place is known before it is built.
void build(std::span<Entry> entries, std::int32_t first, int depth, std::vector<Hierarchy::Node>& nodes) {
    const std::array<Part, 2> halves = cut(entries, depth);
    const std::size_t middle = halves[0].count;
    const std::array<std::span<Entry>, 2> parts{entries.first(middle), entries.subspan(middle)};
    const std::array<std::int32_t, 2> roots{first + 1, first + static_cast<std::int32_t>(middle)};
    for (std::size_t i = 0; i < 2; ++i) {
        set_box(nodes[first], i, halves[i].box);
        nodes[first].child[i] = parts[i].size() == 1 ? ~parts[i].front().item() : roots[i];
    }
    const auto build_part = [&](std::size_t i) {
        if (parts[i].size() > 1) build(parts[i], roots[i], depth + 1, nodes);
    };
    if (entries.size() >= worth_a_task) {
        const auto build_on_any_thread = [&](std::size_t i) {
            const StandardArithmetic standard;
            build_part(i);
        };
        tbb::parallel_invoke([&] { build_on_any_thread(0); }, [&] { build_on_any_thread(1); });
    } else {
        build_part(0);
        build_part(1);
    }
}

}  // namespace

Hierarchy::Hierarchy(std::span<const Bounds> boxes, std::int32_t first, std::vector<std::int32_t>& left_out) {
    Bounds all;
    std::size_t count = 0;
    for (const Bounds& box : boxes)
        if (fits_floats(box)) all = unite(all, box), ++count;
    if (count < boxes.size())
        for (std::size_t i = 0; i < boxes.size(); ++i)
            if (!fits_floats(boxes[i])) left_out.push_back(first + static_cast<std::int32_t>(i));
    if (count == 0) return;
    anchor_ = all.centre();
    std::vector<Entry> entries;
    entries.reserve(count);
    for (std::size_t i = 0; i < boxes.size(); ++i)
        if (fits_floats(boxes[i])) entries.push_back(make_entry(boxes[i], anchor_, first + static_cast<std::int32_t>(i)));

    if (entries.size() == 1) {
        Node& only = nodes_.emplace_back();
        set_box(only, 0, entries.front().box);
        only.child = {~entries.front().item(), no_child};
        only.low[1] = {INFINITY, INFINITY, INFINITY};
        only.high[1] = {-INFINITY, -INFINITY, -INFINITY};
        return;
    }
    nodes_.resize(entries.size() - 1);
    build(entries, 0, 0, nodes_);
}

double Hierarchy::reach() const {
    double reach = 0;
    for (std::size_t i = 0; i < 2 && !is_empty(); ++i) {
        const Node& root = nodes_.front();
        if (root.child[i] == no_child) continue;
        Vector corner;
        corner.x = std::fmax(std::fabs(root.low[i][0]), std::fabs(root.high[i][0]));
        corner.y = std::fmax(std::fabs(root.low[i][1]), std::fabs(root.high[i][1]));
        corner.z = std::fmax(std::fabs(root.low[i][2]), std::fabs(root.high[i][2]));
        reach = std::fmax(reach, length(corner));
    }
    return reach;
}

}  // namespace lapidary
