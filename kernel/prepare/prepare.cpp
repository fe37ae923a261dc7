// SPDX-License-Identifier: MIT
//
// Scene -> World: one walk down the trees accumulates transforms, materials and priorities to the leaves; one walk up
// combines the parts that are left.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <unordered_map>
#include <utility>

#include "kernel/math/standard_arithmetic.h"
#include "kernel/prepare/draft.h"
#include "kernel/prepare/surface_classes.h"
#include "kernel/prepare/transparency.h"
#include "kernel/prepare/world.h"

namespace lapidary {

namespace {

constexpr std::int32_t no_material = -1;

// Evaluation from node to node recurses, and its time grows with the square of the depth: what is left of the depth after
// joining and splitting may be this much.
constexpr std::size_t deepest_followed = 100;

// The box around a leaf in the world, padded by what rounding and the t of a class's representative may be off. Lines are
// placed about the leaf's centre, which may be far from what a line meets of an infinite leaf.
Bounds padded_box(const Leaf& leaf) {
    Bounds box = leaf.placement.to_parent(leaf.object->bounds());
    const Point centre = leaf.placement.centre().rounded();
    const double coordinate = std::max(largest_coordinate(box), largest_coordinate({centre, centre}));
    const double padding = 2 * coincidence_tolerance(coordinate, box.is_finite() ? length(box.diagonal()) : 0);
    const Vector pad{padding, padding, padding};
    return {box.low - pad, box.high + pad};
}

class Preparer {
public:
    Preparer(const Scene& scene, World& world, Messages& messages) : scene_(scene), world_(world), messages_(messages) {}

    void run(const PrepareOptions& options) {
        world_.root = scene_.root;
        world_.background = scene_.background;
        world_.materials.emplace_back();  // what objects without material are made of
        world_.materials.back().is_uniform = true;
        world_.materials.back().number = 1;
        for (const SceneLight& light : scene_.lights) {
            (light.light->is_ambient() ? world_.ambient_lights : world_.lights).push_back(light.light);
            world_.features.extended_lights |= light.light->has_extent();
        }
        if (scene_.root)
            if (const DraftPtr all = draft_tree(*scene_.root)) split_into_solids(all, solids_);
        emit_everything();
        for (const Solid& solid : world_.solids)
            if (solid.box.is_finite()) world_.bounds = unite(world_.bounds, solid.box);
        set_rounding();
        for (Leaf& leaf : world_.leaves) note_faces(leaf);
        if (options.coincidence) recognise_coincident_surfaces(world_, messages_);
        for (Solid& solid : world_.solids)
            if (solid.deep_tree < 0) find_product_form(solid);
        build_hierarchy();
        note_features();
        if (world_.features.transparency) note_transparency(world_);
    }

private:
    // What the blocks around a node hand down to it.
    struct Surroundings {
        ExactTransform to_world;
        std::int32_t medium = no_material;      // the default for leaves without a material of their own
        std::int32_t appearance = no_material;  // the same, from within the innermost operand that cuts
        const std::string* name = nullptr;      // the innermost
        bool cuts = false;                      // below the right operand of a subtraction or an intersection
    };

    Surroundings enter_node(const SceneNode& node, Surroundings here) {
        if (!node.name.empty()) here.name = &node.name;
        if (!node.factors.empty()) here.to_world = node.transform.then(here.to_world);
        if (node.material) here.medium = here.appearance = place_material(*node.material, here.to_world);
        return here;
    }

    // The sheets below one of the operands of a node.
    struct OperandSheets {
        std::size_t operand = 0;
        std::vector<SheetDraft> sheets;
    };

    // An operation whose operands are being drafted.
    struct Visit {
        const SceneNode* node = nullptr;
        Surroundings here;
        std::vector<DraftPtr> operands;  // drafted so far; null where empty
        std::vector<OperandSheets> sheets;
        std::int32_t leftmost_medium = 0;  // of the leaf written first, whether it is out of reach or not

