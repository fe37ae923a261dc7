// SPDX-License-Identifier: MIT
//
// layers: a map of any number of materials over a pattern.
//
// The pattern gives every point a number from 0 to 1; the edges divide that range among the materials, in order. In
// planes, spheres and cylinders the map repeats with every unit; waves and noise go through it up and down.

#include <lapidary/plugin.h>

#include <numbers>

#include "lapidary/noise_search.h"

namespace lapidary {

namespace {

// Rising numbers between 0 and 1: those that were written, or one after each of so many equal parts.
class Edges {
public:
    Edges(const std::vector<double>& written, std::size_t parts) : written_(written), parts_(parts) {}

    std::size_t size() const { return written_.empty() ? parts_ - 1 : written_.size(); }
    double operator[](std::size_t i) const {
        return written_.empty() ? static_cast<double>(i + 1) / static_cast<double>(parts_) : written_[i];
    }
    // Which part of the range a value lies in.
    std::size_t part_of(double value) const {
        std::size_t part = 0;
        while (part < size() && value >= (*this)[part]) ++part;
        return part;
    }
    // The smallest f(edge).
    template <class F>
    double least(F f) const {
        double least = infinity;
        for (std::size_t i = 0; i < size(); ++i) least = std::fmin(least, f((*this)[i]));
        return least;
    }

private:
    const std::vector<double>& written_;
    std::size_t parts_;
};

struct Pattern {
    virtual ~Pattern() = default;
    virtual double value(const Point& p) const = 0;
    // The first place in from < t < to where the value passes an edge.
    virtual Crossing next_edge(const MaterialLine& line, double from, double to, const Edges& edges) const = 0;
    // A distance within which no edge is passed.
    virtual double clearance(const Point& p, const Edges& edges) const = 0;
};

// The fraction of a length, so that the map begins anew at every integer: that is an edge, too.
template <class Length>
struct Repeated final : Pattern {
    double value(const Point& p) const override {
        const double length = Length::of(p);
        return length - std::floor(length);
    }
    Crossing next_edge(const MaterialLine& line, double from, double, const Edges& edges) const override {
        const auto next = [&](double edge) { return Length::next(line, from, edge); };
        const double t = std::fmin(next(0), edges.least(next));
        return t < infinity ? Crossing{t, Length::normal(line.at(t))} : Crossing{};
    }
    double clearance(const Point& p, const Edges& edges) const override {
        const auto distance = [&](double edge) { return distance_to_integer(Length::of(p), edge); };
        return std::fmin(distance(0), edges.least(distance));
    }
};

struct AlongX {
    static double of(const Point& p) { return p.x; }
    static Normal normal(const Point&) { return {1, 0, 0}; }
    static double next(const MaterialLine& line, double from, double offset) {
        return next_integer(line.origin.x, line.direction.x, from, offset);
    }
};

struct FromOrigin {
    static double of(const Point& p) { return length(p); }
    static Normal normal(const Point& p) { return Normal(p); }
    static double next(const MaterialLine& line, double from, double offset) {
        return next_shell(to_vector(line.origin), line.direction, from, offset);
    }
};

struct FromAxis {
    static Vector across(const Vector& v) { return {v.x, 0, v.z}; }
    static double of(const Point& p) { return length(across(to_vector(p))); }
    static Normal normal(const Point& p) { return Normal(across(to_vector(p))); }
    static double next(const MaterialLine& line, double from, double offset) {
        return next_shell(across(to_vector(line.origin)), across(line.direction), from, offset);
    }
};

// (1 + sin x) / 2. It passes an edge where x is asin(2 edge - 1) or pi less that, and whole periods from there.
struct Waves final : Pattern {
    static constexpr double period = 2 * std::numbers::pi;

    double value(const Point& p) const override { return (1 + std::sin(p.x)) / 2; }
    Crossing next_edge(const MaterialLine& line, double from, double, const Edges& edges) const override {
        const auto next = [&](double x) {
            return next_integer(line.origin.x / period, line.direction.x / period, from, x / period);
        };
        const double t = edges.least([&](double edge) {
            const double rising = std::asin(2 * edge - 1), falling = std::numbers::pi - rising;
            return std::fmin(next(rising), next(falling));
        });
        return {t, {1, 0, 0}};
    }
    // The value changes by half the way at most.
    double clearance(const Point& p, const Edges& edges) const override {
        return 2 * edges.least([v = value(p)](double edge) { return std::fabs(v - edge); });
    }
};

// (1 + noise) / 2.
struct NoisePattern final : Pattern {
    double value(const Point& p) const override { return (1 + noise(p)) / 2; }
    Crossing next_edge(const MaterialLine& line, double from, double to, const Edges& edges) const override {
        return next_change_of_noise(line, from, to, [&](double v) { return edges.part_of((1 + v) / 2); });
    }
    double clearance(const Point& p, const Edges& edges) const override {
        return 2 / noise_slope_bound * edges.least([v = value(p)](double edge) { return std::fabs(v - edge); });
    }
};

}  // namespace

class Layers final : public Selection<Layers> {
public:
    static void describe(Schema<Layers>& schema) {
        schema.summary("Any number of materials laid over a pattern, from its lowest values to its highest.");
        schema.add("pattern", &Layers::kind_, {"planes", "spheres", "cylinders", "waves", "noise"})
            .help(
                "Planes across x, spheres about the origin or cylinders about y, repeating with every unit; "
                "waves along x of period 2 pi; noise.");
        schema.add("edge", &Layers::edges_)
            .between(0, 1)
            .help(
                "Where one material ends and the next begins, 0 to 1; written once between any two. Without: at equal "
                "distances.");
        schema.children("children", &Layers::children_).help("The materials in order, one more than there are edges.");
        schema.require("the edges must rise", [](const Layers& l) { return std::ranges::is_sorted(l.edges_); });
        schema.require("there must be one edge between any two materials, or none at all",
                       [](const Layers& l) { return l.edges_.empty() || l.edges_.size() + 1 == l.children_.size(); });
    }

    std::int64_t choose(const Point& p) const { return static_cast<std::int64_t>(edges().part_of(pattern().value(p))); }
    Crossing next_cut(const MaterialLine& line, double from, double to) const {
        return children_.size() < 2 ? Crossing{} : pattern().next_edge(line, from, to, edges());
    }
    double clearance_of_cuts(const Point& p) const { return pattern().clearance(p, edges()); }

    const std::vector<Child>& children() const { return children_; }

private:
    enum class Kind { planes, spheres, cylinders, waves, noise };

    const Pattern& pattern() const {
        static const Repeated<AlongX> planes;
        static const Repeated<FromOrigin> spheres;
        static const Repeated<FromAxis> cylinders;
        static const Waves waves;
        static const NoisePattern noise;
        static const Pattern* const all[] = {&planes, &spheres, &cylinders, &waves, &noise};
        return *all[static_cast<std::size_t>(kind_)];
    }

    Edges edges() const { return {edges_, children_.size()}; }

    Kind kind_ = Kind::planes;
    std::vector<double> edges_;
    std::vector<Child> children_;
};

LAPIDARY_PLUGIN(Layers)

}  // namespace lapidary
