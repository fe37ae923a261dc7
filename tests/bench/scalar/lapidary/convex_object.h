// SPDX-License-Identifier: MIT
//
// Stands in for the SDK's header of this name, to measure what batches bring: of a convex solid there is the scalar form only,
// and batches are the loops over it that Object has.
#pragma once

#include "kernel/interfaces/object.h"
#include "kernel/math/roots.h"

namespace lapidary {

template <class Solid>
class ConvexObject : public Object {
public:
    int max_spans() const final { return 1; }

    int spans(const LocalLine& line, Span* out) const final {
        *out = solid().span(line);
        return solid().is_sheet() ? out->in <= out->out : out->in < out->out;
    }

private:
    const Solid& solid() const { return static_cast<const Solid&>(*this); }
};

}  // namespace lapidary