        Visit(const SceneNode& visited, Surroundings inside) : node(&visited), here(std::move(inside)) {
            operands.reserve(visited.operands.size());
        }
    };

    // What has become of a node: its solid, null where it is empty, and the sheets that are left, clipped.
    struct Drafted {
        DraftPtr draft;
        std::vector<SheetDraft> sheets;
        std::int32_t leftmost_medium = 0;
    };

    // The whole tree, depth first with a stack of its own: names can chain nodes a hundred thousand deep.
    DraftPtr draft_tree(const SceneNode& root) {
        if (root.operation == Operation::leaf) return finish(draft_leaf(root, enter_node(root, {})));
        std::vector<Visit> stack;
        stack.emplace_back(root, enter_node(root, {}));
        for (;;) {
            Visit& visit = stack.back();
            if (visit.operands.size() == visit.node->operands.size()) {
                Drafted drafted = combine_operands(visit);
                stack.pop_back();
                if (stack.empty()) return finish(std::move(drafted));
                take(stack.back(), std::move(drafted));
                continue;
            }
            const SceneNode& next = *visit.node->operands[visit.operands.size()];
            Surroundings here = enter_node(next, around_operand(visit));
            if (next.operation == Operation::leaf)
                take(visit, draft_leaf(next, here));
            else
                stack.emplace_back(next, std::move(here));
        }
    }

    DraftPtr finish(Drafted root) {
        sheets_ = std::move(root.sheets);
        return std::move(root.draft);
    }

    // What the next operand of a node finds around itself.
    static Surroundings around_operand(const Visit& visit) {
        Surroundings around = visit.here;
        const Operation operation = visit.node->operation;
        const bool right_cuts = operation == Operation::subtraction || operation == Operation::intersection;
        if (right_cuts && !visit.operands.empty()) around.cuts = true, around.appearance = no_material;
        return around;
    }

    static void take(Visit& visit, Drafted operand) {
        if (visit.operands.empty()) visit.leftmost_medium = operand.leftmost_medium;
        if (!operand.sheets.empty()) visit.sheets.push_back({visit.operands.size(), std::move(operand.sheets)});
        visit.operands.push_back(std::move(operand.draft));
    }

    Drafted combine_operands(Visit& visit) {
        const SceneNode& node = *visit.node;
        Drafted drafted;
        for (OperandSheets& below : visit.sheets)
            clip_sheets(node.operation, below.operand, visit.operands, below.sheets, drafted.sheets);
        drafted.leftmost_medium = visit.leftmost_medium;
        // A merge is of one medium: its own, else that of what stands leftmost in it.
        std::int32_t medium = no_material;
        if (node.operation == Operation::merge) medium = node.material ? visit.here.medium : visit.leftmost_medium;
        drafted.draft = combine(node.operation, std::move(visit.operands), node.priority, medium);
        return drafted;
    }

    Drafted draft_leaf(const SceneNode& node, const Surroundings& here) {
        Leaf leaf;
        leaf.object = node.object.get();
        leaf.placement = Transform(here.to_world);
        leaf.medium = std::max(here.medium, 0);
        leaf.appearance = here.appearance != no_material ? here.appearance : here.cuts ? no_material : leaf.medium;
        leaf.priority = node.priority.value_or(0);
        leaf.number = ++leaf_number_;
        leaf.source = &node;
        leaf.name = here.name;
        leaf.box = padded_box(leaf);
        world_.most_spans = std::max(world_.most_spans, leaf.object->max_spans());

        Drafted drafted;
        drafted.leftmost_medium = leaf.medium;
        if (leaf.object->is_sheet()) {
            leaf.appearance = leaf.medium;
            drafted.sheets.push_back({std::move(leaf), {}});
            return drafted;
        }
        drafted.draft = std::make_shared<Draft>();
        drafted.draft->leaf = static_cast<std::int32_t>(leaves_.size());
        drafted.draft->box = leaf.box;
        leaves_.push_back(std::move(leaf));
        return drafted;
    }

