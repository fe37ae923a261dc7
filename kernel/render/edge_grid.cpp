// SPDX-License-Identifier: MIT
#include "kernel/render/edge_grid.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include "kernel/math/vector.h"
#include "kernel/render/pixel_estimate.h"

namespace lapidary {

namespace {

// How much of a change a model may leave out, in parts of a cell's side: of a single cell more than where several agree. Chosen
// so that pictures reach the same RMSE in the least time.
struct LeftOut {
    double by_line, by_sides, by_pattern;
};
constexpr double left_out_by_bend = 0.5;
constexpr LeftOut left_out_by_one_cell{0.25, 0.5, 1}, left_out_by_finer_cells{0.06, 0.2, 1};

// Of the sides around a middle, before its pixel is given up: crowds of small solids take a tenth less time for the same RMSE
// than where they are followed, others hardly more.
constexpr int most_sides_with_more = 2;

double squared_difference(const FloatColour& a, const FloatColour& b) {
    const double red = double{a.r} - double{b.r}, green = double{a.g} - double{b.g}, blue = double{a.b} - double{b.b};
    return (red * red + green * green + blue * blue) / 3;
}

// The part of the unit square in which u·x + v·y < d.
double part_below(double u, double v, double d) {
    // Mirrored so that the line falls from left to right, and is not steep.
    if (u < 0) d -= u, u = -u;
    if (v < 0) d -= v, v = -v;
    if (u > v) std::swap(u, v);
    if (d <= 0) return 0;
    if (d >= u + v) return 1;
    // A triangle below the line, less what of it lies beyond the square's sides. Almost level, that is a difference of almost
    // equal areas, and there is no corner to leave out.
    if (u < 1e-6 * v) return std::clamp((d - u / 2) / v, 0.0, 1.0);
    const auto triangle = [&](double height) { return height > 0 ? height * height : 0; };
    return (triangle(d) - triangle(d - u) - triangle(d - v)) / (2 * u * v);
}

// Whether each of a row's nodes differs from the one in another row, or the same row further on.
template <std::size_t count>
[[gnu::noinline]] std::uint64_t differing(const float* __restrict r, const float* __restrict g, const float* __restrict b,
                                          std::size_t step, float least) {
    std::array<std::int32_t, count> differs;
    std::int32_t any = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const float red = r[i] - r[i + step], green = g[i] - g[i + step], blue = b[i] - b[i + step];
        differs[i] = red * red + green * green + blue * blue < least ? 0 : 1;  // nor with what is not a number
        any |= differs[i];
    }
    if (any == 0) return 0;
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < count; ++i) bits |= static_cast<std::uint64_t>(differs[i]) << i;
    return bits;
}

}  // namespace

// Where u x + v y = d, in a cell's own coordinates from 0 to 1.
struct EdgeGrid::Line {
    double u, v, d;
    double height(const Place& at) const { return u * at.x + v * at.y - d; }
    bool is_below(const Place& at) const { return height(at) < 0; }
};

// A line, and on which side of it each corner of the cell is.
struct EdgeGrid::Cut {
    Line line;
    std::array<bool, 4> is_below;
};

// Its corners and sides: left before right, top before bottom.
struct EdgeGrid::Cell {
    std::array<FloatColour, 4> corners;
    std::array<const Side*, 4> sides{};  // top, left, right, bottom; null where nothing changes

    bool has_jump(std::size_t side) const { return sides[side] && sides[side]->jumps; }
    int jumps() const;
    // The mean colour of a quarter, by the number of its corner.
    Colour quarter(std::size_t corner) const;
    Colour mean() const;
    double surprise_at(const Place& place, const FloatColour& found) const;

private:
    Colour even_quarter(std::size_t corner) const;
    Colour quarter_by_line(std::size_t corner, const Cut& cut) const;
    Colour quarter_by_sides(std::size_t corner) const;
    Place crossing(std::size_t side) const;
    Line line() const;
    Cut cut() const;
    static Place place_of_corner(std::size_t corner) {
        return {static_cast<double>(corner & 1), static_cast<double>(corner >> 1)};
    }
};

// What the sides of a pixel say together.
struct EdgeGrid::Tally {
    int jumps = 0, rays = 0;
    int with_more = 0;           // sides on which there is more than one change
    double greatest = 0;         // square of a change that is not even
    double bend = 0;             // of those that are
    bool is_divided = false;     // some cell is, by its sides
    bool is_surprising = false;  // some probe is

