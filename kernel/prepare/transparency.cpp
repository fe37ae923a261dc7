// SPDX-License-Identifier: MIT
#include "kernel/prepare/transparency.h"

#include "kernel/csg/label.h"

namespace lapidary {

namespace {

// The label of a cell inside of a node, where operations leave no choice: no unions among left operands.
Label label_of_inside(const World& world, std::int32_t tree) {
    if (tree < 0) return label_of_leaf(world, ~tree);
    const Node& node = world.nodes[tree];
    return label_inside(node, world.operands_of(node), [&](std::int32_t operand) { return label_of_inside(world, operand); });
}

bool fits_lanes(const World& world, const Solid& solid) {
    constexpr std::int32_t few_leaves = 16;
    if (solid.has_interfaces || solid.deep_tree >= 0 || solid.leaf_count > few_leaves) return false;
    for (std::int32_t i = 0; i < solid.leaf_count; ++i)
        if (!has_one_span(world, world.leaves[solid.first_leaf + i])) return false;
    return true;
}

// Lets all light through, to the last bit.
bool is_clear(const MaterialInstance& material) {
    if (!material.is_uniform()) return false;
    const Matter m = material.matter();
    return m.is_transparent() && m.opacity == 0 && m.colour.r >= 1 && m.colour.g >= 1 && m.colour.b >= 1;
}

// What a solid of the World is made of, if that is one medium.
const Label& inside_of(const World& world, const Solid& solid) { return world.insides[&solid - world.solids.data()]; }

bool is_clear(const World& world, const Solid& solid) {
    const std::int32_t medium = inside_of(world, solid).medium;
    if (medium < 0 || !is_clear(world.materials[medium])) return false;
    for (std::int32_t i = 0; i < solid.leaf_count; ++i) {
        const std::int32_t shown = world.leaves[solid.first_leaf + i].appearance;
        if (shown >= 0 && !is_clear(world.materials[shown])) return false;
    }
    return true;
}

bool is_transparent(const World& world, const Solid& solid) {
    const std::int32_t medium = inside_of(world, solid).medium;
    return medium >= 0 ? world.materials[medium].may_be_transparent : solid.may_be_transparent;
}

// Whether the first of two solids owns what both hold, or may do so.
bool may_come_first(const Label& first, const Label& second) {
    if (first.medium < 0 || second.medium < 0) return true;
    return first.priority > second.priority || (first.priority == second.priority && &first < &second);
}

void ask_for_shadows_of_hidden_solids(World& world, const Solid& transparent) {
    const Bounds box = world.box_of(transparent.root);
    const auto visit = [&](std::int32_t index) {
        Solid& other = world.solids[index];
        if (other.shadow == Solid::Shadow::blocks && world.box_of(other.root).overlaps(box) &&
            may_come_first(inside_of(world, transparent), inside_of(world, other)))
            other.shadow = Solid::Shadow::asked;
    };
    for (std::int32_t index : world.unbounded) visit(index);
    world.hierarchy.for_each_overlapping(box, visit);
}

}  // namespace

void note_transparency(World& world) {
    world.insides.resize(world.solids.size());
    for (std::size_t i = 0; i < world.solids.size(); ++i) {
        Solid& solid = world.solids[i];
        solid.fits_lanes = fits_lanes(world, solid);
        if (!solid.has_interfaces && solid.deep_tree < 0) world.insides[i] = label_of_inside(world, solid.root);
        if (is_transparent(world, solid))
            solid.shadow = is_clear(world, solid) && !world.features.sheets ? Solid::Shadow::clear : Solid::Shadow::asked;
    }
    for (const Solid& solid : world.solids)
        if (is_transparent(world, solid)) ask_for_shadows_of_hidden_solids(world, solid);
}

}  // namespace lapidary
