// SPDX-License-Identifier: MIT
//
// Scene -> World: one walk down the trees accumulates transforms, materials and priorities to the leaves; one walk up
// combines the parts that are left. What stands in the unions at the top goes into the World one after the other: nothing is
// kept of the many but what the World needs.
#include <fmt/format.h>

#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <span>
#include <utility>

#include "kernel/math/standard_arithmetic.h"
#include "kernel/prepare/ask_for.h"
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

// Which of the World's materials was the first to be made of a material of the scene: an open table of numbers alone, as with
// hundreds of thousands of them it is memory that takes the time.
class FirstInstances {
public:
    explicit FirstInstances(const std::vector<MaterialInstance>& materials) : materials_(materials) {}

    // The number of the first one; -1, for the caller to change, where there is none. Holds until the next call.
    std::int32_t& operator[](const SceneMaterial* source) {
        if (2 * (count_ + 1) > numbers_.size()) reserve(numbers_.size());
        std::int32_t& number = slot_of(source);
        if (number < 0) ++count_;
        return number;
    }

    void reserve(std::size_t count) {
        const std::size_t slots = std::bit_ceil(2 * std::max(count, count_ + 1));
        if (slots <= numbers_.size()) return;
        std::vector<std::int32_t> old(slots, -1);
        old.swap(numbers_);
        for (std::int32_t number : old)
            if (number >= 0) slot_of(materials_[static_cast<std::size_t>(number)].source) = number;
    }

private:
    std::int32_t& slot_of(const SceneMaterial* source) {
        const std::size_t mask = numbers_.size() - 1;
        // Things made one after the other mostly stand near to one another in memory: here, too.
        const auto bits = std::bit_cast<std::uintptr_t>(source);
        std::size_t i = (bits >> 7 ^ bits >> 26) & mask;
        while (numbers_[i] >= 0 && materials_[static_cast<std::size_t>(numbers_[i])].source != source) i = (i + 1) & mask;
        return numbers_[i];
    }

    const std::vector<MaterialInstance>& materials_;
    std::vector<std::int32_t> numbers_ = std::vector<std::int32_t>(64, -1);
    std::size_t count_ = 0;
};

class Preparer {
public:
    Preparer(const Scene& scene, World& world, Messages& messages)
        : scene_(scene), world_(world), messages_(messages), drafts_(world) {}

