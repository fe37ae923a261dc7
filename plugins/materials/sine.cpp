// SPDX-License-Identifier: MIT
//
// sine: two colours in waves along x, with the wave itself as relief.
//
// The height is h(p) = sin x, its slope along x cos x, and the colours are mixed by (1 + sin x) / 2: the first lies in
// the troughs, the second on the crests.

#include <lapidary/plugin.h>

namespace lapidary {

class Sine final : public Leaf {
public:
    Sine() : Leaf(1) {}

    static void describe(Schema<Sine>& schema) {
        schema.summary("Two colours in waves of period 2 pi along x, with a relief of the same waves.");
        schema.add("colour", &Sine::colours_)
            .at_least(0)
            .help("The colour in the troughs, white by default; written twice, the second is that on the crests.");
        schema.add("colour2", &Sine::crest_).at_least(0).help("The colour on the crests, black by default.");
        describe_finish(schema);
        schema.require("a sine has two colours: write `colour` at most twice, or once with `colour2`",
                       [](const Sine& s) { return s.colours_.size() + (s.crest_ ? 1 : 0) <= 2; });
    }

    Matter evaluate(const Site& site) const override {
        const double height = std::sin(site.point.x);
        const double slope = bump() != 0 ? std::cos(site.point.x) : 0;
        return matter(mix(trough(), crest(), (1 + height) / 2), site.point, {slope, 0, 0});
    }

    bool is_uniform() const override { return false; }
    bool may_have_relief() const override { return bump() != 0; }

private:
    Colour trough() const { return colours_.empty() ? Colour::white() : colours_[0]; }
    Colour crest() const { return crest_ ? *crest_ : colours_.size() > 1 ? colours_[1] : Colour::black(); }

    std::vector<Colour> colours_;
    std::optional<Colour> crest_;
};

LAPIDARY_PLUGIN(Sine)

}  // namespace lapidary
