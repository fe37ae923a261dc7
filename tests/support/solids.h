// SPDX-License-Identifier: MIT
//
// Solids made in code: leaves from the built plugins, placed by chains of factors, combined by operations.
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "kernel/csg/line_through_solid.h"
#include "kernel/interfaces/object.h"
#include "kernel/prepare/world.h"
#include "kernel/registry/registry.h"
#include "kernel/scene/scene.h"
#include "support/catch.h"

namespace lapidary {

using Factors = std::vector<TransformFactor>;

inline TransformFactor translate(double x, double y, double z) { return {TransformFactor::Kind::translate, {x, y, z}, false}; }
inline TransformFactor scale(double x, double y, double z) { return {TransformFactor::Kind::scale, {x, y, z}, false}; }
inline TransformFactor rotate(const Vector& axis, double angle) {
    return {TransformFactor::Kind::rotate, {axis.x, axis.y, axis.z, angle}, false};
}

class SolidMaker {
public:
    explicit SolidMaker(unsigned seed = 1) : random(seed) {}

    // A leaf with properties as the language would write them: {"radii", {2, 0.5}}.
    SceneNodePtr leaf(const std::string& keyword, Factors factors = {},
                      const std::vector<std::pair<std::string, std::vector<double>>>& properties = {}) {
        std::string reason;
        const Plugin* plugin = registry().find(PluginKind::object, keyword, reason);
        REQUIRE(plugin);
        std::shared_ptr<Object> object = plugin->create_object();
        for (const auto& [name, numbers] : properties) {
            const PropertySchema* property = plugin->schema().find(name);
            REQUIRE(property);
            std::vector<Value> values;
            for (double number : numbers) values.push_back(number_value(number));
            property->assign(dynamic_cast<void*>(object.get()), values);
        }
        plugin->schema().derive(dynamic_cast<void*>(object.get()));
        auto node = std::make_shared<SceneNode>();
        node->object = std::move(object);
        node->plugin = plugin;
        place(*node, std::move(factors));
        return node;
    }

    SceneNodePtr combine(Operation operation, std::vector<SceneNodePtr> operands, Factors factors = {}) {
        auto node = std::make_shared<SceneNode>();
        node->operation = operation;
        node->operands = std::move(operands);
        place(*node, std::move(factors));
        return node;
    }

    // A chain of `length` rotations and scales about the origin, and back: the identity but for rounding, by another way
    // every time.
    Factors there_and_back(int length) {
        std::uniform_real_distribution<double> uniform(-1, 1);
        Factors there, back;
        for (int i = 0; i < length; ++i) {
            const Vector axis{uniform(random), uniform(random), uniform(random) + 1.5};
            const double angle = 3 * uniform(random);
            there.push_back(rotate(axis, angle));
            back.insert(back.begin(), rotate(axis, -angle));
            const double s = std::exp(uniform(random));
            there.push_back(scale(s, s, s));
            back.insert(back.begin(), {TransformFactor::Kind::scale, {s, s, s}, true});
        }
        there.insert(there.end(), back.begin(), back.end());
        return there;
    }

    std::mt19937_64 random;

private:
    static Registry& registry() {
        static Registry found({LAPIDARY_PLUGIN_FOLDER});
        return found;
    }
    static void place(SceneNode& node, Factors factors) {
        const auto composed = ExactTransform::of(factors);
        REQUIRE(composed);
        node.factors = std::move(factors);
        node.transform = *composed;
    }
};

// A World of one tree, or of several side by side, and the spans of rays through it.
class SpansThrough {
public:
    explicit SpansThrough(const SceneNodePtr& root) : SpansThrough(std::vector<SceneNodePtr>{root}) {}

    explicit SpansThrough(const std::vector<SceneNodePtr>& roots) {
        auto all = std::make_shared<SceneNode>();
        all->operation = Operation::union_;
        all->operands = roots;
        Scene scene;
        scene.root = all;
        use(prepare_world(scene, messages));
        assign_solids(roots);
    }

    explicit SpansThrough(std::shared_ptr<const World> world) { use(std::move(world)); }

    const World& world() const { return *world_; }
    const TraceStatistics& statistics() const { return statistics_; }

    // Where the ray runs inside the union of all solids of the World, from its origin on. Solids are merged by their ends
    // as they are, without any tolerance.
    std::vector<Span> operator()(const Ray& ray) { return spans(ray, all_); }

    // The same for the solids of one of the roots only.
    std::vector<Span> operator()(const Ray& ray, std::size_t root) { return spans(ray, of_root_[root]); }

