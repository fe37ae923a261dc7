// SPDX-License-Identifier: MIT
//
// T93: every number that a scene can hold, in turn no number, infinite, minus zero, denormal or near the largest. The scene is
// refused with a place, or gives a picture of finite colours; it never crashes. T94: samples that are no numbers all the same.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "kernel/prepare/world.h"
#include "kernel/render/passes.h"
#include "kernel/render/render.h"
#include "support/catch.h"
#include "support/measurement.h"
#include "support/scenes.h"

namespace lapidary {

namespace {

const std::vector<std::string> bad_numbers{"0/0",    "1/0",   "-1/0",   "log(0)", "sqrt(-1)", "-0",      "5e-324",     "-1e-310",
                                           "2e-308", "1e308", "-1e308", "1e-160", "1e160",    "1.8e308", "1e308+1e308"};

enum class Outcome { refused, rendered, wrong };

// Renders a scene of a few pixels, or finds that it was refused with a place.
Outcome outcome_of(const std::string& text) {
    const auto built = test::build(text);
    if (!built->scene) {
        const std::vector<Message> all = built->messages.all();
        const bool told = std::all_of(all.begin(), all.end(), [](const Message& message) { return message.line > 0; });
        return told && built->messages.has_errors() ? Outcome::refused : Outcome::wrong;
    }
    const auto world = prepare_world(*built->scene, built->messages);
    Frame frame(6, 5, {});
    RenderOptions options;
    options.threads = 1;
    options.samples = 2;
    const RenderReport report = render(*world, *built->scene, frame, options);
    const std::span<const float> colours = frame.layer(Layer::colour);
    const bool finite = std::all_of(colours.begin(), colours.end(), [](float value) { return std::isfinite(value); });
    return report.complete && finite ? Outcome::rendered : Outcome::wrong;
}

// Puts every bad number in the place of every number that is marked by `@`: of scale(@2, @3) makes scale(BAD, 3), scale(2, BAD).
struct Tally {
    int refused = 0, rendered = 0;
    test::Measurement measured;

