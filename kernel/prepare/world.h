// SPDX-License-Identifier: MIT
//
// What the renderer needs of a scene, and nothing more: transforms accumulated to the leaves, coincident surfaces
// recognised, bounds, hierarchy, and the set of features that occur.
//
// The World is a list of solids under a hierarchy. A solid is a tree of operations over leaves; its leaves stand
// contiguously, so that what is computed for a line through one solid fits in a small array.
#pragma once

#include <cmath>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "kernel/export.h"
#include "kernel/math/float_box.h"
#include "kernel/math/transform.h"
#include "kernel/prepare/box_blocks.h"
#include "kernel/prepare/deep_tree.h"
#include "kernel/prepare/hierarchy.h"
#include "kernel/report/messages.h"
#include "kernel/scene/scene.h"

namespace lapidary {

// A material that varies in space, where it stands in the world.
struct PlacedTexture {
    const Material* material = nullptr;
    Transform placement;  // from the material's space to the world
    double scale = 1;     // a length in the world times this is about its length in the material's space
};

// A material where it stands in the world.
struct MaterialInstance {
    const SceneMaterial* source = nullptr;   // as written; null: none, white as objects without material are
    const PlacedTexture* texture = nullptr;  // of World::textures; null: it is uniform,
    Colour colour = Colour::white();         // of this colour everywhere,
    const Matter* finish = &plain_matter;    // and of this matter, of World::finishes, in all else
    std::int32_t number = 0;                 // for the `material` layer, from 1
    bool may_be_transparent = false;

    bool is_uniform() const { return !texture; }
    // Of a uniform one.
    Matter matter() const {
        Matter matter = *finish;
        matter.colour = colour;
        return matter;
    }
    // Of one that varies.
    const Material& material() const { return *texture->material; }

    const Transform& placement() const { return texture ? texture->placement : world_itself; }
    double scale() const { return texture ? texture->scale : 1; }

private:
    LAPIDARY_API static const Matter plain_matter;
    LAPIDARY_API static const Transform world_itself;
};

// One face of a leaf, where faces of the leaf are shared: the class it belongs to.
struct SurfaceUse {
    std::int32_t surface_class = -1;
    bool flipped = false;  // the leaf lies outside of the representative's inside
};

// Rule P: a ray that lies in a plane is thought to be shifted by an infinitesimal step along this fixed vector, the same for
// all planes, so that complements and coincident faces agree and the reversed ray sees the same.
inline constexpr Vector generic_shift{0.5773, 0.2113, 0.7887};

// Faces that lie on the same surface, to rounding. All are met at the t of the representative, bit for bit.
struct SurfaceClass {
    std::int32_t leaf = -1;  // the representative's
    Surface surface;         // in that leaf's space
    bool whole = false;      // a solid without known faces, shared with copies of itself
    double shifted_by = 0;   // how far rule P shifts rays that lie in it, if it is a plane; below 0: into the representative

    bool is(Surface::Kind kind) const { return !whole && surface.kind == kind; }
};

struct Leaf {
    const Object* object = nullptr;  // of the scene, which the World keeps alive
    Transform placement;             // from the object's space to the world
    FloatBox box;                    // in the world, padded by rounding; relative to the leaf's centre
    std::int32_t appearance = -1;    // material that its faces show; -1: the innards of what it cuts
    std::int32_t medium = 0;         // material of its inside
    double priority = 0;
    std::int32_t first_surface = -1;  // in World::surface_uses; -1: no face is shared
    std::int32_t surface_count = 0;
    std::int32_t first_face = 0, face_count = 0;  // in World::faces; none where its faces are of no known kind
    std::int32_t number = 0;                      // of the object for the `object` layer, from 1 in the order of writing
    std::int32_t most_spans = 1;                  // on any line, as the object says
    const SceneNode* source = nullptr;            // as written