    // The numbers, in the order of writing, of the leaf whose face stands at t and of the leaf that owns the cell behind it. 0:
    // of none.
    struct LeavesAt {
        std::int32_t face = 0, owner = 0;
        bool operator==(const LeavesAt&) const = default;
    };
    LeavesAt leaves_at(const Ray& ray, double t) {
        line_->start(ray);
        LeavesAt found;
        const auto number = [this](std::int32_t leaf) { return leaf < 0 ? 0 : world_->leaves[leaf].number; };
        for (const Solid& solid : world_->solids) {
            line_->select(solid);
            if (found.face == 0) found.face = number(line_->leaf_at(t));
            if (found.owner == 0) found.owner = number(line_->label(t, Side::after).owner);
        }
        return found;
    }

    // All places where the one solid of the World, or what it is made of, changes.
    std::vector<double> changes(const Ray& ray) {
        REQUIRE(world_->solids.size() == 1);
        line_->start(ray);
        line_->select(world_->solids[0]);
        std::vector<double> places;
        for (double t = line_->next_change(0); t < infinity; t = line_->next_change(t)) places.push_back(t);
        return places;
    }

    Messages messages;

private:
    using Solids = std::vector<const Solid*>;

    void use(std::shared_ptr<const World> world) {
        world_ = std::move(world);
        line_ = std::make_unique<LineThroughSolid>(*world_, statistics_);
        for (const Solid& solid : world_->solids) all_.push_back(&solid);
    }

    // Leaves are numbered in the order of writing, those that are left out later included.
    void assign_solids(const std::vector<SceneNodePtr>& roots) {
        std::vector<std::int32_t> last;
        for (const SceneNodePtr& root : roots) last.push_back((last.empty() ? 0 : last.back()) + count_leaves(*root));
        of_root_.resize(roots.size());
        for (const Solid& solid : world_->solids) {
            const auto root = std::lower_bound(last.begin(), last.end(), world_->leaves[solid.first_leaf].number) - last.begin();
            of_root_[static_cast<std::size_t>(root)].push_back(&solid);
        }
    }

    // Trees may be very deep.
    static std::int32_t count_leaves(const SceneNode& root) {
        std::int32_t leaves = 0;
        std::vector<const SceneNode*> pending{&root};
        while (!pending.empty()) {
            const SceneNode* node = pending.back();
            pending.pop_back();
            leaves += node->operation == Operation::leaf;
            for (const SceneNodePtr& operand : node->operands) pending.push_back(operand.get());
        }
        return leaves;
    }

    std::vector<Span> spans(const Ray& ray, const Solids& solids) {
        line_->start(ray);
        std::vector<Span> spans;
        for (double t = 0; t < infinity;) {
            const double in = enter(t, solids);
            if (in == infinity) break;
            const double out = leave(in, solids);
            spans.push_back({in, out});
            t = out;
        }
        return spans;
    }

    // The smallest t' >= t inside any solid.
    double enter(double t, const Solids& solids) {
        double first = infinity;
        for (const Solid* solid : solids) {
            line_->select(*solid);
            first = std::min(first, line_->enter(t));
        }
        return first;
    }

    // The smallest t' >= t outside of all.
    double leave(double t, const Solids& solids) {
        for (bool unchanged = false; !unchanged && t < infinity;) {
            unchanged = true;
            for (const Solid* solid : solids) {
                line_->select(*solid);
                const double out = line_->leave(t);
                if (out != t) unchanged = false;
                t = out;
            }
        }
        return t;
    }

    TraceStatistics statistics_;
    std::shared_ptr<const World> world_;
    std::unique_ptr<LineThroughSolid> line_;
    Solids all_;
    std::vector<Solids> of_root_;
};

inline Ray ray_from(const Point& origin, const Vector& direction) { return {origin, normalize(direction), {}, {}}; }

// The same line backward, from a place ahead on it. A distance that is a power of two takes nothing from the place's digits.
inline Ray reversed(const Ray& ray, double distance) {
    return {{ray.origin.anchor, ray.origin.offset + distance * ray.direction}, -ray.direction, {}, ray.key};
}

// A ray that departs from a face, as the renderer makes it.
inline Ray ray_off(const FaceHit& face, const Vector& direction) {
    const Normal outward = face.class_flipped ? -face.normal : face.normal;
    return {face.point, direction, {face.leaf, face.surface_class, dot(direction, outward) < 0}, {}};
}

}  // namespace lapidary
