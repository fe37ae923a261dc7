// SPDX-License-Identifier: MIT
//
// turbulence: a material seen through a stirred space. Its value at p is that of its child at
//
//     q(p) = p + amount (T(p), T(p + o1), T(p + o2)),   T(p) = sum over i < n of |noise(2^i p)| / 2^i.
//
// Boundaries are those of the child along the curve q(p(t)). The curve has corners, where an octave passes 0, so they
// are isolated by distances alone: over an interval of half width r about a middle m,
//
//     |q(t) - q(m)| <= |d| r + |amount| sqrt(R0^2 + R1^2 + R2^2),
//
// with Ri the reach of each T (lapidary/turbulence.h), and where the child is clear of boundaries that far around q(m), there
// is none in the interval. Otherwise it is halved. As the reach follows the slope that the curve has there, not the steepest that
// it could have anywhere, intervals stay wide.

#include <lapidary/plugin.h>

#include "lapidary/turbulence.h"

namespace lapidary {

namespace {

// Far from one another, so that the three components do not look alike.
constexpr Vector offset1{31.416, 47.853, 12.793};
constexpr Vector offset2{-233.145, 113.408, 185.31};

}  // namespace

class Turbulence final : public Material {
public:
    static void describe(Schema<Turbulence>& schema) {
        schema.summary("A material whose space is stirred by octaves of noise.");
        schema.add("octaves", &Turbulence::octaves_)
            .between(1, most_octaves)
            .help("How many octaves, each twice as fine and half as strong as the one before.");
        schema.add("amount", &Turbulence::amount_).help("How strongly the space is stirred; 0: not at all.");
        schema.child("child", &Turbulence::child_).help("The material that is stirred.");
    }

    Matter evaluate(const Site& site) const override {
        const Point& p = site.point;
        const int count = visible_octaves(site.footprint);
        const Vector stir{turbulence(p, octaves_, count), turbulence(p + offset1, octaves_, count),
                          turbulence(p + offset2, octaves_, count)};
        Matter m = child_->evaluate({p + amount_ * stir, site.footprint});
        if (!(m.relief == Vector{})) m.relief = pulled_back(m.relief, p);
        return m;
    }

    Crossing next_boundary(const MaterialLine& line, double from, double to) const override {
        if (!child_->has_boundaries()) return {};
        const double speed = length(line.direction);
        if (!(speed > 0) || !(speed < infinity)) return {};
        const double t = Search(*this, line).find(from, to);
        return t < to ? Crossing{t, normal(line, t)} : Crossing{};
    }

    std::uint64_t region(const Point& point) const override { return child_->region(stirred(point)); }

    // The stirring carries no two points farther apart than their distance times this.
    double clearance(const Point& point) const override {
        const double stretch = 1 + std::fabs(amount_) * std::sqrt(3.0) * octaves_ * noise_slope_bound;
        return child_->clearance(stirred(point)) / stretch;
    }

    bool is_uniform() const override { return child_->is_uniform(); }
    bool has_boundaries() const override { return child_->has_boundaries(); }
    bool may_be_transparent() const override { return child_->may_be_transparent(); }
    bool may_reflect() const override { return child_->may_reflect(); }
    bool may_have_relief() const override { return child_->may_have_relief(); }

private:
    // The first place where the region that the child names changes along the line.
    class Search {
    public:
        Search(const Turbulence& texture, const MaterialLine& line)
            : texture_(texture), line_(line), speed_(length(line.direction)), direction_(line.direction / speed_) {}

        double find(double from, double to) {
            for (double a = from; a < to && budget_ > 0;) {
                const double b = std::fmin(a + widest / speed_, to);
                if (!(b > a)) return infinity;  // the step is lost in rounding: the line is too far out
                const double t = find_within(a, b);
                if (t < infinity) return t;
                a = b;
            }
            return infinity;
        }

    private:
        // What two boundaries must be apart along the line, in the texture's units, to be told from none.
        static constexpr double resolution = 0x1p-32;
        static constexpr double widest = 0.5;

        double find_within(double a, double b) {
            const double middle = a + (b - a) / 2, r = (b - a) / 2;
            if (--budget_ < 0 || is_clear(middle, r)) return infinity;
            if (r * speed_ < resolution || !(a < middle && middle < b)) {
                const std::uint64_t near = region(a);
                return region(b) == near ? infinity : bisect(a, b, near);
            }
            const double t = find_within(a, middle);
            return t < infinity ? t : find_within(middle, b);
        }

        bool is_clear(double middle, double r) const {
            const Point p = line_.at(middle);
            const double radius = r * speed_;
            const TurbulenceReach x = turbulence_reach(p, direction_, radius, texture_.octaves_);
            const TurbulenceReach y = turbulence_reach(p + offset1, direction_, radius, texture_.octaves_);
            const TurbulenceReach z = turbulence_reach(p + offset2, direction_, radius, texture_.octaves_);
            const double reach = radius + std::fabs(texture_.amount_) * length(Vector{x.reach, y.reach, z.reach});
            const Point q = p + texture_.amount_ * Vector{x.value, y.value, z.value};
            return texture_.child_->clearance(q) > reach;
        }

        double bisect(double a, double b, std::uint64_t near) const {
            for (;;) {
                const double middle = a + (b - a) / 2;
                if (!(a < middle && middle < b)) return b;
                (region(middle) == near ? a : b) = middle;
            }
        }

        std::uint64_t region(double t) const { return texture_.region(line_.at(t)); }

        const Turbulence& texture_;
        const MaterialLine& line_;
        double speed_;
        Vector direction_;
        // A line that runs in a boundary is never clear of it; such a search is given up.
        int budget_ = 1 << 16;
    };

    Point stirred(const Point& p) const {
        return p +
               amount_ * Vector{turbulence(p, octaves_), turbulence(p + offset1, octaves_), turbulence(p + offset2, octaves_)};
    }

    // A gradient at q(p), of a relief or of what is 0 on a boundary, as the gradient at p: by the chain rule, the
    // transpose of q's derivative times it.
    Vector pulled_back(const Vector& g, const Point& p) const {
        const Vector x = turbulence_with_gradient(p, octaves_).gradient;
        const Vector y = turbulence_with_gradient(p + offset1, octaves_).gradient;
        const Vector z = turbulence_with_gradient(p + offset2, octaves_).gradient;
        return g + amount_ * (g.x * x + g.y * y + g.z * z);
    }

    // The normal of the child's boundary, found on a short chord of the curve through it.
    Normal normal(const MaterialLine& line, double t) const {
        const double step = 0x1p-24 / length(line.direction);
        const Point before = stirred(line.at(t - step)), behind = stirred(line.at(t + step));
        const Crossing crossing = child_->next_boundary({before, behind - before}, 0, 1);
        if (!(crossing.t < infinity)) return Normal(line.direction);
        return Normal(pulled_back(to_vector(crossing.normal), line.at(t)));
    }

    // So many octaves that the rest moves a point by less than a sixteenth of a pixel. The octaves from i on, each
    // between 0 and noise_bound of its height, stray from their mean by less than 2 noise_bound / 2^i together.
    int visible_octaves(double footprint) const {
        const double unseen = footprint / 16;
        double stray = std::fabs(amount_) * std::sqrt(3.0) * 2 * noise_bound;
        int count = 0;
        for (; count < octaves_ && stray >= unseen; ++count) stray /= 2;
        return count;
    }

    int octaves_ = 6;
    double amount_ = 1;
    Child child_;
};

LAPIDARY_PLUGIN(Turbulence)

}  // namespace lapidary
