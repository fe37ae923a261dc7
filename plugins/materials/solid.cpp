// SPDX-License-Identifier: MIT
//
// solid: the same matter everywhere.

#include <lapidary/plugin.h>

namespace lapidary {

class Solid final : public Leaf {
public:
    static void describe(Schema<Solid>& schema) {
        schema.summary("The same matter everywhere.");
        describe_common(schema);
    }

    Matter evaluate(const Site& site) const override { return matter(colour(), site.point); }
};

LAPIDARY_PLUGIN(Solid)

}  // namespace lapidary