    void surprise(double square) {
        is_surprising = true;
        greatest = std::max(greatest, square);
    }
    void add(const Side* side, bool with_rays) {
        if (!side) return;
        if (with_rays) rays += side->halved;
        jumps += side->jumps;
        with_more += side->has_more;
        if (side->jumps || side->has_more)
            greatest = std::max(greatest, side->square);
        else
            bend = std::max(bend, side->bend);
    }
};

EdgeGrid::EdgeGrid() {
    constexpr std::size_t nodes = most_nodes * (most_nodes + 1);  // where rows are compared, one more is read
    for (std::vector<float>* channel : {&r_, &g_, &b_}) channel->resize(nodes);
    is_known_.resize(nodes), is_wanted_.resize(nodes);
    for (std::vector<std::int32_t>& sides : side_from_) sides.assign(nodes, none);
    probe_in_.assign(nodes, none);
}

void EdgeGrid::begin(PixelPlace corner, int fineness, double least_change) {
    for (const Side& side : sides_) side_from_[static_cast<std::size_t>(side.course)][side.node] = none;
    for (const Node node : known_) is_known_[node] = 0;
    for (const Node node : wanted_) is_wanted_[node] = 0;
    for (const Probe& probe : probes_) probe_in_[probe.cell] = none;
    sides_.clear(), probes_.clear(), known_.clear(), wanted_.clear(), places_.clear(), asked_.clear();
    changing_.fill(0);
    corner_ = corner, fineness_ = fineness, least_square_ = least_change * least_change;
    asking_ = Asking::of_nodes;
}

EdgeGrid::Node EdgeGrid::node_of(PixelPlace pixel) const {
    const int column = (pixel.x - corner_.x) * fineness_ + reach(), line = (pixel.y - corner_.y) * fineness_ + reach();
    return static_cast<Node>(line) * most_nodes + static_cast<Node>(column);
}

EdgeGrid::Place EdgeGrid::place_of(Node node) const {
    const auto from_corner = [&](Node steps) { return (static_cast<double>(steps) - reach()) / fineness_ + 0.5; };
    return {corner_.x + from_corner(node % most_nodes), corner_.y + from_corner(node / most_nodes)};
}

EdgeGrid::Place EdgeGrid::within_cell(const Probe& probe) const {
    const Place corner = place_of(probe.cell);
    return {(probe.place.x - corner.x) * fineness_, (probe.place.y - corner.y) * fineness_};
}

EdgeGrid::Place EdgeGrid::place_of(const Side& side) const {
    Place place = place_of(side.node);
    (side.course == Course::level ? place.x : place.y) += side.place() / fineness_;
    return place;
}

void EdgeGrid::keep_colour(Node node, const FloatColour& colour) {
    r_[node] = colour.r, g_[node] = colour.g, b_[node] = colour.b;
    if (!std::exchange(is_known_[node], 1)) known_.push_back(node);
}

void EdgeGrid::know_middle(PixelPlace pixel, const FloatColour& colour) { keep_colour(node_of(pixel), colour); }

void EdgeGrid::know_middles(PixelPlace first, std::span<const FloatColour> colours) {
    const Node begin = node_of(first);
    for (std::size_t i = 0; i < colours.size(); ++i)
        r_[begin + i] = colours[i].r, g_[begin + i] = colours[i].g, b_[begin + i] = colours[i].b;
}

bool EdgeGrid::differs(const FloatColour& a, const FloatColour& b) const { return !(squared_difference(a, b) < least_square_); }

void EdgeGrid::want(PixelPlace pixel) {
    const Node across = 2 * static_cast<Node>(reach()) + 1;
    const Node first = node_of(pixel) - static_cast<Node>(reach()) * (most_nodes + 1);
    for (Node line = 0; line < across; ++line)
        for (Node node = first + line * most_nodes; node < first + line * most_nodes + across; ++node)
            if (!std::exchange(is_wanted_[node], 1)) wanted_.push_back(node);
}

void EdgeGrid::probe(const Place& place) {
    const auto steps = [&](double at, int corner) {
        return static_cast<Node>(std::floor((at - corner - 0.5) * fineness_ + reach()));
    };
    const Node cell = steps(place.y, corner_.y) * most_nodes + steps(place.x, corner_.x);
    probe_in_[cell] = static_cast<std::int32_t>(probes_.size());
    probes_.push_back({cell, place, {}});
}

