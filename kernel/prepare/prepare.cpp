// SPDX-License-Identifier: MIT
//
// Scene -> World: one walk down the trees accumulates transforms, materials and priorities to the leaves; one walk up
// combines the parts that are left.
#include <fmt/format.h>

#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <span>
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
constexpr std::int32_t deepest_followed = 100;

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

// Numbers of addresses, in one open table: with hundreds of thousands of them, a list node for each would take its time.
class NumberOfAddress {
public:
    NumberOfAddress() : slots_(64) {}

    // The number of an address; -1 where it is new, for the caller to change. Holds until the next call.
    std::int32_t& operator[](const void* address) {
        if (2 * ++count_ > slots_.size()) grow();
        Slot& slot = slot_of(address);
        if (slot.address) --count_;
        slot.address = address;
        return slot.number;
    }

private:
    struct Slot {
        const void* address = nullptr;
        std::int32_t number = -1;
    };

    Slot& slot_of(const void* address) {
        const std::size_t mask = slots_.size() - 1;
        // Things made one after the other mostly stand near to one another in memory: here, too.
        const auto bits = std::bit_cast<std::uintptr_t>(address);
        std::size_t i = (bits >> 7 ^ bits >> 26) & mask;
        while (slots_[i].address && slots_[i].address != address) i = (i + 1) & mask;
        return slots_[i];
    }

    void grow() {
        std::vector<Slot> old(2 * slots_.size());
        old.swap(slots_);
        for (const Slot& slot : old)
            if (slot.address) slot_of(slot.address) = slot;
    }

