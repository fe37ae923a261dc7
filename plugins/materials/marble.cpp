// SPDX-License-Identifier: MIT
//
// marble: veins of a second colour in a first.
//
// Layers along x, disturbed by turbulence: with s = x + amount T(p), the vein colour has the share
//
//     v^sharpness,   v = (1 + cos(2 pi s)) / 2,
//
// so that the veins lie one unit apart, at whole s, and are the thinner the higher the sharpness.

#include <lapidary/plugin.h>

#include <bit>
#include <numbers>

#include "lapidary/turbulence.h"

namespace lapidary {

class Marble final : public Leaf {
public:
    static void describe(Schema<Marble>& schema) {
        schema.summary("Veins of one colour in another, along x, disturbed by turbulence.");
        describe_common(schema);
        schema.add("vein", &Marble::vein_).at_least(0).help("The colour of the veins.");
        schema.add("amount", &Marble::amount_).help("How far turbulence pushes the veins about; 0: flat layers.");
        schema.add("octaves", &Marble::octaves_).between(1, most_octaves).help("How many octaves of noise disturb them.");
        schema.add("sharpness", &Marble::sharpness_).above(0).help("How thin the veins are.");
    }

    Matter evaluate(const Site& site) const override {
        return disturbed(site.point, turbulence(site.point, octaves_, visible_octaves(octaves_, amount_, site.footprint)));
    }

    void evaluate_batch(const SiteBatch& sites, unsigned lanes, MatterBatch& matter) const override {
        if (std::popcount(lanes) < points_worth_batch) return Material::evaluate_batch(sites, lanes, matter);
        double sums[batch_size];
        turbulence_batch(sites.points, VisibleOctaves(octaves_, amount_, sites.footprint, lanes), sums);
        for_each_lane(lanes, [&](int lane) { matter.set(lane, disturbed(sites.points.point(lane), sums[lane])); });
    }

    bool is_uniform() const override { return false; }

private:
    Matter disturbed(const Point& point, double turbulence) const {
        const double s = point.x + amount_ * turbulence;
        const double wave = (1 + std::cos(2 * std::numbers::pi * (s - std::floor(s)))) / 2;
        return matter(mix(colour(), vein_, std::pow(wave, sharpness_)), point);
    }

    Colour vein_{0.25, 0.25, 0.3};
    double amount_ = 1;
    int octaves_ = 6;
    double sharpness_ = 4;
};

LAPIDARY_PLUGIN(Marble)

}  // namespace lapidary
