// SPDX-License-Identifier: MIT
//
// What the readers of all kinds of blocks share while a Document becomes a Scene.
#pragma once

#include "kernel/scene/names.h"
#include "kernel/scene/object_pool.h"
#include "kernel/scene/scene.h"
#include "kernel/scene/vocabulary.h"

namespace lapidary {

struct BuildContext {
    Messages& messages;
    const std::vector<std::string>& constants;  // names of numbers, for suggestions
    NameTable names;
    Vocabulary vocabulary;
    ObjectPool objects{};
    int nesting = 0;                          // blocks around the one that is being read
    SceneMaterialPtr plain_matter = nullptr;  // made last
};

// Blocks inside blocks are read by recursion; this keeps it bounded.
class NestingGuard {
public:
    static constexpr int limit = 1000;

    NestingGuard(BuildContext& context, const Block& block) : context_(context) {
        if (++context_.nesting > limit)
            context_.messages.error(block.place,
                                    "blocks are nested more than 1000 deep; name some of them and refer to the names");
    }
    ~NestingGuard() { --context_.nesting; }
    NestingGuard(const NestingGuard&) = delete;
    NestingGuard& operator=(const NestingGuard&) = delete;

    bool too_deep() const { return context_.nesting > limit; }

private:
    BuildContext& context_;
};

// Errors for what a kind of block cannot have: `camera eye { … }`, `camera { … } with { … }`.
void refuse_name(const Block& block, BuildContext& context);
void refuse_branches(const Block& block, BuildContext& context);

}  // namespace lapidary