    void run(const PrepareOptions& options) {
        world_.root = scene_.root;
        world_.background = scene_.background;
        world_.materials.emplace_back();  // what objects without material are made of
        world_.materials.back().number = 1;
        for (const SceneLight& light : scene_.lights) {
            (light.light->is_ambient() ? world_.ambient_lights : world_.lights).push_back(light.light);
            world_.features.extended_lights |= light.light->has_extent();
        }
        if (scene_.root) prepare_tree(*scene_.root);
        for (SheetDraft& sheet : sheets_) emit_sheet(sheet);
        forget_drafts({});
        if (has_unbounded_solids_) set_rounding_of_unbounded_solids();
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

    // How long the World's lists are.
    struct Counts {
        std::size_t leaves = 0, materials = 0, nodes = 0, children = 0, solids = 0;
    };

    // An operation whose operands are being drafted.
    struct Visit {
        const SceneNode* node = nullptr;
        Surroundings here;
        bool is_at_top = false;         // a union of what are solids of the World one by one
        std::size_t done = 0;           // how many operands have been begun
        std::size_t first_operand = 0;  // in the list of operands under way, those drafted so far; empty ones, too
        std::vector<OperandSheets> sheets;
        std::int32_t leftmost_medium = 0;  // of the leaf written first, whether it is out of reach or not
        Counts before;                     // when it began
    };

    // What has become of a node: its solid, and the sheets that are left, clipped.
    struct Drafted {
        DraftTree tree = empty_set;
        std::vector<SheetDraft> sheets;
        std::int32_t leftmost_medium = 0;
    };

    // The whole tree, depth first with a stack of its own: names can chain nodes a hundred thousand deep.
    void prepare_tree(const SceneNode& root) {
        if (root.operation == Operation::leaf) {
            emit(draft_leaf(root, enter_node(root, {})));
            return;
        }
        std::vector<Visit> stack;
        stack.push_back(visit_of(root, enter_node(root, {}), true));
        while (!stack.empty()) {
            Visit& visit = stack.back();
            if (visit.done == visit.node->operands.size()) {
                std::optional<Drafted> drafted;
                if (!visit.is_at_top) drafted = combine_operands(visit);
                stack.pop_back();
                if (drafted && stack.empty()) emit(std::move(*drafted));
                if (drafted && !stack.empty()) take(stack.back(), std::move(*drafted));
                continue;
            }
            look_ahead(visit.node->operands, visit.done);
            if (visit.done == enough_to_tell) make_room(visit);
            const SceneNode& next = *visit.node->operands[visit.done];
            Surroundings here = enter_node(next, around_operand(visit, visit.done));
            ++visit.done;
            if (next.operation == Operation::leaf)
                take(visit, draft_leaf(next, here));
            else
                stack.push_back(visit_of(next, std::move(here), visit.is_at_top));
        }
    }

    Visit visit_of(const SceneNode& node, Surroundings here, bool is_below_top) const {
        Visit visit;
        visit.node = &node;
        visit.here = std::move(here);
        visit.is_at_top = is_below_top && node.operation == Operation::union_ && !node.priority;
        visit.first_operand = under_way_.size();
        visit.before = counts();
        return visit;
    }

    // Of many operands at the top the first ones tell how much room all of them take, if they are small: lists need not be
    // copied as they grow.
    static constexpr std::size_t enough_to_tell = 256;
    void make_room(const Visit& visit) {
        constexpr std::size_t few = 4;
        const std::size_t done = visit.done, all = visit.node->operands.size();
        if (!visit.is_at_top || all < 16 * done) return;
        const Counts now = counts();
        const auto expected = [&](std::size_t Counts::*list) {
            const std::size_t of_those_done = std::min(now.*list - visit.before.*list, few * done);
            return visit.before.*list + of_those_done * (all + all / 16) / done;
        };
        world_.leaves.reserve(expected(&Counts::leaves));
        world_.materials.reserve(expected(&Counts::materials));
        known_materials_.reserve(expected(&Counts::materials));
        world_.nodes.reserve(expected(&Counts::nodes));
        world_.children.reserve(expected(&Counts::children));
        world_.solids.reserve(expected(&Counts::solids));
        solid_boxes_.reserve(expected(&Counts::solids));
    }

    Counts counts() const {
        return {world_.leaves.size(), world_.materials.size(), world_.nodes.size(), world_.children.size(), world_.solids.size()};
    }

    // Asks for the memory of the operands to come, in steps, each of which needs what the one before asked for: they stand here
    // and there, and to wait for each of them would take as long as all the rest.
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

    // What an operand of a node finds around itself.
    static Surroundings around_operand(const Visit& visit, std::size_t operand) {
        Surroundings around = visit.here;
        const Operation operation = visit.node->operation;
        const bool right_cuts = operation == Operation::subtraction || operation == Operation::intersection;
        if (right_cuts && operand > 0) around.cuts = true, around.appearance = no_material;
        return around;
    }

    void take(Visit& visit, Drafted operand) {
        if (visit.is_at_top) {
            emit(std::move(operand));
            return;
        }
        const std::size_t number = under_way_.size() - visit.first_operand;
        if (number == 0) visit.leftmost_medium = operand.leftmost_medium;
        if (!operand.sheets.empty()) visit.sheets.push_back({number, std::move(operand.sheets)});
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
        DraftLeaf& draft = drafts_.leaves.emplace_back();
        Leaf& leaf = draft.leaf;
        leaf.object = node.object.get();
        leaf.placement = Transform(here.to_world);
        leaf.medium = std::max(here.medium, 0);
        leaf.appearance = here.appearance != no_material ? here.appearance : here.cuts ? no_material : leaf.medium;
        leaf.priority = node.priority.value_or(0);
        leaf.number = ++leaf_number_;
        leaf.source = &node;
        if (here.name != (world_.names.empty() ? nullptr : world_.names.back().name))
            world_.names.push_back({leaf.number, here.name});
        note_faces(leaf);
        draft.box = padded_box(world_, leaf);
        leaf.box = FloatBox(draft.box, leaf.anchor());
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
                    drafts_.leaves[sheet.leaf].leaf.source->place,
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

        const bool is_uniform = material.is_uniform();
        if (is_uniform) uniform_source_ = &scene_material, uniform_ = known;
        if (!is_new && is_uniform) return known;
        MaterialInstance instance;
        instance.source = &scene_material;
        instance.number = is_new ? ++material_number_ : world_.materials[known].number;
        instance.may_be_transparent = material.may_be_transparent();
        may_be_transparent_ |= instance.may_be_transparent;
        world_.features.reflection |= material.may_reflect();
        world_.features.relief |= material.may_have_relief();
        if (is_uniform) {
            const Matter matter = material.evaluate({});
            instance.colour = matter.colour;
            instance.finish = &finish_of(matter);
        } else {
            const Transform placement(to_world);
            const PlacedTexture texture{&material, placement, mean_stretch(placement.inverse_linear())};
            instance.texture = world_.textures.emplace_back(std::make_shared<const PlacedTexture>(texture)).get();
        }
        world_.materials.push_back(instance);
        return index;
    }

    // What is made in numbers is mostly alike but for its colour.
    const Matter& finish_of(const Matter& matter) {
        constexpr std::size_t how_far_back = 16;
        const auto is_same = [&](const std::shared_ptr<const Matter>& other) {
            return other->reflection == matter.reflection && other->refraction == matter.refraction &&
                   other->shininess == matter.shininess && other->opacity == matter.opacity && other->depth == matter.depth &&
                   other->relief == matter.relief;
        };
        auto& finishes = world_.finishes;
        const auto oldest = finishes.rbegin() + static_cast<std::ptrdiff_t>(std::min(finishes.size(), how_far_back));
        const auto found = std::find_if(finishes.rbegin(), oldest, is_same);
        return found != oldest ? **found : *finishes.emplace_back(std::make_shared<const Matter>(matter));
    }

    // What stands at the top: its solids into the World. Sheets wait, as all solids come before them.
    void emit(Drafted drafted) {
        solids_.clear();
        if (drafted.tree != empty_set) drafts_.split_into_solids(drafted.tree, solids_);
        for (DraftTree tree : solids_) {
            const Solid& solid = world_.solids.emplace_back(emit_solid(tree));
            world_.features.transparency |= solid.may_be_transparent;
            const Bounds& box = solid_boxes_.emplace_back(drafts_.box_of(tree));
            if (box.is_finite()) world_.bounds = unite(world_.bounds, box);
        }
        if (drafted.sheets.empty()) {
            forget_drafts(kept_for_sheets_);
            return;
        }
        for (SheetDraft& sheet : drafted.sheets) sheets_.push_back(std::move(sheet));
        kept_for_sheets_ = drafts_.mark();
    }

    // Drafts of which nothing is needed any more.
    void forget_drafts(const Drafts::Mark& since) {
        const auto is_left_out = [](const DraftLeaf& leaf) { return !leaf.stands; };
        const auto first = drafts_.leaves.begin() + static_cast<std::ptrdiff_t>(since.leaves);
        world_.leaves_left_out += static_cast<std::size_t>(std::count_if(first, drafts_.leaves.end(), is_left_out));
        drafts_.forget_since(since);
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
        DraftLeaf& leaf = drafts_.leaves[static_cast<std::size_t>(draft.leaf)];
        const auto comes_before_sheet = [&](const Solid& solid) {
            return world_.leaves[solid.first_leaf].number < leaf.leaf.number;
        };
        sheet.order = static_cast<std::int32_t>(std::count_if(world_.solids.begin(), world_.solids.end(), comes_before_sheet));
        sheet.leaf = ~emit_leaf(leaf);
        world_.features.transparency |= world_.materials[leaf.leaf.medium].may_be_transparent;
        world_.features.sheets = true;
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
        solid.first_leaf = leaf_count();
        solid.root = emit_tree(tree);
        solid.leaf_count = leaf_count() - solid.first_leaf;
        for (std::int32_t i = solid.first_leaf; may_be_transparent_ && i < leaf_count(); ++i)
            solid.may_be_transparent |= world_.materials[world_.leaves[i].medium].may_be_transparent;
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
            world_.deep_trees.push_back(make_deep_tree(world_, solid, static_cast<std::int32_t>(first_node)));
        }
        return solid;
    }

