// SPDX-License-Identifier: MIT
//
// halfspace: everything below the plane y = 0.

#include <lapidary/plugin.h>

namespace lapidary {

class Halfspace final : public ConvexObject<Halfspace> {
public:
    static void describe(Schema<Halfspace>& schema) { schema.summary("Everything below the plane y = 0."); }

    Bounds bounds() const override { return {{-infinity, -infinity, -infinity}, {infinity, 0, infinity}}; }

    Span span(const LocalLine& line) const { return half_space_span(line, 0, 1, 0, 0); }

    Normal normal(const Hit&) const override { return {0, 1, 0}; }

    Surfaces surfaces() const override { return {Surface::plane(0, 1, 0, 0)}; }
};

LAPIDARY_PLUGIN(Halfspace)

}  // namespace lapidary
