// SPDX-License-Identifier: MIT
//
// Which solids rays may meet on their straight ways from one box to another: from faces to a light.
#pragma once

#include "kernel/csg/solids_in_reach.h"
#include "kernel/export.h"

namespace lapidary {

class LAPIDARY_API ShaftThroughWorld {
public:
    explicit ShaftThroughWorld(const World& world);

    // From now on rays run from one box to the other. Where there are too many solids they are not listed.
    void begin(const Bounds& from, const Bounds& to);

    const SolidsInReach& solids() const { return solids_; }

private:
    // More than these, and packets do better with a hierarchy.
    static constexpr std::size_t most = 16;

    const World& world_;
    double reach_;
    SolidsInReach solids_;
};

}  // namespace lapidary