    // An operation whose operands are being emitted.
    struct Emission {
        DraftTree tree = 0;
        std::int32_t leftmost = 0;      // of the leaves below
        std::size_t first_operand = 0;  // in the list of operands under way
    };

    // Operands first, so that a node's index is above those of its operands; with a stack of its own, as trees may be deep.
    std::int32_t emit_tree(DraftTree root) {
        if (root < 0) return emit_leaf(drafts_.leaves[~root]);
        emissions_.push_back({root, leaf_count(), under_way_.size()});
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
                under_way_.push_back(emit_leaf(drafts_.leaves[~next]));
            } else {
                emissions_.push_back({next, leaf_count(), under_way_.size()});
            }
        }
    }

    // A leaf may stand in several solids, where operations are distributed.
    std::int32_t emit_leaf(DraftLeaf& leaf) {
        leaf.stands = true;
        world_.leaves.push_back(leaf.leaf);
        return ~(leaf_count() - 1);
    }

    std::int32_t leaf_count() const { return static_cast<std::int32_t>(world_.leaves.size()); }

    void emit_node(const Draft& draft, const Emission& emission) {
        Node node;
        node.operation = draft.operation;
        node.leftmost = emission.leftmost;
        node.box = FloatBox(draft.box, world_.leaves[emission.leftmost].anchor());
        node.has_priority = draft.priority.has_value();
        node.priority = draft.priority.value_or(0);
        const std::span<const std::int32_t> operands = std::span(under_way_).subspan(emission.first_operand);
        node.first = static_cast<std::int32_t>(world_.children.size());
        node.count = static_cast<std::int32_t>(operands.size());
        world_.children.insert(world_.children.end(), operands.begin(), operands.end());
        under_way_.resize(emission.first_operand);
        if (draft.operation == Operation::merge) node.medium = draft.medium;
        world_.nodes.push_back(node);
    }

    // What has no bounds is taken to be as large as the scene.
    void set_rounding_of_unbounded_solids() {
        const double scene_size = length(region_of_interest(world_).diagonal());
        for (std::vector<Solid>* solids : {&world_.solids, &world_.clips})
            for (Solid& solid : *solids)
                if (!(solid.rounding < infinity)) solid.rounding = coincidence_tolerance(0, scene_size);
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
        find_ball(solid);
        find_hole(solid);
        put_negative_leaves_into_blocks(solid);
    }

    // The first of its positive leaves that is one.
    void find_ball(Solid& solid) const {
        const std::int32_t count = std::min<std::int32_t>(solid.positive_count, INT8_MAX);
        for (std::int32_t p = 0; p < count && solid.ball < 0; ++p)
            if (world_.is_round(world_.leaves[solid.first_leaf + p])) solid.ball = static_cast<std::int8_t>(p);
    }

    // The first of its negative leaves that is a ball as large as the solid: rays run in it from end to end.
    void find_hole(Solid& solid) const {
        if (solid.leaf_count == solid.positive_count) return;
        const std::int32_t count = std::min<std::int32_t>(solid.leaf_count, INT16_MAX);
        const double size = 0.5 * length(world_.box_of(solid.root).diagonal());
        for (std::int32_t n = solid.positive_count; n < count && solid.hole < 0; ++n) {
            const Leaf& leaf = world_.leaves[solid.first_leaf + n];
            if (world_.is_round(leaf) && world_.inner_radius(leaf) > size) solid.hole = static_cast<std::int16_t>(n);
        }
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
            boxes.push_back(world_.leaves[solid.first_leaf + i].bounds());
        solid.first_negative_block = add_box_blocks(boxes, anchor_of_blocks(world_.box_of(solid.root)), world_.negative_blocks);
    }

    void finish_solids() {
        have_one_span_ = world_.most_spans == 1 && !world_.features.shared_surfaces;
        for (Solid& solid : world_.solids) {
            if (solid.deep_tree < 0) find_product_form(solid);
            unite_operands(solid);
        }
        for (const Solid& clip : world_.clips) unite_operands(clip);
        world_.hierarchy = Hierarchy(solid_boxes_, 0, world_.unbounded);
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
        const std::int32_t first = node.operation == Operation::subtraction ? 1 : 0;
        std::vector<Bounds> boxes;
        for (std::int32_t i = first; i < node.count; ++i) boxes.push_back(world_.box_of(operands[i]));
        united.hierarchy = Hierarchy(boxes, first, united.unbounded);
    }

    const Scene& scene_;
    World& world_;
    Messages& messages_;
    Drafts drafts_;
    std::vector<DraftTree> solids_;    // of what is being emitted
    std::vector<Bounds> solid_boxes_;  // of all solids of the World
    std::vector<SheetDraft> sheets_;
    Drafts::Mark kept_for_sheets_;         // what these are made of, and what clips them
    std::vector<std::int32_t> under_way_;  // operands of what is being drafted or emitted
    std::vector<Emission> emissions_;
    FirstInstances known_materials_{world_.materials};
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

const Matter MaterialInstance::plain_matter;
const Transform MaterialInstance::world_itself;

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