    // A sheet has no inside: it takes part in no operation, but is seen only where the operands beside it let it be.
    void clip_sheets(Operation operation, std::size_t own, const std::vector<DraftPtr>& operands, std::vector<SheetDraft>& from,
                     std::vector<SheetDraft>& to) {
        for (SheetDraft& sheet : from) {
            if (operation == Operation::subtraction && own > 0) {
                messages_.warning(
                    sheet.leaf.source->place,
                    "a plane of thickness 0 has no inside and subtracts nothing; give it a thickness or use a halfspace");
                continue;
            }
            if (operation == Operation::subtraction || operation == Operation::intersection)
                for (std::size_t i = 0; i < operands.size(); ++i)
                    if (i != own) sheet.conditions.push_back({operands[i], operation == Operation::intersection});
            to.push_back(std::move(sheet));
        }
    }

    std::int32_t place_material(const SceneMaterial& scene_material, const ExactTransform& to_world) {
        const Material& material = *scene_material.material;
        const auto [known, is_new] = uniform_.try_emplace(&scene_material, static_cast<std::int32_t>(world_.materials.size()));
        if (!is_new && material.is_uniform()) return known->second;

        MaterialInstance instance;
        instance.material = &material;
        instance.source = &scene_material;
        instance.number = is_new ? ++material_number_ : world_.materials[known->second].number;
        instance.is_uniform = material.is_uniform();
        instance.may_be_transparent = material.may_be_transparent();
        world_.features.reflection |= material.may_reflect();
        world_.features.relief |= material.may_have_relief();
        if (instance.is_uniform) {
            instance.matter = material.evaluate({});
        } else {
            instance.placement = Transform(to_world);
            const Matrix3& m = instance.placement.inverse_linear();
            const Vector r0{m[0][0], m[0][1], m[0][2]}, r1{m[1][0], m[1][1], m[1][2]}, r2{m[2][0], m[2][1], m[2][2]};
            instance.scale = std::cbrt(std::fabs(dot(cross(r0, r1), r2)));
        }
        world_.materials.push_back(std::move(instance));
        return static_cast<std::int32_t>(world_.materials.size()) - 1;
    }

    void emit_everything() {
        std::size_t leaf_count = sheets_.size();
        for (const DraftPtr& draft : solids_) leaf_count += draft->leaf_count;
        world_.leaves.reserve(leaf_count);
        world_.solids.reserve(solids_.size());
        for (const DraftPtr& draft : solids_) world_.solids.push_back(emit_solid(*draft));
        for (SheetDraft& draft : sheets_) emit_sheet(draft);
        solids_ = {};
        sheets_ = {};
        leaves_ = {};
    }

    void emit_sheet(SheetDraft& draft) {
        Sheet sheet;
        for (const SheetDraft::Condition& condition : draft.conditions) {
            if (condition.clip) {
                sheet.conditions.push_back({static_cast<std::int32_t>(world_.clips.size()), condition.inside});
                world_.clips.push_back(emit_solid(*condition.clip));
            } else if (condition.inside) {
                return;  // clipped to the empty set
            }
        }
        const auto comes_before_sheet = [&](const Solid& solid) {
            return world_.leaves[solid.first_leaf].number < draft.leaf.number;
        };
        sheet.order = static_cast<std::int32_t>(std::count_if(world_.solids.begin(), world_.solids.end(), comes_before_sheet));
        sheet.leaf = static_cast<std::int32_t>(world_.leaves.size());
        world_.leaves.push_back(std::move(draft.leaf));
        world_.sheets.push_back(std::move(sheet));
    }

    void note_faces(Leaf& leaf) {
        const Surfaces surfaces = leaf.object->surfaces();
        leaf.first_face = static_cast<std::int32_t>(world_.faces.size());
        leaf.face_count = static_cast<std::int32_t>(surfaces.size());
        world_.faces.insert(world_.faces.end(), surfaces.begin(), surfaces.end());
    }