void EdgeGrid::want_all(const PixelRegion& part) {
    constexpr std::size_t ring = 1, count = tile_size + 2 * ring;
    const auto width = static_cast<std::size_t>(part.width()), height = static_cast<std::size_t>(part.height());
    const auto least = static_cast<float>(3 * least_square_);
    const std::uint64_t nodes = (std::uint64_t{1} << (width + 2 * ring)) - 1;
    std::array<std::uint64_t, count> level{}, upright{};
    for (std::size_t y = 0; y < height + 2 * ring; ++y) {
        const std::size_t line = y * most_nodes;
        level[y] = differing<count>(&r_[line], &g_[line], &b_[line], 1, least) & nodes >> 1;
        if (y + 1 < height + 2 * ring) upright[y] = differing<count>(&r_[line], &g_[line], &b_[line], most_nodes, least) & nodes;
        for (std::uint64_t left = level[y]; left != 0; left &= left - 1)
            begin_side(line + static_cast<Node>(std::countr_zero(left)), Course::level);
        for (std::uint64_t left = upright[y]; left != 0; left &= left - 1)
            begin_side(line + static_cast<Node>(std::countr_zero(left)), Course::upright);
    }
    // Of the nodes y to y + 2 and x to x + 2, the one in the middle is that of pixel (x, y).
    for (std::size_t y = 0; y < height; ++y) {
        const std::uint64_t across = level[y] | level[y + 1] | level[y + 2], down = upright[y] | upright[y + 1];
        const std::uint64_t pixels = (std::uint64_t{1} << width) - 1;
        changing_[y] = (across | across >> 1 | down | down >> 1 | down >> 2) & pixels;
    }
    asking_ = Asking::of_sides;
}

// Between nodes that some pixel asks for, which have a side in common only where the same pixel does.
void EdgeGrid::look_between_nodes() {
    for (const Node node : wanted_)
        for (const Course course : {Course::level, Course::upright}) {
            const bool ends = course == Course::level && node % most_nodes == most_nodes - 1;
            const Node next = behind(node, course);
            if (!ends && is_wanted_[next] && differs(colour_of(node), colour_of(next))) begin_side(node, course);
        }
}

void EdgeGrid::begin_side(Node node, Course course) {
    Side side;
    side.node = node, side.course = course;
    side.before = colour_of(node), side.after = colour_of(behind(node, course));
    side.square = squared_difference(side.before, side.after);
    side_from_[static_cast<std::size_t>(course)][node] = static_cast<std::int32_t>(sides_.size());
    sides_.push_back(side);
}

std::span<const EdgeGrid::Place> EdgeGrid::ask() {
    asked_.clear(), places_.clear();
    if (asking_ == Asking::of_nodes) {
        for (const Node node : wanted_)
            if (!is_known_[node]) asked_.push_back(node), places_.push_back(place_of(node));
        for (const Probe& probe : probes_) places_.push_back(probe.place);
        if (!places_.empty()) {
            asking_ = Asking::between_nodes;
            return places_;
        }
    }
    if (asking_ != Asking::of_sides) look_between_nodes();
    asking_ = Asking::of_sides;
    for (std::size_t i = 0; i < sides_.size(); ++i)
        if (!sides_[i].is_settled) asked_.push_back(i), places_.push_back(place_of(sides_[i]));
    return places_;
}

void EdgeGrid::tell(std::size_t number, const Colour& colour) {
    if (asking_ == Asking::of_sides)
        halve(sides_[asked_[number]], to_floats(colour));
    else if (number < asked_.size())
        keep_colour(asked_[number], to_floats(colour));
    else
        probes_[number - asked_.size()].colour = to_floats(colour);
}

void EdgeGrid::halve(Side& side, const FloatColour& middle) const {
    const FloatColour half_way{(side.before.r + side.after.r) / 2, (side.before.g + side.after.g) / 2,
                               (side.before.b + side.after.b) / 2};
    const double bend = squared_difference(middle, half_way);
    if (side.halved == 0) side.bend = bend;
    ++side.halved;
    const double first = squared_difference(side.before, middle), second = squared_difference(middle, side.after);
    const double lesser = first < second ? first : second, greater = first < second ? second : first;
    // What changes evenly does not jump.
    if (bend < least_square_ / 4 || greater < least_square_) {
        side.is_settled = true;
        return;
    }
    side.has_more |= !(lesser < least_square_);
    const auto place = static_cast<std::uint8_t>((side.low + side.high) / 2);
    if (first < second)
        side.low = place, side.before = middle;
    else
        side.high = place, side.after = middle;
    if (side.halved < halvings) return;
    side.is_settled = true;
    side.jumps = greater > side.square / 4;
}

const EdgeGrid::Side* EdgeGrid::side_of(Node node, Course course) const {
    const std::int32_t number = side_from_[static_cast<std::size_t>(course)][node];
    return number == none ? nullptr : &sides_[static_cast<std::size_t>(number)];
}

// ---- cells -----------------------------------------------------------------------------------------------------------

