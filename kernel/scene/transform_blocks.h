// SPDX-License-Identifier: MIT
//
// `transform { … }`: a list of factors, in the order in which they act.
#pragma once

#include <optional>

#include "kernel/scene/build_context.h"

namespace lapidary {

// Appends the factors of a `transform` block, and defines its name. False where there were errors.
bool read_transform_block(const Block& block, TransformFactors& factors, bool needs_use, BuildContext& context);

// The composition of factors that were found to be invertible one by one; nothing where only their product is not
// finite any more (an error says so).
std::optional<ExactTransform> compose(const TransformFactors& factors, const Place& place, BuildContext& context);

// How a kind of factor is written, for printing.
struct FactorForm {
    std::string_view keyword;
    TransformFactor::Kind kind;
    int count;  // of values
    int angle;  // position of the angle among them; -1: none
    std::string_view arguments;
};
bool is_transform_factor(std::string_view keyword);
const FactorForm& form_of(TransformFactor::Kind kind);

}  // namespace lapidary