    const Point& anchor() const { return placement.centre().anchor; }
    Bounds bounds() const { return box.around(anchor()); }
    // Of a ball, about its anchor, that holds all of a round leaf, as its box does.
    double radius() const { return (1 + 0x1p-38) * std::max({box.high_x, box.high_y, box.high_z}); }
};

// An operation. Trees of operations are numbers: that of a node or, where negative, ~ that of a leaf.
struct Node {
    Operation operation = Operation::union_;
    bool has_priority = false;
    std::int32_t first = 0, count = 0;  // its operands, in World::children
    std::int32_t leftmost = 0;          // of the leaves below it
    std::int32_t medium = -1;           // of a merge: the one material of its inside
    std::int32_t united = -1;           // in World::united_operands; -1: few enough to be looked at one by one
    double priority = 0;
    FloatBox box;  // relative to the leftmost leaf's centre
};

// What a cell is made of: nothing, or the medium of the operand that owns it.
struct Label {
    std::int32_t owner = -1;   // the leaf (of a merge: its leftmost); -1: empty space
    std::int32_t medium = -1;  // in World::materials
    double priority = 0;

    bool is_empty() const { return owner < 0; }
    bool operator==(const Label& other) const { return owner == other.owner; }
};

// Of a node with many operands those that act as one, their union: all of a union's or a merge's, and the subtrahends of a
// subtraction. Each by its place among the node's operands.
struct UnitedOperands {
    Hierarchy hierarchy;
    std::vector<std::int32_t> unbounded;  // outside the hierarchy
};

struct Solid {
    std::int32_t root = 0;  // its tree
    std::int32_t first_leaf = 0, leaf_count = 0;
    std::int32_t deep_tree = -1;  // in World::deep_trees; -1: shallow enough to be followed from node to node
    double rounding = 0;          // of a position on a line near it, apart from what the line's own length adds

    // Of a product: inside all of its positive leaves, which come first, and outside all of the negative ones, each of one
    // span. Packets evaluate such solids for all lanes at once.
    std::int32_t positive_count = 0;
    std::int32_t first_negative_block = -1;  // in World::negative_blocks, over the boxes of many negative leaves
    bool is_product = false;
    std::int8_t ball = -1;  // of its positive leaves, one that is round: all of the product lies in that ball; -1: there is none

    bool has_interfaces = false;  // its inside is made of more than one medium
    bool may_be_transparent = false;
    // A small tree of leaves of one span each, and of one medium: packets follow it for all lanes at once.
    bool fits_lanes = false;
    // What it does to shadow rays: it blocks them; changes nothing, clear as it is; or has to be asked (where it dims them, and
    // where opaque matter may lie hidden in transparent matter that comes first).
    enum class Shadow : std::uint8_t { blocks, clear, asked };
    Shadow shadow = Shadow::blocks;
    std::int16_t hole = -1;  // of its negative leaves, a round one as large as it; -1: there is none
};

// A World of a hundred thousand solids takes half a kilobyte for each of them, of two leaves and of a colour of its own.
static_assert(sizeof(Leaf) == 136 && sizeof(Node) == 56 && sizeof(Solid) == 40 && sizeof(MaterialInstance) == 56);

// The longest cell of a line through a solid that rounding alone may have made, at t: what its two ends lost in their leaves'
// spaces, which is the solid's `rounding`, and two roundings of t each, as a position in a leaf's space is added to that of the
// space's anchor. Shells that are thicker than a few ulp of t are kept from any distance.
inline double sliver_length(double rounding, double t) { return 4 * 0x1p-53 * std::fabs(t) + rounding; }

// A surface without inside, with the operands that clip it on the way from its leaf to the top of its tree.
struct Sheet {
    struct Condition {
        std::int32_t solid = 0;  // a solid of World::clips, listed apart from the visible ones
        bool inside = true;      // seen where inside it, or where outside
    };
    std::int32_t leaf = 0;
    std::vector<Condition> conditions;
    std::int32_t order = 0;  // number of solids before it in the order of writing
};

// What occurs anywhere in the scene. What does not is not asked for.
struct Features {
    bool transparency = false;
    bool reflection = false;
    bool relief = false;
    bool sheets = false;
    bool shared_surfaces = false;
    bool extended_lights = false;
    LAPIDARY_API std::string describe() const;
};

class LAPIDARY_API World {
public:
    std::vector<Leaf> leaves;
    std::vector<Node> nodes;
    std::vector<std::int32_t> children;  // trees
    std::vector<Solid> solids;           // in the order of writing
    std::vector<Label> insides;          // of the solids, where some are transparent: what those of one medium are made of
    std::vector<Solid> clips;            // what only clips sheets
    std::vector<Sheet> sheets;
    std::vector<DeepTree> deep_trees;
    std::vector<UnitedOperands> united_operands;
    std::vector<BoxBlock> negative_blocks;
    std::vector<Surface> faces;  // each in its leaf's space; leaves whose faces are the same there share them
    std::vector<SurfaceUse> surface_uses;
    std::vector<SurfaceClass> surface_classes;
    std::vector<MaterialInstance> materials;
    std::vector<std::shared_ptr<const PlacedTexture>> textures;  // what materials point to, like
    std::vector<std::shared_ptr<const Matter>> finishes;         // these: seldom there are many
    std::vector<std::shared_ptr<const Light>> lights;            // with direction
    std::vector<std::shared_ptr<const Light>> ambient_lights;
    Colour background;
    Bounds bounds;                        // of all bounded solids
    Hierarchy hierarchy;                  // over the bounded solids
    std::vector<std::int32_t> unbounded;  // solids outside the hierarchy
    std::int32_t most_leaves = 0;         // of one solid
    std::size_t leaves_left_out = 0;      // of the scene: empty, or out of reach of all that they are combined with
    std::int32_t most_spans = 1;          // of one leaf
    Features features;
    SceneNodePtr root;  // keeps objects and materials alive
    // Objects from this number on have this name: their own, else of the innermost block around them that has one; null: none.
    struct NameFrom {
        std::int32_t number = 0;
        const std::string* name = nullptr;
    };
    std::vector<NameFrom> names;

