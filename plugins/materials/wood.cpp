// SPDX-License-Identifier: MIT
//
// wood: growth rings about the y axis, the trunk's.
//
// The distance from the axis is disturbed by noise that is drawn out along the trunk. Within a ring the wood darkens slowly to
// the late wood and turns back quickly, yet continuously, at the start of the next year; fine fibres along the trunk
// vary it a little.

#include <lapidary/plugin.h>

#include <bit>

namespace lapidary {

class Wood final : public Leaf {
public:
    Wood() { set_colour({0.76, 0.55, 0.33}); }

    static void describe(Schema<Wood>& schema) {
        schema.summary("Growth rings about the y axis, a unit apart, with fibres along it.");
        describe_common(schema);
        schema.add("late", &Wood::late_).at_least(0).help("The dark colour at the end of each year's ring.");
        schema.add("amount", &Wood::amount_).help("How uneven the rings are; 0: true circles.");
        schema.add("fibre", &Wood::fibre_).between(0, 1).help("How much the fibres show.");
    }

    Matter evaluate(const Site& site) const override {
        return grown(site.point, noise(along_rings(site.point)), noise(along_fibres(site.point)));
    }

    void evaluate_batch(const SiteBatch& sites, unsigned lanes, MatterBatch& matter) const override {
        if (std::popcount(lanes) < points_worth_batch) return Material::evaluate_batch(sites, lanes, matter);
        PointBatch rings, fibres;
        for (int lane = 0; lane < batch_size; ++lane) {
            rings.set(lane, along_rings(sites.points.point(lane)));
            fibres.set(lane, along_fibres(sites.points.point(lane)));
        }
        double rings_noise[batch_size], fibres_noise[batch_size];
        noise_batch(rings, batch_size, rings_noise);
        noise_batch(fibres, batch_size, fibres_noise);
        for_each_lane(
            lanes, [&](int lane) { matter.set(lane, grown(sites.points.point(lane), rings_noise[lane], fibres_noise[lane])); });
    }

    bool is_uniform() const override { return false; }

private:
    // Noise drawn out along the trunk.
    static Point along_rings(const Point& p) { return {0.5 * p.x, 0.1 * p.y, 0.5 * p.z}; }
    static Point along_fibres(const Point& p) { return {12 * p.x, 0.5 * p.y, 12 * p.z}; }

    Matter grown(const Point& p, double rings_noise, double fibres_noise) const {
        const double radius = std::hypot(p.x, p.z) + amount_ * rings_noise;
        const double age = radius - std::floor(radius);
        const double grain = fibre_ * fibres_noise;
        return matter(mix(colour(), late_, std::clamp(lateness(age) + grain, 0.0, 1.0)), p);
    }

    // 0 at the start of a year, 1 near its end, and back.
    static double lateness(double age) {
        constexpr double turn = 0.85;
        const double ramp = age < turn ? age / turn : (1 - age) / (1 - turn);
        return ramp * ramp * (3 - 2 * ramp);
    }

    Colour late_{0.45, 0.26, 0.12};
    double amount_ = 0.5;
    double fibre_ = 0.15;
};

LAPIDARY_PLUGIN(Wood)

}  // namespace lapidary
