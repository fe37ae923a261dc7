// SPDX-License-Identifier: MIT
//
// The names of a scene: each is defined once, above its use, and stands for an object, a material, a light or a
// transform.
#pragma once

#include <deque>
#include <string>
#include <string_view>
#include <unordered_map>
#include <variant>
#include <vector>

#include "kernel/report/messages.h"
#include "kernel/scene/document.h"
#include "kernel/scene/scene.h"

namespace lapidary {

enum class NameKind : std::uint8_t { object, material, light, transform };

using TransformFactors = std::vector<TransformFactor>;

// A light as written, not yet placed in the world.
struct LightPrototype {
    std::shared_ptr<const Light> light;
    const Plugin* plugin = nullptr;
    TransformFactors factors;
    std::string name;
    Place place;
};
using LightPrototypePtr = std::shared_ptr<const LightPrototype>;

struct NamedThing {
    std::string name;
    NameKind kind = NameKind::object;
    Place place;             // of the name in its definition
    bool under_way = true;   // its block is still being read
    bool needs_use = false;  // stands where it only defines the name
    bool used = false;
    // Empty where the block had errors: these have been reported, so uses stay silent.
    std::variant<std::monostate, SceneNodePtr, SceneMaterialPtr, LightPrototypePtr, TransformFactors> value;

    template <class T>
    T get() const {
        const T* held = std::get_if<T>(&value);
        return held ? *held : T{};
    }
};

class NameTable {
public:
    NameTable(const Document& document, Messages& messages) : document_(document), messages_(messages) {}

    // Reserves the name of a block whose reading begins. Null where it has none, or where it is taken (an error).
    NamedThing* reserve(const Block& block, NameKind kind, bool needs_use);
    // What a reference stands for; null where nothing can be used (an error says why).
    const NamedThing* use(const Reference& reference);
    std::size_t size() const { return things_.size(); }
    // Warns of definitions that nothing used.
    void report_unused() const;

private:
    void report_unknown(const Reference& reference);
    void collect_definitions(const Items& items);

    const Document& document_;
    Messages& messages_;
    std::deque<NamedThing> things_;  // in the order of definition
    std::unordered_map<std::string_view, NamedThing*> by_name_;
    // Every name that the document defines anywhere; filled when the first unknown name wants to know.
    std::unordered_map<std::string_view, Place> defined_anywhere_;
    bool collected_ = false;
    static constexpr int most_suggestions = 20;
    int unknown_ = 0;
};

// "file:line:column", for messages that point to a second place.
std::string describe(const Place& place);

}  // namespace lapidary