EdgeGrid::Cell EdgeGrid::cell_of(Node top_left) const {
    Cell cell;
    cell.corners = {colour_of(top_left), colour_of(top_left + 1), colour_of(top_left + most_nodes),
                    colour_of(top_left + most_nodes + 1)};
    cell.sides = {side_of(top_left, Course::level), side_of(top_left, Course::upright), side_of(top_left + 1, Course::upright),
                  side_of(top_left + most_nodes, Course::level)};
    return cell;
}

int EdgeGrid::Cell::jumps() const {
    int count = 0;
    for (std::size_t side = 0; side < 4; ++side) count += has_jump(side) ? 1 : 0;
    return count;
}

Colour EdgeGrid::Cell::mean() const {
    Colour sum;
    const int count = jumps();
    if (count == 0) {
        for (const FloatColour& corner : corners) sum += to_colour(corner);
    } else if (count == 2) {
        const Cut by_line = cut();
        for (std::size_t corner = 0; corner < 4; ++corner) sum += quarter_by_line(corner, by_line);
    } else {
        for (std::size_t corner = 0; corner < 4; ++corner) sum += quarter_by_sides(corner);
    }
    return 0.25 * sum;
}

Colour EdgeGrid::Cell::quarter(std::size_t corner) const {
    const int count = jumps();
    return count == 0 ? even_quarter(corner) : count == 2 ? quarter_by_line(corner, cut()) : quarter_by_sides(corner);
}

// What lies between the corners bilinearly, over the quarter: 9/16 of its own corner, 3/16 of those beside it, 1/16 of the last.
constexpr double share_of_corner(std::size_t corner, std::size_t quarter) {
    constexpr std::array<double, 3> shares{9.0 / 16, 3.0 / 16, 1.0 / 16};
    return shares[static_cast<std::size_t>(std::popcount(corner ^ quarter))];
}

Colour EdgeGrid::Cell::even_quarter(std::size_t quarter) const {
    Colour sum;
    for (std::size_t corner = 0; corner < 4; ++corner) sum += share_of_corner(corner, quarter) * to_colour(corners[corner]);
    return sum;
}

EdgeGrid::Place EdgeGrid::Cell::crossing(std::size_t side) const {
    const double t = sides[side]->place();
    constexpr std::size_t top = 0, left = 1, right = 2;
    return side == top ? Place{t, 0} : side == left ? Place{0, t} : side == right ? Place{1, t} : Place{t, 1};
}

EdgeGrid::Line EdgeGrid::Cell::line() const {
    std::array<Place, 2> ends;
    std::size_t count = 0;
    for (std::size_t side = 0; side < 4; ++side)
        if (has_jump(side)) ends[count++] = crossing(side);
    const double u = ends[1].y - ends[0].y, v = ends[0].x - ends[1].x;
    return {u, v, u * ends[0].x + v * ends[0].y};
}

EdgeGrid::Cut EdgeGrid::Cell::cut() const {
    Cut cut{line(), {}};
    for (std::size_t corner = 0; corner < 4; ++corner) cut.is_below[corner] = cut.line.is_below(place_of_corner(corner));
    return cut;
}

// The line has the corner on one side, with part of the quarter.
Colour EdgeGrid::Cell::quarter_by_line(std::size_t quarter, const Cut& cut) const {
    const bool is_below = cut.is_below[quarter];
    Colour here, beyond;
    double share_here = 0, share_beyond = 0;
    for (std::size_t corner = 0; corner < 4; ++corner) {
        const double share = share_of_corner(corner, quarter);
        const bool is_here = cut.is_below[corner] == is_below;
        (is_here ? here : beyond) += share * to_colour(corners[corner]);
        (is_here ? share_here : share_beyond) += share;
    }
    const Place at = place_of_corner(quarter);
    const auto& [u, v, d] = cut.line;
    const double below = part_below(u, v, 2 * d - u * at.x - v * at.y);
    const double part_here = is_below ? below : 1 - below;
    return part_here / share_here * here + (1 - part_here) / share_beyond * beyond;
}