    std::vector<Slot> slots_;
    std::size_t count_ = 0;
};

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
            if (const DraftTree all = draft_tree(*scene_.root); all != empty_set) drafts_.split_into_solids(all, solids_);
        emit_everything();
        if (options.coincidence) recognise_coincident_surfaces(world_, messages_);
        finish_solids();
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
        std::size_t first_operand = 0;  // in the list of operands under way, those drafted so far; empty ones, too
        std::vector<OperandSheets> sheets;
        std::int32_t leftmost_medium = 0;  // of the leaf written first, whether it is out of reach or not
        std::size_t leaves_before = 0, materials_before = 0, operations_before = 0;  // in the lists when it began
    };

    // What has become of a node: its solid, and the sheets that are left, clipped.
    struct Drafted {
        DraftTree tree = empty_set;
        std::vector<SheetDraft> sheets;
        std::int32_t leftmost_medium = 0;
    };

    // The whole tree, depth first with a stack of its own: names can chain nodes a hundred thousand deep.
    DraftTree draft_tree(const SceneNode& root) {
        if (root.operation == Operation::leaf) return finish(draft_leaf(root, enter_node(root, {})));
        std::vector<Visit> stack;
        stack.push_back(visit_of(root, enter_node(root, {})));
        for (;;) {
            Visit& visit = stack.back();
            const std::size_t done = under_way_.size() - visit.first_operand;
            if (done == visit.node->operands.size()) {
                Drafted drafted = combine_operands(visit);
                stack.pop_back();
                if (stack.empty()) return finish(std::move(drafted));
                take(stack.back(), std::move(drafted));
                continue;
            }
            look_ahead(visit.node->operands, done);
            if (done == enough_to_tell) make_room(visit, done);
            const SceneNode& next = *visit.node->operands[done];
            Surroundings here = enter_node(next, around_operand(visit, done));
            if (next.operation == Operation::leaf)
                take(visit, draft_leaf(next, here));
            else
                stack.push_back(visit_of(next, std::move(here)));
        }
    }

    Visit visit_of(const SceneNode& node, Surroundings here) const {
        Visit visit;
        visit.node = &node;
        visit.here = std::move(here);
        visit.first_operand = under_way_.size();
        visit.leaves_before = drafts_.leaves.size();
        visit.materials_before = world_.materials.size();
        visit.operations_before = drafts_.count();
        return visit;
    }

    // Of many operands the first ones tell how much room all of them take, if they are small: lists need not be copied as they
    // grow.
    static constexpr std::size_t enough_to_tell = 256;
    void make_room(const Visit& visit, std::size_t done) {
        constexpr std::size_t few = 4;
        const std::size_t all = visit.node->operands.size();
        if (all < 16 * done) return;
        const auto expected = [&](std::size_t before, std::size_t now) {
            const std::size_t of_those_done = std::min(now - before, few * done);
            return before + of_those_done * (all + all / 16) / done;
        };
        drafts_.leaves.reserve(expected(visit.leaves_before, drafts_.leaves.size()));
        world_.materials.reserve(expected(visit.materials_before, world_.materials.size()));
        drafts_.reserve(expected(visit.operations_before, drafts_.count()));
    }

    // Asks for the memory of the operands to come, in steps, each of which needs what the one before asked for: they stand here
    // and there, and to wait for each of them would take as long as all the rest. Inline, as g++ 12 takes calls of functions
    // that do nothing but this for superfluous.
    [[gnu::always_inline]] static void look_ahead(const std::vector<SceneNodePtr>& operands, std::size_t next) {
        constexpr std::size_t step = 2, few = 4;
        const auto ahead = [&](std::size_t steps) {
            const std::size_t index = next + steps * step;
            return index < operands.size() ? operands[index].get() : nullptr;
        };
        if (const SceneNode* node = ahead(4)) ask_for(node);
        if (const SceneNode* node = ahead(3)) ask_for_parts(*node);
        if (const SceneNode* node = ahead(2))
            for (std::size_t i = 0; i < std::min(few, node->operands.size()); ++i) ask_for(node->operands[i].get());
        if (const SceneNode* node = ahead(1))
            for (std::size_t i = 0; i < std::min(few, node->operands.size()); ++i) ask_for_parts(*node->operands[i]);
        if (const SceneNode* node = ahead(0))
            for (std::size_t i = 0; i < std::min(few, node->operands.size()); ++i)
                if (const SceneMaterial* material = node->operands[i]->material.get()) ask_for(material->material.get());
    }

    [[gnu::always_inline]] static void ask_for_parts(const SceneNode& node) {
        if (!node.operands.empty()) ask_for(node.operands.data());
        if (node.object) ask_for(node.object.get());
        if (node.material) ask_for(node.material.get());
    }

    template <class T>
    [[gnu::always_inline]] static void ask_for(const T* object) {
        constexpr std::size_t cache_line = 64;
        for (std::size_t i = 0; i < sizeof(T); i += cache_line) __builtin_prefetch(reinterpret_cast<const char*>(object) + i);
    }

    DraftTree finish(Drafted root) {
        sheets_ = std::move(root.sheets);
        return root.tree;
    }

    // What an operand of a node finds around itself.
    static Surroundings around_operand(const Visit& visit, std::size_t operand) {
        Surroundings around = visit.here;
        const Operation operation = visit.node->operation;
        const bool right_cuts = operation == Operation::subtraction || operation == Operation::intersection;
        if (right_cuts && operand > 0) around.cuts = true, around.appearance = no_material;
        return around;
    }

    void take(Visit& visit, Drafted operand) {
        const std::size_t done = under_way_.size() - visit.first_operand;
        if (done == 0) visit.leftmost_medium = operand.leftmost_medium;
        if (!operand.sheets.empty()) visit.sheets.push_back({done, std::move(operand.sheets)});
        under_way_.push_back(operand.tree);
    }

    Drafted combine_operands(Visit& visit) {
        const SceneNode& node = *visit.node;
        const std::span<DraftTree> operands = std::span(under_way_).subspan(visit.first_operand);
        Drafted drafted;
        for (OperandSheets& below : visit.sheets)
            clip_sheets(node.operation, below.operand, operands, below.sheets, drafted.sheets);
        drafted.leftmost_medium = visit.leftmost_medium;
        // A merge is of one medium: its own, else that of what stands leftmost in it.
        std::int32_t medium = no_material;
        if (node.operation == Operation::merge) medium = node.material ? visit.here.medium : visit.leftmost_medium;
        drafted.tree = drafts_.combine(node.operation, operands, node.priority, medium);
        under_way_.resize(visit.first_operand);
        return drafted;
    }

    Drafted draft_leaf(const SceneNode& node, const Surroundings& here) {
        const auto index = static_cast<std::int32_t>(drafts_.leaves.size());
        Leaf& leaf = drafts_.leaves.emplace_back();
        leaf.object = node.object.get();
        leaf.placement = Transform(here.to_world);
        leaf.medium = std::max(here.medium, 0);
        leaf.appearance = here.appearance != no_material ? here.appearance : here.cuts ? no_material : leaf.medium;
        leaf.priority = node.priority.value_or(0);
        leaf.number = ++leaf_number_;
        leaf.source = &node;
        if (here.name != (world_.names.empty() ? nullptr : world_.names.back().name))
            world_.names.push_back({leaf.number, here.name});
        leaf.box = padded_box(leaf);
        note_faces(leaf);
        leaf.most_spans = leaf.object->max_spans();
        world_.most_spans = std::max(world_.most_spans, leaf.most_spans);

        Drafted drafted;
        drafted.leftmost_medium = leaf.medium;
        if (leaf.object->is_sheet()) {
            leaf.appearance = leaf.medium;
            drafted.sheets.push_back({index, {}});
        } else {
            drafted.tree = ~index;
        }
        return drafted;
    }

    // A sheet has no inside: it takes part in no operation, but is seen only where the operands beside it let it be.
    void clip_sheets(Operation operation, std::size_t own, std::span<const DraftTree> operands, std::vector<SheetDraft>& from,
                     std::vector<SheetDraft>& to) {
        for (SheetDraft& sheet : from) {
            if (operation == Operation::subtraction && own > 0) {
                messages_.warning(
                    drafts_.leaves[sheet.leaf].source->place,
                    "a plane of thickness 0 has no inside and subtracts nothing; give it a thickness or use a halfspace");
                continue;
            }
            if (operation == Operation::subtraction || operation == Operation::intersection)
                for (std::size_t i = 0; i < operands.size(); ++i) {
                    if (i == own) continue;
                    drafts_.share(operands[i]);
                    sheet.conditions.push_back({operands[i], operation == Operation::intersection});
                }
            to.push_back(std::move(sheet));
        }
    }

    // A uniform one stands in the World once, others once for each place.
    std::int32_t place_material(const SceneMaterial& scene_material, const ExactTransform& to_world) {
        if (&scene_material == uniform_source_) return uniform_;
        const Material& material = *scene_material.material;
        const auto index = static_cast<std::int32_t>(world_.materials.size());
        std::int32_t& known = known_materials_[&scene_material];
        const bool is_new = known < 0;
        if (is_new) known = index;

        MaterialInstance instance;
        instance.is_uniform = material.is_uniform();
        if (instance.is_uniform) uniform_source_ = &scene_material, uniform_ = known;
        if (!is_new && instance.is_uniform) return known;
        instance.material = &material;
        instance.source = &scene_material;
        instance.number = is_new ? ++material_number_ : world_.materials[known].number;
        instance.may_be_transparent = material.may_be_transparent();
        may_be_transparent_ |= instance.may_be_transparent;
        world_.features.reflection |= material.may_reflect();
        world_.features.relief |= material.may_have_relief();
        if (instance.is_uniform)
            instance.matter = material.evaluate({});
        else
            instance.place = std::make_shared<const MaterialPlacement>(placement_of(to_world));
        world_.materials.push_back(std::move(instance));
        return index;
    }

    static MaterialPlacement placement_of(const ExactTransform& to_world) {
        MaterialPlacement placement{Transform(to_world)};
        placement.scale = mean_stretch(placement.transform.inverse_linear());
        return placement;
    }

    void emit_everything() {
        world_.solids.reserve(solids_.size());
        world_.nodes.reserve(solids_.size());
        world_.children.reserve(drafts_.leaves.size());
        order_.reserve(drafts_.leaves.size());
        for (DraftTree tree : solids_) {
            const Solid& solid = world_.solids.emplace_back(emit_solid(tree));
            world_.features.transparency |= solid.may_be_transparent;
            if (const Bounds& box = drafts_.box_of(tree); box.is_finite()) world_.bounds = unite(world_.bounds, box);
        }
        for (SheetDraft& draft : sheets_) emit_sheet(draft);
        arrange_leaves();
        if (has_unbounded_solids_) set_rounding_of_unbounded_solids();
        for (const Sheet& sheet : world_.sheets)
            world_.features.transparency |= world_.materials[world_.leaves[sheet.leaf].medium].may_be_transparent;
        world_.features.sheets = !world_.sheets.empty();
        for (const std::vector<Solid>* solids : {&world_.solids, &world_.clips})
            for (const Solid& solid : *solids)
                if (solid.deep_tree >= 0)
                    world_.deep_trees[solid.deep_tree] =
                        make_deep_tree(world_, solid, world_.deep_trees[solid.deep_tree].first_node);
    }

    // The leaves of a solid stand together. Mostly they do so already, some perhaps left out.
    void arrange_leaves() {
        std::vector<Leaf>& drafted = drafts_.leaves;
        if (std::adjacent_find(order_.begin(), order_.end(), std::greater_equal<>()) == order_.end()) {
            for (std::size_t i = 0; i < order_.size(); ++i)
                if (const auto from = static_cast<std::size_t>(order_[i]); from != i) drafted[i] = std::move(drafted[from]);
            world_.leaves_left_out = drafted.size() - order_.size();
            drafted.resize(order_.size());
            world_.leaves = std::move(drafted);
        } else {
            std::vector<bool> stands(drafted.size());
            for (std::int32_t leaf : order_) stands[static_cast<std::size_t>(leaf)] = true;
            world_.leaves_left_out = static_cast<std::size_t>(std::count(stands.begin(), stands.end(), false));
            world_.leaves.reserve(order_.size());
            for (std::int32_t leaf : order_) world_.leaves.push_back(drafted[leaf]);
        }
    }

    void emit_sheet(SheetDraft& draft) {
        Sheet sheet;
        for (const SheetDraft::Condition& condition : draft.conditions) {
            if (condition.clip != empty_set) {
                sheet.conditions.push_back({static_cast<std::int32_t>(world_.clips.size()), condition.inside});
                world_.clips.push_back(emit_solid(condition.clip));
            } else if (condition.inside) {
                return;  // clipped to the empty set
            }
        }
        const auto comes_before_sheet = [&](const Solid& solid) { return order_[solid.first_leaf] < draft.leaf; };
        sheet.order = static_cast<std::int32_t>(std::count_if(world_.solids.begin(), world_.solids.end(), comes_before_sheet));
        sheet.leaf = static_cast<std::int32_t>(order_.size());
        order_.push_back(draft.leaf);
        world_.sheets.push_back(std::move(sheet));
    }

    // Leaves whose faces are those of one just before share them with it: what is made in numbers is mostly alike.
    void note_faces(Leaf& leaf) {
        const Surfaces surfaces = leaf.object->surfaces();
        leaf.face_count = static_cast<std::int32_t>(surfaces.size());
        if (surfaces.empty()) return;
        constexpr std::size_t how_far_back = 64;
        const std::size_t count = world_.faces.size();
        const auto recent = world_.faces.end() - static_cast<std::ptrdiff_t>(std::min(count, how_far_back));
        const auto is_same = [](const Surface& a, const Surface& b) {
            return a.kind == b.kind && a.a == b.a && a.b == b.b && a.c == b.c && a.d == b.d;
        };
        const auto found = std::search(recent, world_.faces.end(), surfaces.begin(), surfaces.end(), is_same);
        leaf.first_face = static_cast<std::int32_t>(found - world_.faces.begin());
        if (found == world_.faces.end()) world_.faces.insert(world_.faces.end(), surfaces.begin(), surfaces.end());
    }

    Solid emit_solid(DraftTree tree) {
        Solid solid;
        const std::size_t first_node = world_.nodes.size();
        solid.first_leaf = static_cast<std::int32_t>(order_.size());
        solid.root = emit_tree(tree);
        solid.leaf_count = static_cast<std::int32_t>(order_.size()) - solid.first_leaf;
        for (std::int32_t i = 0; may_be_transparent_ && i < solid.leaf_count; ++i) {
            const Leaf& leaf = drafts_.leaves[order_[solid.first_leaf + i]];
            solid.may_be_transparent |= world_.materials[leaf.medium].may_be_transparent;
        }
        for (std::size_t i = first_node; i < world_.nodes.size(); ++i) {
            const Node& node = world_.nodes[i];
            if (node.medium >= 0) solid.may_be_transparent |= world_.materials[node.medium].may_be_transparent;
            solid.has_interfaces |= node.operation == Operation::union_ || node.operation == Operation::symdiff;
        }
        world_.most_leaves = std::max(world_.most_leaves, solid.leaf_count);
        const Bounds& box = drafts_.box_of(tree);
        solid.rounding = coincidence_tolerance(0, length(box.diagonal()));
        has_unbounded_solids_ |= !box.is_finite();
        if (drafts_.depth(tree) > deepest_followed) {
            solid.deep_tree = static_cast<std::int32_t>(world_.deep_trees.size());
            world_.deep_trees.emplace_back().first_node = static_cast<std::int32_t>(first_node);  // until all leaves stand
        }
        return solid;
    }

    // An operation whose operands are being emitted.
    struct Emission {
        DraftTree tree = 0;
        std::int32_t leftmost = 0;      // leaf below
        std::size_t first_operand = 0;  // in the list of operands under way
    };

    // Operands first, so that a node's index is above those of its operands; with a stack of its own, as trees may be deep.
    std::int32_t emit_tree(DraftTree root) {
        if (root < 0) return emit_leaf(root);
        emissions_.push_back({root, static_cast<std::int32_t>(order_.size()), under_way_.size()});
        for (;;) {
            const Emission& emission = emissions_.back();
            const Draft& draft = drafts_[emission.tree];
            const std::size_t done = under_way_.size() - emission.first_operand;
            if (done == draft.operands.size()) {
                emit_node(draft, emission);
                emissions_.pop_back();
                const auto index = static_cast<std::int32_t>(world_.nodes.size()) - 1;
                if (emissions_.empty()) return index;
                under_way_.push_back(index);
            } else if (const DraftTree next = draft.operands[done]; next < 0) {
                under_way_.push_back(emit_leaf(next));
            } else {
                emissions_.push_back({next, static_cast<std::int32_t>(order_.size()), under_way_.size()});
            }
        }
    }

    std::int32_t emit_leaf(DraftTree leaf) {
        order_.push_back(~leaf);
        return ~(static_cast<std::int32_t>(order_.size()) - 1);
    }

    void emit_node(const Draft& draft, const Emission& emission) {
        Node node;
        node.operation = draft.operation;
        node.box = draft.box;
        node.has_priority = draft.priority.has_value();
        node.priority = draft.priority.value_or(0);
        const std::span<const std::int32_t> operands = std::span(under_way_).subspan(emission.first_operand);
        node.first = static_cast<std::int32_t>(world_.children.size());
        node.count = static_cast<std::int32_t>(operands.size());
        world_.children.insert(world_.children.end(), operands.begin(), operands.end());
        under_way_.resize(emission.first_operand);
        if (draft.operation == Operation::merge) {
            node.owner = emission.leftmost;
            node.medium = draft.medium;
        }
        world_.nodes.push_back(node);
    }

    // What has no bounds is taken to be as large as the scene.
    void set_rounding_of_unbounded_solids() {
        const double scene_size = length(region_of_interest(world_).diagonal());
        for (std::vector<Solid>* solids : {&world_.solids, &world_.clips})
            for (Solid& solid : *solids)
                if (!world_.box_of(solid.root).is_finite()) solid.rounding = coincidence_tolerance(0, scene_size);
    }

    // As the leaves of a solid stand in the order of its tree, those of a product's positive part come first.
    void find_product_form(Solid& solid) {
        std::int32_t positive = solid.root;
        std::span<const std::int32_t> negative;
        if (positive >= 0 && world_.nodes[positive].operation == Operation::subtraction) {
            const std::span<const std::int32_t> operands = world_.operands_of(world_.nodes[positive]);
            positive = operands.front(), negative = operands.subspan(1);
        }
        const auto is_union = [&](std::int32_t operand) { return is_of_leaves(operand, Operation::union_); };
        if (!is_of_leaves(positive, Operation::intersection) || !std::all_of(negative.begin(), negative.end(), is_union)) return;
        solid.positive_count = negative.empty() ? solid.leaf_count : leftmost_leaf(negative.front()) - solid.first_leaf;
        solid.is_product = true;
        put_negative_leaves_into_blocks(solid);
    }

    // Whether a tree is of one operation only, on leaves of which each has one span on any line.
    bool is_of_leaves(std::int32_t tree, Operation operation) const {
        if (tree < 0) return have_one_span_ || has_one_span(world_, world_.leaves[~tree]);
        const Node& node = world_.nodes[tree];
        if (node.operation != operation && !(operation == Operation::union_ && node.operation == Operation::merge)) return false;
        const std::span<const std::int32_t> operands = world_.operands_of(node);
        return std::all_of(operands.begin(), operands.end(),
                           [&](std::int32_t operand) { return is_of_leaves(operand, operation); });
    }

    std::int32_t leftmost_leaf(std::int32_t tree) const {
        while (tree >= 0) tree = world_.operands_of(world_.nodes[tree]).front();
        return ~tree;
    }

    // Few boxes are looked at one by one.
    void put_negative_leaves_into_blocks(Solid& solid) {
        constexpr std::int32_t few = 2;
        if (solid.leaf_count - solid.positive_count <= few) return;
        std::vector<Bounds> boxes;
        for (std::int32_t i = solid.positive_count; i < solid.leaf_count; ++i)
            boxes.push_back(world_.leaves[solid.first_leaf + i].box);
        solid.first_negative_block = add_box_blocks(boxes, anchor_of_blocks(world_.box_of(solid.root)), world_.negative_blocks);
    }

    // Boxes so large that floats cannot hold them go to the list that is always asked.
    void finish_solids() {
        std::vector<Bounds> boxes;
        std::vector<std::int32_t> items;
        boxes.reserve(world_.solids.size());
        items.reserve(world_.solids.size());
        have_one_span_ = world_.most_spans == 1 && !world_.features.shared_surfaces;
        for (std::size_t i = 0; i < world_.solids.size(); ++i) {
            Solid& solid = world_.solids[i];
            if (solid.deep_tree < 0) find_product_form(solid);
            unite_operands(solid);
            const Bounds& box = world_.box_of(solid.root);
            if (fits_hierarchy(box)) {
                boxes.push_back(box);
                items.push_back(static_cast<std::int32_t>(i));
            } else {
                world_.unbounded.push_back(static_cast<std::int32_t>(i));
            }
        }
        world_.hierarchy = Hierarchy(boxes, items);
        for (const Solid& clip : world_.clips) unite_operands(clip);
    }

    // Where a line is followed through a tree from node to node, its nodes with many operands that are united.
    void unite_operands(const Solid& solid) {
        constexpr std::int32_t few = 16;
        if (solid.leaf_count > few && solid.deep_tree < 0 && !solid.is_product) unite_operands(solid.root, few);
    }

    void unite_operands(std::int32_t tree, std::int32_t few) {
        if (tree < 0) return;
        Node& node = world_.nodes[tree];
        const std::span<const std::int32_t> operands = world_.operands_of(node);
        for (std::int32_t operand : operands) unite_operands(operand, few);
        if (node.count <= few || node.operation == Operation::intersection || node.operation == Operation::symdiff) return;
        node.united = static_cast<std::int32_t>(world_.united_operands.size());
        UnitedOperands& united = world_.united_operands.emplace_back();
        std::vector<Bounds> boxes;
        std::vector<std::int32_t> items;
        for (std::int32_t i = node.operation == Operation::subtraction ? 1 : 0; i < node.count; ++i) {
            const Bounds& box = world_.box_of(operands[i]);
            if (fits_hierarchy(box)) {
                boxes.push_back(box);
                items.push_back(i);
            } else {
                united.unbounded.push_back(i);
            }
        }
        united.hierarchy = Hierarchy(boxes, items);
    }

    const Scene& scene_;
    World& world_;
    Messages& messages_;
    Drafts drafts_;
    std::vector<DraftTree> solids_;
    std::vector<SheetDraft> sheets_;
    std::vector<std::int32_t> order_;      // in which the drafted leaves stand in the World
    std::vector<std::int32_t> under_way_;  // operands of what is being drafted or emitted
    std::vector<Emission> emissions_;
    NumberOfAddress known_materials_;
    const SceneMaterial* uniform_source_ = nullptr;  // of the uniform material that was placed last
    std::int32_t uniform_ = no_material;
    std::int32_t leaf_number_ = 0, material_number_ = 1;
    bool may_be_transparent_ = false;  // any material
    bool have_one_span_ = false;       // all leaves
    bool has_unbounded_solids_ = false;
};

}  // namespace

const std::string* World::name_of(const Leaf& leaf) const {
    const auto behind = std::ranges::upper_bound(names, leaf.number, {}, &NameFrom::number);
    return behind == names.begin() ? nullptr : std::prev(behind)->name;
}

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
    const auto run = [&] { Preparer(scene, *world, messages).run(options); };
    if (options.threads > 0)
        tbb::task_arena(options.threads).execute(run);
    else
        run();
    return world;
}

}  // namespace lapidary
