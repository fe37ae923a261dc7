// SPDX-License-Identifier: MIT
//
// Objects that are written alike are one: what is made in numbers is mostly alike, and rays find what they ask of it near at
// hand.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "kernel/interfaces/object.h"
#include "kernel/registry/registry.h"
#include "kernel/scene/document.h"

namespace lapidary {

// A property as it stands in a block.
struct GivenProperty {
    const PropertySchema* schema;
    const Property* property;
};

// Keeps some of the objects that were made last. The blocks that they were read from must stay where they are.
class ObjectPool {
public:
    // The object, read with these properties; or, in its place, an earlier one of the same plugin and the same properties.
    std::shared_ptr<const Object> share(std::shared_ptr<const Object> object, const Plugin& plugin,
                                        std::vector<GivenProperty> properties);

private:
    struct Kept {
        std::uint64_t hash = 0;
        const Plugin* plugin = nullptr;
        std::vector<GivenProperty> properties;
        std::shared_ptr<const Object> object;
    };
    std::vector<Kept> kept_ = std::vector<Kept>(256);  // each where a hash of its numbers says
};

}  // namespace lapidary
