// SPDX-License-Identifier: MIT
//
// A child slot of a texture: holds another material and is used like a pointer to it.
//
//     schema.child("even", &Checkers::even_);        // declared
//     return even_->evaluate(site);                  // used, at the texture's own point
//
// Whoever makes the texture fills every slot that is not optional before anything is asked of it; a child with a transform of its
// own arrives wrapped in it. Trees are evaluated and released by plain recursion, one small frame a level: whoever builds
// them bounds how deep they nest (the builder refuses, with a located message, what would be too deep), so that a texture
// can stay as simple as its formula.
#pragma once

#include <utility>

#include "kernel/interfaces/material.h"

namespace lapidary {

class Child {
public:
    Child() = default;
    Child(MaterialPtr material) : material_(std::move(material)) {}
    operator MaterialPtr() const { return material_; }

    const MaterialPtr& material() const { return material_; }
    const Material* operator->() const { return material_.get(); }
    const Material& operator*() const { return *material_; }
    explicit operator bool() const { return material_ != nullptr; }

private:
    MaterialPtr material_;
};

}  // namespace lapidary
