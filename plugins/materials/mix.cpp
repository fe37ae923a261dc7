// SPDX-License-Identifier: MIT
//
// mix: every value of two materials blended, by a number or by the brightness of a third material.
//
// Where one of two blended materials is opaque and the other is transparent there is no index between: the opaque one
// then counts as the same transparent medium with opacity 1, so that the blend turns from one into the other
// gradually and is opaque, without index, only where nothing of the transparent one is left.

#include <lapidary/plugin.h>

#include <algorithm>
#include <span>

namespace lapidary {

class Mix final : public Material {
public:
    static void describe(Schema<Mix>& schema) {
        schema.summary("Blends every value of two materials.");
        schema.add("amount", &Mix::amount_)
            .between(0, 1)
            .help("How much of the second: 0 is the first alone; a third child takes its place.");
        schema.child("first", &Mix::first_).help("What there is at an amount of 0.");
        schema.child("second", &Mix::second_).help("What there is at an amount of 1.");
        schema.child("by", &Mix::by_).optional().help("A material whose brightness, 0 to 1, is the amount from point to point.");
    }

    Matter evaluate(const Site& site) const override {
        const double amount = by_ ? brightness(by_->evaluate(site).colour) : amount_;
        if (amount <= 0) return first_->evaluate(site);
        if (amount >= 1) return second_->evaluate(site);
        return blend(first_->evaluate(site), second_->evaluate(site), amount);
    }

    void evaluate_batch(const SiteBatch& sites, unsigned lanes, MatterBatch& matter) const override {
        double amounts[batch_size];
        find_amounts(sites, lanes, amounts);
        unsigned first = 0, second = 0;  // the lanes that have something of each
        for_each_lane(lanes, [&](int lane) {
            first |= static_cast<unsigned>(!(amounts[lane] >= 1)) << lane;
            second |= static_cast<unsigned>(!(amounts[lane] <= 0)) << lane;
        });
        MatterBatch others;
        if (first != 0) first_->evaluate_batch(sites, first, matter);
        if (second != 0) second_->evaluate_batch(sites, second, others);
        for_each_lane(second & ~first, [&](int lane) { matter.set(lane, others.matter(lane)); });
        for_each_lane(second & first,
                      [&](int lane) { matter.set(lane, blend(matter.matter(lane), others.matter(lane), amounts[lane])); });
    }

    // A change in any of them is a change in the blend.
    Crossing next_boundary(const MaterialLine& line, double from, double to) const override {
        Crossing first;
        for (const Child* child : children()) {
            const Crossing next = (*child)->next_boundary(line, from, std::fmin(to, first.t));
            if (next.t < first.t) first = next;
        }
        return first;
    }

    std::uint64_t region(const Point& point) const override {
        std::uint64_t all = 0;
        for (const Child* child : children()) all = combine_regions(all, (*child)->region(point));
        return all;
    }

    double clearance(const Point& point) const override {
        double least = infinity;
        for (const Child* child : children()) least = std::fmin(least, (*child)->clearance(point));
        return least;
    }

    bool is_uniform() const override { return all(&Material::is_uniform); }
    bool has_boundaries() const override { return any(&Material::has_boundaries); }
    bool may_be_transparent() const override { return first_->may_be_transparent() || second_->may_be_transparent(); }
    bool may_reflect() const override { return first_->may_reflect() || second_->may_reflect(); }
    bool may_have_relief() const override { return first_->may_have_relief() || second_->may_have_relief(); }

private:
    [[gnu::noinline]] void find_amounts(const SiteBatch& sites, unsigned lanes, double* amounts) const {
        std::fill_n(amounts, batch_size, amount_);
        if (!by_) return;
        MatterBatch by;
        by_->evaluate_batch(sites, lanes, by);
        for_each_lane(lanes, [&](int lane) { amounts[lane] = brightness(by.matter(lane).colour); });
    }

    // The luminance of Rec. 709, so written that a grey is its own brightness exactly.
    static double brightness(const Colour& c) { return c.g + 0.2126 * (c.r - c.g) + 0.0722 * (c.b - c.g); }

    static Matter blend(Matter a, Matter b, double t) {
        share_medium(a, b);
        share_medium(b, a);
        Matter m;
        m.colour = mix(a.colour, b.colour, t);
        m.reflection = std::lerp(a.reflection, b.reflection, t);
        m.refraction = std::lerp(a.refraction, b.refraction, t);
        m.shininess = std::lerp(a.shininess, b.shininess, t);
        m.opacity = std::lerp(a.opacity, b.opacity, t);
        m.depth = std::lerp(a.depth, b.depth, t);
        m.relief = (1 - t) * a.relief + t * b.relief;
        return m;
    }

    // Lets an opaque matter count as an opaque part of a transparent one.
    static void share_medium(Matter& opaque, const Matter& transparent) {
        if (opaque.is_transparent() || !transparent.is_transparent()) return;
        opaque.refraction = transparent.refraction;
        opaque.depth = transparent.depth;
        opaque.opacity = 1;
    }

    // The materials that have a part in it.
    std::span<const Child* const> children() const { return {slots_.data(), by_ ? slots_.size() : slots_.size() - 1}; }
    bool all(bool (Material::*property)() const) const {
        return std::ranges::all_of(children(), [&](const Child* child) { return ((**child).*property)(); });
    }
    bool any(bool (Material::*property)() const) const {
        return std::ranges::any_of(children(), [&](const Child* child) { return ((**child).*property)(); });
    }

    double amount_ = 0.5;
    Child first_, second_, by_;
    std::array<const Child*, 3> slots_{&first_, &second_, &by_};
};

LAPIDARY_PLUGIN(Mix)

}  // namespace lapidary
