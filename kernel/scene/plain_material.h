// SPDX-License-Identifier: MIT
//
// The kernel's own matter: one colour everywhere. It stands for `colour` and `shininess` written directly in an object,
// and for a number or colour in the place of a texture's child.
#pragma once

#include "kernel/interfaces/material.h"

namespace lapidary {

class LAPIDARY_API PlainMaterial final : public Material {
public:
    PlainMaterial(const Colour& colour, double shininess) {
        matter_.colour = colour;
        matter_.shininess = shininess;
    }

    const Matter& matter() const { return matter_; }

    Matter evaluate(const Site&) const override { return matter_; }
    bool is_uniform() const override { return true; }
    bool may_be_transparent() const override { return false; }
    bool may_reflect() const override { return false; }
    bool may_have_relief() const override { return false; }

private:
    Matter matter_;
};

}  // namespace lapidary
