// SPDX-License-Identifier: MIT
//
// The base of all leaves of texture trees: what every matter has beside its own formula, declared once.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "kernel/interfaces/material.h"
#include "kernel/registry/schema.h"
#include "lapidary/noise.h"

namespace lapidary {

// A relief in place of a leaf's own: `relief("noise", frequency)` is h(p) = noise(frequency p).
struct Relief {
    std::string kind;
    double frequency = 1;
};

template <>
struct MemberTraits<Relief> {
    static constexpr Shape shape = Shape::number;
    static constexpr Shape shapes[] = {Shape::text, Shape::number};
    static constexpr int count = 2;
    static Relief from(const Value* v) { return {v[0].text, v[1].number}; }
    static void to(const Relief& m, std::vector<Value>& out) {
        out.push_back(text_value(m.kind));
        out.push_back(number_value(m.frequency));
    }
};

class Leaf : public Material {
public:
    // A leaf with the same values everywhere; one whose colour or relief varies overrides these.
    bool is_uniform() const override { return !may_have_relief(); }
    bool may_be_transparent() const override { return refraction_.has_value(); }
    bool may_reflect() const override { return reflection_ > 0; }
    bool may_have_relief() const override { return bump_ != 0 && relief_.has_value(); }

protected:
    // The defaults that a kind of matter may have of its own.
    explicit Leaf(double bump = 0) : bump_(bump) {}
    void set_colour(const Colour& colour) { colour_ = colour; }

    // Everything that leaves have in common but their colours.
    template <class T>
    static void describe_finish(Schema<T>& schema) {
        schema.add("reflection", &Leaf::reflection_).between(0, 1).help("The part of the result that is mirrored.");
        schema.add("refraction", &Leaf::refraction_)
            .above(0)
            .help("Refractive index against empty space; makes the material transparent.");
        schema.add("shininess", &Leaf::shininess_).at_least(0).help("Exponent of the highlight: the higher, the smaller.");
        schema.add("opacity", &Leaf::opacity_)
            .between(0, 1)
            .help("With refraction: the part of the surface that is lit like an opaque one.");
        schema.add("depth", &Leaf::depth_)
            .unit(Unit::length)
            .above(0)
            .help("With refraction: the length over which white light takes on the colour.");
        schema.add("bump", &Leaf::bump_).help("How strongly the relief turns the shading normal.");
        schema.add("relief", &Leaf::relief_)
            .arguments("\"noise\", frequency")
            .help("A relief of noise in place of the material's own; bump is its height.");
        schema.require("the relief must be \"noise\"",
                       [](const T& leaf) { return !leaf.relief_ || leaf.relief_->kind == "noise"; });
    }

    // The common properties of a leaf of one colour, and where the others with several begin.
    template <class T>
    static void describe_common(Schema<T>& schema) {
        schema.add("colour", &Leaf::colour_)
            .at_least(0)
            .help("Diffuse colour; of a transparent material, what is left of white light after `depth`.");
        describe_finish(schema);
    }

    // Matter of a colour, with the slope of the leaf's own relief, if it has one.
    Matter matter(const Colour& colour, const Point& point, const Vector& own_slope = {}) const {
        Matter m;
        m.colour = colour;
        m.reflection = reflection_;
        m.refraction = refraction_.value_or(0);
        m.shininess = shininess_;
        m.opacity = opacity_;
        m.depth = depth_;
        if (bump_ != 0) m.relief = bump_ * (relief_ ? noise_slope(point) : own_slope);
        return m;
    }

    const Colour& colour() const { return colour_; }
    double bump() const { return bump_; }

private:
    // The gradient of h(p) = noise(f p).
    Vector noise_slope(const Point& p) const {
        const double f = relief_->frequency;
        return f * noise_with_gradient({f * p.x, f * p.y, f * p.z}).gradient;
    }

    Colour colour_ = Colour::white();
    double reflection_ = 0;
    std::optional<double> refraction_;
    double shininess_ = 10;
    double opacity_ = 0;
    double depth_ = 1;
    double bump_ = 0;
    std::optional<Relief> relief_;
};

}  // namespace lapidary