// The square of how far a colour in the cell is from what those of the corners span, if only those on its side of the line may be
// there.
double EdgeGrid::Cell::surprise_at(const Place& place, const FloatColour& found) const {
    constexpr double near = 0.15;  // the line may be bent
    const Line cut = jumps() == 2 ? line() : Line{0, 0, 0};
    const bool is_near = std::fabs(cut.height(place)) <= near * std::hypot(cut.u, cut.v);
    constexpr float largest_float = std::numeric_limits<float>::max();
    FloatColour low{largest_float, largest_float, largest_float}, high{-largest_float, -largest_float, -largest_float};
    for (std::size_t i = 0; i < 4; ++i) {
        if (!is_near && cut.is_below(place_of_corner(i)) != cut.is_below(place)) continue;
        const FloatColour& corner = corners[i];
        low = {std::min(low.r, corner.r), std::min(low.g, corner.g), std::min(low.b, corner.b)};
        high = {std::max(high.r, corner.r), std::max(high.g, corner.g), std::max(high.b, corner.b)};
    }
    const auto nearest = [](float value, float least, float most) { return std::min(std::max(value, least), most); };
    return squared_difference(
        found, {nearest(found.r, low.r, high.r), nearest(found.g, low.g, high.g), nearest(found.b, low.b, high.b)});
}

// As much of what is beyond each of the two sides' jumps as of the quarter's halves of the sides.
Colour EdgeGrid::Cell::quarter_by_sides(std::size_t quarter) const {
    const bool is_right = (quarter & 1) != 0, is_low = quarter >> 1 != 0;
    const auto half = [&](std::size_t side, bool is_behind, std::size_t other) {
        double beyond = 0;
        if (has_jump(side)) {
            const double from_corner = is_behind ? 1 - sides[side]->place() : sides[side]->place();
            beyond = std::max(0.0, 1 - 2 * from_corner);
        }
        return mix(to_colour(corners[quarter]), to_colour(corners[other]), beyond);
    };
    return mix(half(is_low ? 3 : 0, is_right, quarter ^ 1), half(is_right ? 2 : 1, is_low, quarter ^ 2), 0.5);
}

// ---- pixels ----------------------------------------------------------------------------------------------------------

// Of all sides in a square of cells. Rays of those that end it belong to the squares behind.
EdgeGrid::Tally EdgeGrid::tally_of(Node first, std::size_t cells) const {
    Tally tally;
    for (std::size_t line = 0; line <= cells; ++line)
        for (std::size_t column = 0; column <= cells; ++column) {
            const Node node = first + line * most_nodes + column;
            if (column < cells) tally.add(side_of(node, Course::level), line < cells);
            if (line < cells) tally.add(side_of(node, Course::upright), column < cells);
        }
    return tally;
}

EdgeGrid::Estimate EdgeGrid::estimate(PixelPlace pixel) const {
    const Node across = 2 * static_cast<Node>(reach());
    const Node middle = node_of(pixel), first = middle - static_cast<Node>(reach()) * (most_nodes + 1);
    Tally tally = tally_of(first, across);
    Colour sum;
    for (std::size_t i = 0; i < across * across; ++i) {
        const Node cell_node = first + i / across * most_nodes + i % across;
        const Cell cell = cell_of(cell_node);
        // Of the four cells around a middle, the quarters that meet there.
        sum += fineness_ == 1 ? cell.quarter(3 - i) : cell.mean();
        const int jumps = cell.jumps();
        tally.is_divided |= jumps != 0 && jumps != 2;
        if (const std::int32_t number = probe_in_[cell_node]; number != none) {
            const Probe& probe = probes_[static_cast<std::size_t>(number)];
            const double surprise = cell.surprise_at(within_cell(probe), probe.colour);
            if (!(surprise < least_square_)) tally.surprise(surprise);
        }
    }
    Estimate estimate;
    estimate.colour = 1.0 / static_cast<double>(across * across) * sum;
    estimate.rays = fineness_ == 1 ? tally.rays / 4 : tally.rays + static_cast<int>(across * across) - 1;
    estimate.is_surprising = tally.is_surprising;
    // Where only middles were looked at, a finer grid may find lines in what seems a pattern, unless there is very much of it.
    const bool has_much = tally.jumps > 2 * most_jumps_of_line() || tally.with_more > most_sides_with_more;
    estimate.is_tangled = has_pattern(tally) && (fineness_ > 1 || has_much);
    const double error = left_out_by(tally) / fineness_ / brightness_scale(estimate.colour);
    estimate.error = is_finite(estimate.colour) ? error : infinity;
    return estimate;
}

bool EdgeGrid::has_pattern(const Tally& tally) const {
    return tally.with_more > 0 || tally.is_surprising || tally.jumps > most_jumps_of_line();
}

// In parts of a cell's side.
double EdgeGrid::left_out_by(const Tally& tally) const {
    const LeftOut& left_out = fineness_ == 1 ? left_out_by_one_cell : left_out_by_finer_cells;
    const double part = has_pattern(tally) ? left_out.by_pattern : tally.is_divided ? left_out.by_sides : left_out.by_line;
    return std::max(part * std::sqrt(tally.greatest), left_out_by_bend * std::sqrt(tally.bend));
}

}  // namespace lapidary
