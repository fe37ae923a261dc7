// SPDX-License-Identifier: MIT
#include "kernel/scene/scene.h"

#include <utility>

namespace lapidary {

// The outermost destructor collects the operands of all that die with it and lets go of them one by one, so that the
// stack stays flat however deep the tree is.
SceneNode::~SceneNode() {
    thread_local std::vector<SceneNodePtr>* pending = nullptr;
    if (operands.empty()) return;
    if (pending) {
        for (SceneNodePtr& operand : operands) pending->push_back(std::move(operand));
        return;
    }
    std::vector<SceneNodePtr> released = std::move(operands);
    pending = &released;
    while (!released.empty()) {
        const SceneNodePtr last = std::move(released.back());
        released.pop_back();
    }
    pending = nullptr;
}

}  // namespace lapidary