    Bounds box_of(std::int32_t tree) const {
        return tree < 0 ? leaves[~tree].bounds() : nodes[tree].box.around(leaves[nodes[tree].leftmost].anchor());
    }
    std::span<const std::int32_t> operands_of(const Node& node) const {
        return {children.data() + node.first, static_cast<std::size_t>(node.count)};
    }
    const std::string* name_of(const Leaf& leaf) const;
    std::span<const Surface> faces_of(const Leaf& leaf) const {
        return {faces.data() + leaf.first_face, static_cast<std::size_t>(leaf.face_count)};
    }
    // Whether a leaf is a ball, to far less than the margin of Leaf::radius().
    bool is_round(const Leaf& leaf) const {
        return leaf.face_count == 1 && faces_of(leaf)[0].kind == Surface::Kind::sphere && leaf.placement.keeps_shapes();
    }
    // Of a ball, about its anchor, that lies in a round leaf, by a margin like that of Leaf::radius().
    double inner_radius(const Leaf& leaf) const {
        const auto& row = leaf.placement.linear()[0];
        return (1 - 0x1p-38) * faces_of(leaf)[0].a * length(Vector{row[0], row[1], row[2]});
    }
};

// Whether no line meets a leaf in more than one piece. A cone among shared surfaces is met with both of its nappes.
inline bool has_one_span(const World& world, const Leaf& leaf) {
    for (std::int32_t i = 0; i < leaf.surface_count; ++i) {
        const SurfaceClass& surface = world.surface_classes[world.surface_uses[leaf.first_surface + i].surface_class];
        if (surface.is(Surface::Kind::cone)) return false;
    }
    return leaf.most_spans == 1;
}

struct PrepareOptions {
    int threads = 0;          // 0: as many as the machine has
    bool coincidence = true;  // faces on the same surface are recognised; without, to measure what that costs
};

// Never fails: what cannot be used is left out, with a warning (a sheet that subtracts).
LAPIDARY_API std::shared_ptr<const World> prepare_world(const Scene& scene, Messages& messages,
                                                        const PrepareOptions& options = {});

}  // namespace lapidary