    Solid emit_solid(const Draft& draft) {
        Solid solid;
        const std::size_t first_node = world_.nodes.size();
        solid.first_leaf = static_cast<std::int32_t>(world_.leaves.size());
        solid.root = emit_nodes(draft);
        solid.leaf_count = static_cast<std::int32_t>(world_.leaves.size()) - solid.first_leaf;
        solid.box = draft.box;
        for (std::int32_t i = 0; i < solid.leaf_count; ++i) {
            const Leaf& leaf = world_.leaves[solid.first_leaf + i];
            solid.may_be_transparent |= world_.materials[leaf.medium].may_be_transparent;
        }
        for (std::size_t i = first_node; i < world_.nodes.size(); ++i) {
            const Node& node = world_.nodes[i];
            if (node.medium >= 0) solid.may_be_transparent |= world_.materials[node.medium].may_be_transparent;
            solid.has_interfaces |= node.operation == Operation::union_ || node.operation == Operation::symdiff;
        }
        world_.most_leaves = std::max(world_.most_leaves, solid.leaf_count);
        if (draft.depth > deepest_followed) {
            solid.deep_tree = static_cast<std::int32_t>(world_.deep_trees.size());
            world_.deep_trees.push_back(make_deep_tree(world_, solid, static_cast<std::int32_t>(first_node)));
        }
        return solid;
    }

    // Operands first, so that a node's index is above those of its operands; with a stack of its own, as trees may be deep.
    std::int32_t emit_nodes(const Draft& root) {
        struct Emission {
            const Draft* draft;
            std::int32_t leftmost;               // leaf below
            std::vector<std::int32_t> operands;  // emitted so far
        };
        std::vector<Emission> stack;
        const auto begin = [&](const Draft& draft) {
            stack.push_back({&draft, static_cast<std::int32_t>(world_.leaves.size()), {}});
        };
        begin(root);
        for (;;) {
            const Draft& draft = *stack.back().draft;
            if (const std::size_t next = stack.back().operands.size(); next < draft.operands.size()) {
                begin(*draft.operands[next]);
                continue;
            }
            emit_node(draft, stack.back().leftmost, stack.back().operands);
            const auto index = static_cast<std::int32_t>(world_.nodes.size()) - 1;
            stack.pop_back();
            if (stack.empty()) return index;
            stack.back().operands.push_back(index);
        }
    }

    void emit_node(const Draft& draft, std::int32_t leftmost, const std::vector<std::int32_t>& operands) {
        Node node;
        node.operation = draft.operation;
        node.box = draft.box;
        node.has_priority = draft.priority.has_value();
        node.priority = draft.priority.value_or(0);
        if (draft.operation == Operation::leaf) {
            node.first = static_cast<std::int32_t>(world_.leaves.size());
            world_.leaves.push_back(leaves_[draft.leaf]);
        } else {
            node.first = static_cast<std::int32_t>(world_.children.size());
            node.count = static_cast<std::int32_t>(operands.size());
            world_.children.insert(world_.children.end(), operands.begin(), operands.end());
            if (draft.operation == Operation::merge) {
                node.owner = leftmost;
                node.medium = draft.medium;
            }
        }
        world_.nodes.push_back(node);
    }

    // What has no bounds is taken to be as large as the scene.
    void set_rounding() {
        const double scene_size = length(region_of_interest(world_).diagonal());
        for (std::vector<Solid>* solids : {&world_.solids, &world_.clips})
            for (Solid& solid : *solids)
                solid.rounding = coincidence_tolerance(0, solid.box.is_finite() ? length(solid.box.diagonal()) : scene_size);
    }

