// SPDX-License-Identifier: MIT
#include "kernel/scene/build_context.h"

#include <fmt/format.h>

namespace lapidary {

void refuse_name(const Block& block, BuildContext& context) {
    if (!block.name.empty())
        context.messages.error(block.name_place, fmt::format("'{}' takes no name; leave out '{}'", block.keyword, block.name));
}

void refuse_branches(const Block& block, BuildContext& context) {
    if (block.branches.size() > 1)
        context.messages.error(block.branches[1].place,
                               fmt::format("'{}' takes no `with`; CSG operations and textures do", block.keyword));
}

}  // namespace lapidary
