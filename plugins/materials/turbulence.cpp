// SPDX-License-Identifier: MIT
//
// turbulence: a material seen through a stirred space. Its value at p is that of its child at
//
//     q(p) = p + amount (T(p), T(p + o1), T(p + o2)),   T(p) = sum over i < n of |noise(2^i p)| / 2^i.
//
// Boundaries are those of the child along the curve q(p + s u), u the line's unit vector. From where it is, the curve gets
// no farther in s than
//
//     |u + amount (T0', T1', T2')| s + |amount| |(stray0(s), stray1(s), stray2(s))|
//
// with the slope and stray of each T (lapidary/turbulence.h); and as far as the child is clear of boundaries around it there is
// none on the way. So the search strides along the line by what is surely free. As the bound follows the slope that the
// curve has there, not the steepest that it could have anywhere, a dozen strides lead to a boundary.

#include <lapidary/plugin.h>

#include <bit>

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
        Matter m = child_->evaluate({stirred(p, visible_octaves(octaves_, amount_of_all(), site.footprint)), site.footprint});
        if (!(m.relief == Vector{})) m.relief = pulled_back(m.relief, p);
        return m;
    }

    void evaluate_batch(const SiteBatch& sites, unsigned lanes, MatterBatch& matter) const override {
        if (std::popcount(lanes) < points_worth_batch) return Material::evaluate_batch(sites, lanes, matter);
        SiteBatch stirred_sites = sites;
        stir(stirred_sites.points, VisibleOctaves(octaves_, amount_of_all(), sites.footprint, lanes));
        child_->evaluate_batch(stirred_sites, lanes, matter);
        if (!child_->may_have_relief()) return;
        for_each_lane(lanes, [&](int lane) {
            const Vector relief = matter.relief(lane);
            if (!(relief == Vector{})) matter.set_relief(lane, pulled_back(relief, sites.points.point(lane)));
        });
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
    // Strides along a line to the first place where the child's region changes.
    class Search {
    public:
        Search(const Turbulence& texture, const MaterialLine& line)
            : texture_(texture), line_(line), speed_(length(line.direction)), direction_(line.direction / speed_) {}

        double find(double from, double to) const {
            double t = from;
            int pressed = 0;  // strides in a row that were made though nothing was surely free
            for (int strides = 0; strides < most_strides && t < to; ++strides) {
                const double free = t + free_stride(line_.at(t)) / speed_;
                const double next = std::fmin(to, std::fmax(free, t + pressed_stride(pressed) / speed_));
                if (!(next > t)) return infinity;  // the stride is lost in rounding: the line is too far out
                pressed = next > free ? pressed + 1 : 0;
                if (pressed > 0) {
                    const std::uint64_t here = region(t);
                    if (region(next) != here) return bisect(t, next, here);
                }
                t = next;
            }
            return infinity;
        }

    private:
        // How far apart two boundaries along the line must be, in the texture's units, to be told from none.
        static constexpr double resolution = 0x1p-24;
        static constexpr double longest_stride = 1;
        // An endless line that meets nothing in so many strides is taken to meet nothing.
        static constexpr int most_strides = 1 << 16;

        // A line that runs in a boundary for a while is never clear of it; there the strides grow.
        static double pressed_stride(int pressed) { return std::fmin(std::ldexp(resolution, pressed / 64), longest_stride); }

        double free_stride(const Point& p) const {
            const int octaves = texture_.octaves_;
            const double amount = texture_.amount_;
            const TurbulenceExpansion x(p, direction_, octaves), y(p + offset1, direction_, octaves),
                z(p + offset2, direction_, octaves);
            const double clearance = texture_.child_->clearance(p + amount * Vector{x.value(), y.value(), z.value()});
            const double pace = length(direction_ + amount * Vector{x.slope(), y.slope(), z.slope()});
            const auto reach = [&](double s) {
                return pace * s + std::fabs(amount) * length(Vector{x.stray(s), y.stray(s), z.stray(s)});
            };
            double s = std::fmin(clearance / pace, longest_stride);
            while (s > resolution && !(reach(s) < clearance)) s *= 0.75;
            return s > resolution ? s : 0;
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
    };

    Point stirred(const Point& p) const { return stirred(p, octaves_); }

    // By so many octaves and the mean of the others.
    Point stirred(const Point& p, int count) const {
        return p + amount_ * turbulence({p, p + offset1, p + offset2}, octaves_, count);
    }

    // The same for a batch of points.
    void stir(PointBatch& points, const VisibleOctaves& visible) const {
        const auto turbulence_beside = [&](const Vector& offset, double* sums) {
            PointBatch moved;
            move(points, offset, moved);
            turbulence_batch(moved, visible, sums);
        };
        double x[batch_size], y[batch_size], z[batch_size];
        turbulence_batch(points, visible, x);
        turbulence_beside(offset1, y), turbulence_beside(offset2, z);
        add(amount_, x, points.x), add(amount_, y, points.y), add(amount_, z, points.z);
    }

    [[gnu::noinline]] static void move(const PointBatch& __restrict points, const Vector& offset, PointBatch& __restrict moved) {
        for (int lane = 0; lane < batch_size; ++lane) {
            moved.x[lane] = points.x[lane] + offset.x;
            moved.y[lane] = points.y[lane] + offset.y;
            moved.z[lane] = points.z[lane] + offset.z;
        }
    }

    [[gnu::noinline]] static void add(double amount, const double* __restrict shifts, double* __restrict coordinates) {
        for (int lane = 0; lane < batch_size; ++lane) coordinates[lane] += amount * shifts[lane];
    }

    // How far octaves move a point that move each coordinate by at most the amount.
    double amount_of_all() const { return std::sqrt(3.0) * amount_; }

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

    int octaves_ = 6;
    double amount_ = 1;
    Child child_;
};

LAPIDARY_PLUGIN(Turbulence)

}  // namespace lapidary
