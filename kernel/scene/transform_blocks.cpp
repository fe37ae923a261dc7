// SPDX-License-Identifier: MIT
#include "kernel/scene/transform_blocks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "kernel/scene/properties.h"

namespace lapidary {

namespace {

using Kind = TransformFactor::Kind;

constexpr FactorForm forms[] = {
    {"translate", Kind::translate, 3, -1, "(x, y, z)"},
    {"scale", Kind::scale, 3, -1, "(x, y, z)"},
    {"rotx", Kind::rotx, 1, 0, "(a)"},
    {"roty", Kind::roty, 1, 0, "(a)"},
    {"rotz", Kind::rotz, 1, 0, "(a)"},
    {"rotate", Kind::rotate, 4, 3, "(ax, ay, az, a)"},
    {"shear", Kind::shear, 6, -1, "(xy, xz, yx, yz, zx, zy)"},
    {"matrix", Kind::matrix, 12, -1, "(m11, m12, m13, m21, m22, m23, m31, m32, m33, m41, m42, m43)"},
};

const FactorForm* find_form(std::string_view keyword) {
    for (const FactorForm& form : forms)
        if (form.keyword == keyword) return &form;
    return nullptr;
}

std::vector<std::string> factor_keywords() {
    std::vector<std::string> keywords;
    for (const FactorForm& form : forms) keywords.emplace_back(form.keyword);
    return keywords;
}

bool has_number_count(const Property& property, const FactorForm& form) {
    const auto given = static_cast<int>(property.values.size());
    return given == form.count || (form.kind == Kind::scale && given == 1);
}

// The reason why a factor has no inverse, with what to do about it; nothing where it has one. Translations and
// rotations always do; a scale is quickly looked through; the others are inverted for a try.
std::string singularity_of(const TransformFactor& factor) {
    const auto& v = factor.values;
    switch (factor.kind) {
        case Kind::translate:
        case Kind::rotx:
        case Kind::roty:
        case Kind::rotz:
            return {};
        case Kind::scale:
            for (int i = 0; i < 3; ++i) {
                if (v[i] == 0) return "singular transform: a scale of 0 flattens space; give a number other than 0";
                if (!std::isfinite(1 / v[i])) return "singular transform: a scale this small has no finite inverse";
            }
            return {};
        case Kind::rotate:
            if (v[0] == 0 && v[1] == 0 && v[2] == 0) return "the axis of a rotation must not be (0, 0, 0)";
            break;
        case Kind::shear:
        case Kind::matrix:
            break;
    }
    if (ExactTransform::of(factor)) return {};
    return "singular transform: its determinant is 0, so it flattens space";
}

class TransformReader {
public:
    explicit TransformReader(BuildContext& context) : context_(context) {}

    void read(const Block& block, TransformFactors& factors) {
        const NestingGuard guard(context_, block);
        if (guard.too_deep()) return fail();
        refuse_branches(block, context_);
        for (const Item& item : block.branches.front().items) {
            if (const auto* property = std::get_if<Property>(&item))
                read_factor(*property, factors);
            else if (const auto* reference = std::get_if<Reference>(&item))
                read_reference(*reference, factors);
            else
                read_inner_block(*std::get<std::unique_ptr<Block>>(item), factors);
        }
    }

    bool failed() const { return failed_; }

private:
    void fail() { failed_ = true; }

    void error(const Place& place, std::string text) {
        fail();
        context_.messages.error(place, std::move(text));
    }

    void read_factor(const Property& property, TransformFactors& factors) {
        const FactorForm* form = find_form(property.keyword);
        if (!form) {
            fail();
            return context_.vocabulary.report_property(property, "transform", factor_keywords());
        }
        if (!has_number_count(property, *form)) {
            if (form->kind == Kind::scale)
                return error(property.place, fmt::format("'scale' takes 1 or 3 values, not {}: scale(s); or scale(x, y, z);",
                                                         property.values.size()));
            return error(property.place,
                         takes(property.keyword, std::string(form->arguments), form->count, form->count, property.values.size()));
        }
        TransformFactor factor;
        factor.kind = form->kind;
        for (std::size_t i = 0; i < property.values.size(); ++i) {
            const Value& value = property.values[i];
            if (value.kind != Value::Kind::number)
                return error(value.place, fmt::format("'{0}' takes numbers{1}: {0}{2};", property.keyword,
                                                      constant_meant(value, context_), form->arguments));
            if (!std::isfinite(value.number))
                return error(value.place, fmt::format("'{}' takes finite numbers, not {}", property.keyword, value.number));
            factor.values[i] = value.number;
        }
        if (form->angle >= 0) warn_of_degrees(property.values[static_cast<std::size_t>(form->angle)], context_.messages);
        if (form->kind == Kind::scale && property.values.size() == 1) factor.values[1] = factor.values[2] = factor.values[0];
        if (std::string reason = singularity_of(factor); !reason.empty()) return error(property.place, std::move(reason));
        factors.push_back(factor);
    }

    void read_reference(const Reference& reference, TransformFactors& factors) {
        const NamedThing* thing = context_.names.use(reference);
        if (!thing) return fail();
        if (thing->kind != NameKind::transform)
            return error(reference.place, fmt::format("'{}' is {}", reference.name, home_of(thing->kind)));
        const auto named = thing->get<TransformFactors>();
        factors.insert(factors.end(), named.begin(), named.end());
    }

    // (A B)^-1 = B^-1 A^-1: the factors in reverse order, each inverted.
    void read_inner_block(const Block& block, TransformFactors& factors) {
        if (block.keyword == "inverse") {
            refuse_name(block, context_);
            TransformFactors inner;
            read(block, inner);
            for (auto factor = inner.rbegin(); factor != inner.rend(); ++factor) {
                factor->inverted = !factor->inverted;
                factors.push_back(*factor);
            }
        } else if (block.keyword == "transform") {
            if (!read_transform_block(block, factors, false, context_)) fail();
        } else if (find_form(block.keyword)) {
            error(block.place,
                  fmt::format("'{0}' is written with parentheses: {0}{1};", block.keyword, find_form(block.keyword)->arguments));
        } else {
            fail();
            auto keywords = factor_keywords();
            keywords.emplace_back("inverse");
            context_.vocabulary.report_block(block, {}, std::move(keywords));
        }
    }

    BuildContext& context_;
    bool failed_ = false;
};

}  // namespace

bool is_transform_factor(std::string_view keyword) { return find_form(keyword) != nullptr; }

const FactorForm& form_of(Kind kind) { return *std::ranges::find(forms, kind, &FactorForm::kind); }

bool read_transform_block(const Block& block, TransformFactors& factors, bool needs_use, BuildContext& context) {
    NamedThing* name = context.names.reserve(block, NameKind::transform, needs_use);
    TransformFactors own;
    TransformReader reader(context);
    reader.read(block, own);
    if (name) {
        name->under_way = false;
        if (!reader.failed()) name->value = own;
    }
    factors.insert(factors.end(), own.begin(), own.end());
    return !reader.failed();
}

std::optional<ExactTransform> compose(const TransformFactors& factors, const Place& place, BuildContext& context) {
    if (factors.empty()) return ExactTransform();
    auto composed = ExactTransform::of(factors);
    if (!composed)
        context.messages.error(place,
                               "the transforms of this block multiply to numbers that are not finite, or to a singular map");
    return composed;
}

}  // namespace lapidary
