// SPDX-License-Identifier: MIT
//
// A material seen through a transform of its own: what is asked in the surrounding space is taken into the material's
// space, what it answers is taken back.
#pragma once

#include "kernel/interfaces/material.h"

namespace lapidary {

class LAPIDARY_API PlacedMaterial final : public Material {
public:
    PlacedMaterial(MaterialPtr material, const ExactTransform& to_surroundings);

    Matter evaluate(const Site& site) const override;
    void evaluate_batch(const SiteBatch& sites, unsigned lanes, MatterBatch& matter) const override;
    Crossing next_boundary(const MaterialLine& line, double from, double to) const override;
    std::uint64_t region(const Point& point) const override;
    double clearance(const Point& point) const override;
    bool is_uniform() const override { return material_->is_uniform(); }
    bool has_boundaries() const override { return material_->has_boundaries(); }
    bool may_be_transparent() const override { return material_->may_be_transparent(); }
    bool may_reflect() const override { return material_->may_reflect(); }
    bool may_have_relief() const override { return material_->may_have_relief(); }

private:
    // A gradient goes from one space to the other like a normal, length included.
    Vector relief_in_surroundings(const Vector& relief) const { return to_vector(transform_.to_parent(Normal(relief))); }

    MaterialPtr material_;
    Transform transform_;      // from the material's space to its surroundings
    double footprint_scale_;   // a width in the surroundings times this is one in the material's space
    double greatest_stretch_;  // no way in the surroundings grows by more than this on the way into the material's space
};

}  // namespace lapidary