    explicit Tally(const std::string& what) : measured({"T93", "bad numbers in " + what, "", 0}) {}
    void count(const std::string& text) {
        const Outcome outcome = outcome_of(text);
        if (outcome == Outcome::wrong) UNSCOPED_INFO(text);
        measured.expect(outcome != Outcome::wrong);
        ++(outcome == Outcome::refused ? refused : rendered);
    }
};
// All of them, or one for each place, another one every time.
enum class Extent { all, one_each };
void try_everywhere(const std::string& pattern, Tally& tally, Extent extent = Extent::all) {
    const auto with = [&](std::size_t chosen, const std::string& bad) {
        std::string text;
        std::size_t place = 0;
        for (std::size_t i = 0; i < pattern.size(); ++i) {
            if (pattern[i] != '@') {
                text += pattern[i];
                continue;
            }
            if (place++ != chosen) continue;
            text += bad;
            while (i + 1 < pattern.size() && pattern[i + 1] != ',' && pattern[i + 1] != ')' && pattern[i + 1] != ';') ++i;
        }
        return text;
    };
    const auto places = static_cast<std::size_t>(std::count(pattern.begin(), pattern.end(), '@'));
    REQUIRE(places > 0);
    for (std::size_t place = 0; place < places; ++place)
        for (std::size_t i = 0; i < (extent == Extent::all ? bad_numbers.size() : 1); ++i) {
            const auto tried = static_cast<std::size_t>(tally.refused + tally.rendered);
            const std::string& bad = bad_numbers[extent == Extent::all ? i : tried % bad_numbers.size()];
            tally.count(with(place, bad));
        }
}

const std::string light = "lights { ambient { } point { location(-3, 4, -4); intensity(30); } } ";
const std::string ball = "objects { sphere { } cube { transform { translate(0, -2, 0); } } } ";

// A property as a scene writes it, its numbers marked, with values of the default instance where it has some.
std::string marked(const PropertySchema& property, const std::vector<std::vector<Value>>& lines) {
    std::string text = property.name + "(";
    for (int i = 0; i < property.least_values; ++i) {
        const auto at = static_cast<std::size_t>(i);
        const bool known = !lines.empty() && at < lines[0].size();
        if (i > 0) text += ", ";
        const Shape shape = property.shape_at(at);
        if (shape == Shape::text) return {};
        if (shape == Shape::word)
            text += property.words.front();
        else
            text += "@" + (known ? std::to_string(lines[0][at].number) : std::string("1"));
    }
    return text + ");";
}

// Properties of all plugins of a kind, as patterns around which `scene` puts a whole scene.
template <class MakeInstance, class Scene>
void try_properties(const std::string& what, PluginKind kind, Extent extent, MakeInstance make_instance, Scene scene) {
    Registry registry({LAPIDARY_PLUGIN_FOLDER});
    Tally tally(what);
    int properties = 0;
    for (const std::string& keyword : registry.keywords(kind)) {
        std::string reason;
        const Plugin* plugin = registry.find(kind, keyword, reason);
        REQUIRE(plugin);
        const auto instance = make_instance(*plugin);
        for (const PropertySchema& property : plugin->schema().properties()) {
            const std::string pattern = marked(property, property.read(dynamic_cast<void*>(instance.get())));
            if (pattern.find('@') == std::string::npos) continue;
            ++properties;
            try_everywhere(scene(*plugin, pattern), tally, extent);
        }
    }
    CHECK(properties > 5);
    CHECK(tally.refused > 0);
    CHECK(tally.rendered > 0);
}

void try_textures(Extent extent) {
    try_properties(
        "textures", PluginKind::material, extent, [](const Plugin& plugin) { return plugin.create_material(); },
        [](const Plugin& plugin, const std::string& property) {
            std::string children;
            for (std::size_t i = 0; i < plugin.schema().children().size(); ++i)
                children += i % 2 ? "solid { colour(1, 0, 0); } " : "solid { refraction(1.5); } ";
            return light + "objects { sphere { material { " + plugin.keyword() + " { " + children + property + " } } } }";
        });
}

}  // namespace

TEST_CASE("T93 Bad numbers in every property of every object") {
    try_properties(
        "objects", PluginKind::object, Extent::all, [](const Plugin& plugin) { return plugin.create_object(); },
        [](const Plugin& plugin, const std::string& property) {
            return light + "objects { subtraction { " + plugin.keyword() + " { " + property + " } sphere { radius(0.3); } } }";
        });
}

TEST_CASE("T93 A bad number in every property of every texture") { try_textures(Extent::one_each); }

TEST_CASE("T93 Bad numbers in every property of every texture", "[.long]") { try_textures(Extent::all); }

TEST_CASE("T93 Bad numbers in every property of every light") {
    try_properties(
        "lights", PluginKind::light, Extent::all, [](const Plugin& plugin) { return plugin.create_light(); },
        [](const Plugin& plugin, const std::string& property) {
            return "lights { " + plugin.keyword() + " { " + property + " } } " + ball;
        });
}

TEST_CASE("T93 Bad numbers in the blocks of the language") {
    const std::string pattern = GENERATE(
        as<std::string>{}, "camera { location(@0, @0, @-5); }", "camera { location(0, 0, -5); look_at(@0, @0, @0); }",
        "camera { location(0, 0, -5); up(@0, @1, @0); }", "camera { location(0, 0, -5); angle(@1); }",
        "camera { location(0, 0, -5); focus(@5); aperture(0.5); }", "camera { location(0, 0, -5); focus(5); aperture(@0.5); }",
        "camera { location(0, 0, -5); points(@3); rays(2); }", "camera { location(0, 0, -5); rays(@3); }",
        "camera { projection(orthographic); location(0, 0, -5); screen { size(@3, @2); } }",
        "camera { location(0, 0, -5); screen { location(@0, @0, @-4); size(@1, @1); } }", "background(@1, @0.5, @0);",
        "render { depth(@4); }", "render { cutoff(@0.1); }", "render { error(@0.1); }", R"(render { filter("mitchell", @1); })");
    Tally tally("the blocks of the language");
    try_everywhere(light + ball + pattern, tally);
    CHECK(tally.refused > 0);
    CHECK(tally.rendered > 0);
}

TEST_CASE("T93 Bad numbers in what stands in any object") {
    const std::string pattern = GENERATE(
        as<std::string>{}, "translate(@0, @0, @0);", "scale(@1);", "scale(@1, @1, @1);", "rotx(@1);", "roty(@1);", "rotz(@1);",
        "rotate(@0, @1, @0, @1);", "shear(@0, @0, @0, @0, @0, @0);", "matrix(@1, @0, @0, @0, @1, @0, @0, @0, @1, @0, @0, @0);",
        "inverse { scale(@1, @1, @1); translate(@1, @1, @1); }");
    Tally tally("placements and what any object has");
    for (const char* object : {"sphere { ", "cube { ", "torus { ", "union { sphere { } cone { } "})
        try_everywhere(light + "objects { halfspace { } " + object + "transform { " + pattern + " } } }", tally);
    for (const char* property : {"priority(@1);", "colour(@1, @1, @1);", "shininess(@10);"})
        try_everywhere(light + "objects { sphere { " + property + " } }", tally);
    try_everywhere(light + "objects { sphere { material { solid { transform { " + pattern + " } } } } }", tally);
    CHECK(tally.refused > 0);
    CHECK(tally.rendered > 0);
}

TEST_CASE("T94 Samples that are no numbers are dropped, and counted") {
    // Of eight samples a pixel, one is no number and one infinite.
    class Poisoned final : public Integrand {
    public:
        void trace(std::span<const RayPacket> rays, std::span<Colour> colours, std::span<FirstFace>) override {
            for (std::size_t i = 0; i < colours.size(); ++i)
                colours[i] = colour_of(rays[i / batch_size].ray(static_cast<int>(i % batch_size)).key.sample);
        }

    private:
        static Colour colour_of(std::uint32_t sample) {
            if (sample == 2) return {std::numeric_limits<double>::quiet_NaN(), 0, 0};
            if (sample == 3) return {0, infinity, 0};
            return Colour::grey(0.5);
        }
    };
    Frame frame(16, 16, {});
    SamplingPlan plan;
    plan.samples = 8;
    const RenderReport report = render_passes([] { return std::make_unique<Poisoned>(); }, CameraRays({}, 16, 16),
                                              PixelFilter(RenderSettings::Filter::box, 0.5), plan, frame, {});
    test::Measurement dropped({"T94", "pixels with samples that are no numbers", "", 0});
    for (const float value : frame.layer(Layer::colour)) dropped.expect(value == 0.5f);
    dropped.expect(report.trace.non_finite_samples == 2 * report.pixels);
}

TEST_CASE("T93 Bad numbers in constants, loops and resolutions") {
    Tally tally("constants, loops and resolutions");
    try_everywhere(light + "let a = @1; objects { sphere { radius(2 + a - a); } }", tally);
    try_everywhere(light + "objects { repeat i (@1, @2) { sphere { transform { translate(i, 0, 0); } } } }", tally);
    try_everywhere(light + ball + "output { resolution(@4, @3); }", tally);
    CHECK(tally.refused > 0);
    CHECK(tally.rendered > 0);
}

}  // namespace lapidary