    void find_product_form(Solid& solid) {
        std::vector<std::int32_t>&positive = positive_, &negative = negative_;
        positive.clear();
        negative.clear();
        const Node& root = world_.nodes[solid.root];
        const std::span<const std::int32_t> operands(world_.children.data() + root.first, static_cast<std::size_t>(root.count));
        bool fits = false;
        if (root.operation == Operation::subtraction) {
            fits = gather_leaves(operands[0], Operation::intersection, positive) &&
                   std::all_of(operands.begin() + 1, operands.end(),
                               [&](std::int32_t operand) { return gather_leaves(operand, Operation::union_, negative); });
        } else {
            fits = gather_leaves(solid.root, Operation::intersection, positive);
        }
        if (!fits) return;
        solid.is_product = true;
        solid.first_product_leaf = static_cast<std::int32_t>(world_.product_leaves.size());
        solid.positive_count = static_cast<std::int32_t>(positive.size());
        solid.negative_count = static_cast<std::int32_t>(negative.size());
        world_.product_leaves.insert(world_.product_leaves.end(), positive.begin(), positive.end());
        world_.product_leaves.insert(world_.product_leaves.end(), negative.begin(), negative.end());
        put_into_blocks(solid, negative);
    }

    // Few boxes are looked at one by one.
    void put_into_blocks(Solid& solid, std::span<const std::int32_t> negative) {
        constexpr std::size_t few = 2;
        if (negative.size() <= few) return;
        std::vector<Bounds> boxes;
        for (std::int32_t leaf : negative) boxes.push_back(world_.leaves[leaf].box);
        solid.first_negative_block = add_box_blocks(boxes, anchor_of_blocks(solid.box), world_.negative_blocks);
    }

    // The leaves of a tree of one operation only, where each has one span on any line.
    bool gather_leaves(std::int32_t index, Operation operation, std::vector<std::int32_t>& leaves) const {
        const Node& node = world_.nodes[index];
        if (node.operation == Operation::leaf) {
            leaves.push_back(node.first);
            return has_one_span(world_, world_.leaves[node.first]);
        }
        if (node.operation != operation && !(operation == Operation::union_ && node.operation == Operation::merge)) return false;
        for (std::int32_t i = 0; i < node.count; ++i)
            if (!gather_leaves(world_.children[node.first + i], operation, leaves)) return false;
        return true;
    }

    // Boxes so large that floats cannot hold them go to the list that is always asked.
    void build_hierarchy() {
        std::vector<Bounds> boxes;
        std::vector<std::int32_t> items;
        boxes.reserve(world_.solids.size());
        items.reserve(world_.solids.size());
        for (std::size_t i = 0; i < world_.solids.size(); ++i) {
            const Bounds& box = world_.solids[i].box;
            if (fits_hierarchy(box)) {
                boxes.push_back(box);
                items.push_back(static_cast<std::int32_t>(i));
            } else {
                world_.unbounded.push_back(static_cast<std::int32_t>(i));
            }
        }
        world_.hierarchy = Hierarchy(boxes, items);
    }

    void note_features() {
        for (const Solid& solid : world_.solids) world_.features.transparency |= solid.may_be_transparent;
        for (const Sheet& sheet : world_.sheets)
            world_.features.transparency |= world_.materials[world_.leaves[sheet.leaf].medium].may_be_transparent;
        world_.features.sheets = !world_.sheets.empty();
    }

    const Scene& scene_;
    World& world_;
    Messages& messages_;
    std::vector<Leaf> leaves_;  // as drafted; in the World they stand solid by solid
    std::vector<DraftPtr> solids_;
    std::vector<SheetDraft> sheets_;
    std::vector<std::int32_t> positive_, negative_;  // of the solid that is looked at
    std::unordered_map<const SceneMaterial*, std::int32_t> uniform_;
    std::int32_t leaf_number_ = 0, material_number_ = 1;
};

}  // namespace

std::string Features::describe() const {
    std::string text;
    const auto add = [&text](bool present, std::string_view name) {
        if (present) text += (text.empty() ? "" : ", ") + std::string(name);
    };
    add(transparency, "transparency");
    add(reflection, "reflection");
    add(relief, "relief");
    add(sheets, "sheets");
    add(shared_surfaces, "coincident faces");
    add(extended_lights, "lights with extent");
    return text.empty() ? "none" : text;
}

std::shared_ptr<const World> prepare_world(const Scene& scene, Messages& messages, const PrepareOptions& options) {
    const StandardArithmetic standard;
    auto world = std::make_shared<World>();
    Preparer(scene, *world, messages).run(options);
    return world;
}

}  // namespace lapidary
