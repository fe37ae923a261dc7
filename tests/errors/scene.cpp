// SPDX-License-Identifier: MIT
//
// The exact text and place of every message that building a scene can produce.
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "support/catch.h"
#include "support/scenes.h"

namespace lapidary {

namespace {

using Lines = std::vector<std::string>;

Lines said_of(const std::string& text) { return test::build(text)->headlines(); }

}  // namespace

TEST_CASE("Messages: unknown keywords", "[scene]") {
    CHECK(said_of("objects { spher {} }") ==
          Lines{"s:1:11: error: unknown keyword 'spher'; did you mean 'sphere'? (searched: <plugins>/objects)"});
    CHECK(said_of("objects { xyzzy {} }") == Lines{"s:1:11: error: unknown keyword 'xyzzy' (searched: <plugins>/objects)"});
    CHECK(said_of("xyzzy a {}") ==
          Lines{"s:1:1: error: unknown keyword 'xyzzy' (searched: <plugins>/objects, <plugins>/materials, <plugins>/lights)"});
    CHECK(said_of("lights { xyzzy {} }") == Lines{"s:1:10: error: unknown keyword 'xyzzy' (searched: <plugins>/lights)"});
    CHECK(said_of("output { xyzzy {} }") == Lines{"s:1:10: error: unknown keyword 'xyzzy' (searched: <plugins>/outputs)"});
    CHECK(said_of("objects { cube { xyzzy {} } }") ==
          Lines{"s:1:18: error: unknown keyword 'xyzzy' (searched: <plugins>/materials)"});
    CHECK(said_of("transform t { xyzzy {} }") == Lines{"s:1:15: error: unknown keyword 'xyzzy'"});
    CHECK(said_of("camera { xyzzy {} }") == Lines{"s:1:10: error: unknown keyword 'xyzzy'"});
}

TEST_CASE("Messages: keywords in the wrong place", "[scene]") {
    CHECK(said_of("objects { point {} }") == Lines{"s:1:11: error: 'point' is a light; lights stand in `lights { }`"});
    CHECK(said_of("objects { png {} }") == Lines{"s:1:11: error: 'png' is an output; outputs stand in `output { }`"});
    CHECK(said_of("objects { screen {} }") == Lines{"s:1:11: error: 'screen' stands in `camera { }`"});
    CHECK(said_of("lights { cube {} }") ==
          Lines{"s:1:10: error: 'cube' is an object; objects stand in `objects { }` and in CSG operations"});
    CHECK(said_of("lights { union {} }") ==
          Lines{"s:1:10: error: 'union' is a CSG operation; operations stand in `objects { }` and in one another"});
    CHECK(said_of("output { solid {} }") ==
          Lines{"s:1:10: error: 'solid' is a material; materials stand in objects, CSG operations and textures"});
    CHECK(said_of("camera { objects {} }") == Lines{"s:1:10: error: 'objects' stands at the top level"});
    CHECK(said_of("objects { inverse {} }") == Lines{"s:1:11: error: 'inverse' stands in `transform { }`"});
    CHECK(said_of("objects { cube { sphere {} } }") ==
          Lines{"s:1:18: error: 'sphere' cannot stand in 'cube', which holds no objects; CSG operations do: union { … }"});
    CHECK(said_of("objects { cube { union {} } }") ==
          Lines{"s:1:18: error: 'union' cannot stand in 'cube', which holds no objects; CSG operations do: union { … }"});
    CHECK(said_of("objects { rotx(1); }") == Lines{"s:1:11: error: 'rotx' stands in `transform { }`"});
    CHECK(said_of("camera { transform {} }") ==
          Lines{"s:1:10: error: 'camera' takes no transform; give its location and look_at instead"});
}

TEST_CASE("Messages: blocks and properties taken for one another", "[scene]") {
    CHECK(said_of("objects { cube(1); }") == Lines{"s:1:11: error: 'cube' is a block: it is written cube { … }"});
    CHECK(said_of("objects { sphere { transform(1); } }") ==
          Lines{"s:1:20: error: 'transform' is a block: it is written transform { … }"});
    CHECK(said_of("objects { sphere { radius {} } }") ==
          Lines{"s:1:20: error: 'radius' is written with parentheses: radius(r);"});
    CHECK(said_of("objects { union { priority {} } }") ==
          Lines{"s:1:19: error: 'priority' is written with parentheses: priority(p);"});
    CHECK(said_of("lights { point { location {} } }") ==
          Lines{"s:1:18: error: 'location' is written with parentheses: location(x, y, z);"});
    CHECK(said_of("camera { location {} }") ==
          Lines{"s:1:10: error: 'location' is written with parentheses: location(x, y, z);"});
    CHECK(said_of("transform t { rotx {} }") == Lines{"s:1:15: error: 'rotx' is written with parentheses: rotx(a);"});
    CHECK(said_of("objects { cube { wood(1); } }") == Lines{"s:1:18: error: 'wood' is a block: it is written wood { … }"});
}

TEST_CASE("Messages: properties", "[scene]") {
    CHECK(said_of("objects { sphere { radus(1); } }") ==
          Lines{"s:1:20: error: 'sphere' has no property 'radus'; did you mean 'radius'?"});
    CHECK(said_of("objects { sphere { xyzzy(1); } }") ==
          Lines{"s:1:20: error: 'sphere' has no property 'xyzzy'; it takes radius, colour, shininess and priority"});
    CHECK(said_of("objects { union { radius(1); } }") ==
          Lines{"s:1:19: error: 'union' has no property 'radius'; it takes colour, shininess and priority"});
    CHECK(said_of("lights { intensity(1); }") == Lines{"s:1:10: error: 'lights' has no property 'intensity'; it takes none"});
    CHECK(said_of("camera { xyzzy(1); }") == Lines{"s:1:10: error: 'camera' has no property 'xyzzy'; it takes projection, "
                                                   "location, look_at, up, angle, focus, aperture, points and rays"});
    CHECK(said_of("bakground(1,1,1);") == Lines{"s:1:1: error: 'scene' has no property 'bakground'; did you mean 'background'?"});
    CHECK(said_of("transform t { xyzzy(1); }") == Lines{"s:1:15: error: 'transform' has no property 'xyzzy'; it takes translate, "
                                                        "scale, rotx, roty, rotz, rotate, shear and matrix"});
}

TEST_CASE("Messages: numbers and kinds of values", "[scene]") {
    CHECK(said_of("objects { sphere { radius(1, 2); } }") == Lines{"s:1:20: error: 'radius' takes 1 value, not 2: radius(r);"});
    CHECK(said_of("objects { sphere { radius(\"x\"); } }") ==
          Lines{"s:1:27: error: 'radius' takes numbers, not the text \"x\": radius(r);"});
    CHECK(said_of("objects { sphere { radius(x); } }") ==
          Lines{"s:1:27: error: 'radius' takes numbers, not the word 'x': radius(r);"});
    CHECK(said_of("objects { cube { size(1, 2); } }") == Lines{"s:1:18: error: 'size' takes 3 values, not 2: size(x, y, z);"});
    CHECK(said_of("camera { rays(1.5); }") == Lines{"s:1:15: error: 'rays' takes a whole number, not 1.5"});
    CHECK(said_of("camera { projection(persp); }") ==
          Lines{"s:1:21: error: 'projection' knows the words perspective and orthographic, not 'persp'"});
    CHECK(said_of("camera { projection(\"perspective\"); }") ==
          Lines{"s:1:21: error: 'projection' takes words without quotes, not the text \"perspective\": projection(perspective | "
                "orthographic);"});
    const std::string filters = "filter(\"box\" | \"gaussian\" | \"mitchell\", number);";
    CHECK(said_of("render { filter(\"lanczos\"); }") ==
          Lines{"s:1:17: error: 'filter' knows the words box, gaussian and mitchell, not 'lanczos'"});
    CHECK(said_of("render { filter(box); }") ==
          Lines{"s:1:17: error: 'filter' takes text in double quotes, not the word 'box': " + filters});
    CHECK(said_of("render { filter(\"box\", \"2\"); }") ==
          Lines{"s:1:24: error: 'filter' takes numbers, not the text \"2\": " + filters});
    CHECK(said_of("render { filter(\"box\", 1, 2); }") ==
          Lines{"s:1:10: error: 'filter' takes 1 to 2 values, not 3: " + filters});
    CHECK(said_of("output { name(x); }") ==
          Lines{"s:1:15: error: 'name' takes text in double quotes, not the word 'x': name(\"text\");"});
    CHECK(said_of("transform t { scale(1, 2); }") ==
          Lines{"s:1:15: error: 'scale' takes 1 or 3 values, not 2: scale(s); or scale(x, y, z);"});
    CHECK(said_of("transform t { translate(1); }") ==
          Lines{"s:1:15: error: 'translate' takes 3 values, not 1: translate(x, y, z);"});
    CHECK(said_of("transform t { translate(1, \"x\", 3); }") ==
          Lines{"s:1:28: error: 'translate' takes numbers: translate(x, y, z);"});
    CHECK(said_of("plugins(1);") == Lines{"s:1:1: error: 'plugins' takes one folder in double quotes: plugins \"folder\";"});
}

TEST_CASE("Messages: ranges", "[scene]") {
    CHECK(said_of("objects { sphere { radius(-1); } } lights { ambient {} }") ==
          Lines{"s:1:27: warning: 'radius' takes numbers above 0; -1 was clamped to 1e-06"});
    CHECK(said_of("objects { cube { colour(2, 0, -1); } } lights { ambient {} }") ==
          Lines{"s:1:25: warning: 'colour' takes numbers 0 to 1; 2 was clamped to 1",
                "s:1:31: warning: 'colour' takes numbers 0 to 1; -1 was clamped to 0"});
    CHECK(said_of("camera { points(-1); } objects { cube {} } lights { ambient {} }") ==
          Lines{"s:1:17: warning: 'points' takes numbers 0 to 1048576; -1 was clamped to 0"});
    CHECK(said_of("output { resolution(0, 100000); } objects { cube {} } lights { ambient {} }") ==
          Lines{"s:1:21: warning: 'resolution' takes numbers 1 to 65536; 0 was clamped to 1",
                "s:1:24: warning: 'resolution' takes numbers 1 to 65536; 100000 was clamped to 65536"});
    CHECK(said_of("camera { focus(0); } objects { cube {} } lights { ambient {} }") ==
          Lines{"s:1:16: warning: 'focus' takes numbers above 0; 0 was clamped to 1e-06"});
}

TEST_CASE("Messages: directions and angles", "[scene]") {
    CHECK(said_of("objects { cube {} } lights { direct { direction(0, 0, 0); } }") ==
          Lines{"s:1:39: warning: 'direction' of length zero has no direction; the default is used"});
    CHECK(said_of("camera { up(0, 0, 0); } objects { cube {} } lights { ambient {} }") ==
          Lines{"s:1:10: warning: 'up' of length zero has no direction; the default is used"});
    CHECK(said_of("camera { look_at(0, 0, 0); } objects { cube {} } lights { ambient {} }") ==
          Lines{"s:1:10: warning: 'look_at' is the camera's location: the view runs along +z"});
    CHECK(said_of("camera { screen { location(0, 0, 0); } } objects { cube {} } lights { ambient {} }") ==
          Lines{"s:1:19: warning: the screen's centre is the camera's location: the view runs along +z"});
    CHECK(said_of("objects { cube { transform { rotx(90); } } } lights { ambient {} }") ==
          Lines{"s:1:35: warning: 90 radians? 90deg is written 90deg"});
    CHECK(said_of("objects { cube {} } lights { spot { angles(0.1, 30); } }") ==
          Lines{"s:1:49: warning: 30 radians? 90deg is written 90deg",
                "s:1:49: warning: 'angles' takes numbers 0 to 3.141592653589793; 30 was clamped to 3.141592653589793"});
}

TEST_CASE("Messages: repetitions", "[scene]") {
    CHECK(said_of("objects { sphere { radius(1); radius(2); } } lights { ambient {} }") ==
          Lines{"s:1:31: warning: 'radius' stands here a second time; the last one counts"});
    CHECK(said_of("objects { cube { colour(1,0,0); colour(0,1,0); } } lights { ambient {} }") ==
          Lines{"s:1:33: warning: 'colour' stands here a second time; the last one counts"});
    CHECK(said_of("objects { cube { material { solid {} } material { solid {} } } } lights { ambient {} }") ==
          Lines{"s:1:40: warning: a second material stands here; the last one counts"});
    CHECK(said_of("objects { cube { colour(1,0,0); material { solid {} } } } lights { ambient {} }") ==
          Lines{"s:1:18: warning: 'colour' has no effect beside a material; write it inside the material"});
    CHECK(said_of("background(1,1,1); background(0,0,0); objects { cube {} } lights { ambient {} }") ==
          Lines{"s:1:20: warning: 'background' stands here a second time; the last one counts"});
    CHECK(said_of("camera {} camera {} output {} output {} render {} render {} objects { cube {} } lights { ambient {} }") ==
          Lines{"s:1:11: warning: 'camera' stands here a second time (before at s:1:1); the last one counts",
                "s:1:31: warning: 'output' stands here a second time (before at s:1:21); the last one counts",
                "s:1:51: warning: 'render' stands here a second time (before at s:1:41); the last one counts"});
    CHECK(said_of("camera { screen {} screen {} } objects { cube {} } lights { ambient {} }") ==
          Lines{"s:1:20: warning: 'screen' stands here a second time; the last one counts"});
    CHECK(said_of("objects { cube {} } objects { cube {} } lights { ambient {} }") ==
          Lines{"s:1:1: warning: a later `objects` block is the one rendered, and this one defines no name: it has no effect"});
    CHECK(said_of("objects { cube c {} } objects { c; } lights { ambient {} }") == Lines{});
}

TEST_CASE("Messages: conditions across properties", "[scene]") {
    CHECK(said_of("objects { cone { radii(0, 0); } }") == Lines{"s:1:11: error: 'cone': one of the radii must be above 0"});
    CHECK(said_of("objects { cone { radii(1, 0); height(0); } } lights { ambient {} }") ==
          Lines{"s:1:38: warning: 'height' takes numbers above 0; 0 was clamped to 1e-06"});
    CHECK(said_of("lights { spot { angles(30deg, 20deg); } }") ==
          Lines{"s:1:10: error: 'spot': the first angle must not be larger than the second"});
    CHECK(said_of("output { resolution(60000, 60000); }") ==
          Lines{"s:1:1: error: 'output': the picture must have at most 268 million pixels"});
}

TEST_CASE("Messages: names", "[scene]") {
    CHECK(said_of("cube a {} cube a {} objects { a; }") ==
          Lines{"s:1:16: error: 'a' is defined a second time; the first definition is at s:1:6"});
    CHECK(said_of("cube a {} sphere b { a; }") ==
          Lines{"s:1:22: error: 'a' cannot stand in 'sphere', which holds no objects; CSG operations do: union { … }"});
    CHECK(said_of("objects { a; } cube a {}") ==
          Lines{"s:1:11: error: 'a' is used above its definition at s:1:21; move the definition up"});
    CHECK(said_of("union a { a; }") == Lines{"s:1:11: error: 'a' is used inside its own definition"});
    CHECK(said_of("cube ball {} objects { bal; }") == Lines{"s:1:24: error: unknown name 'bal'; did you mean 'ball'?"});
    CHECK(said_of("objects { xyzzy; }") == Lines{"s:1:11: error: unknown name 'xyzzy'"});
    CHECK(said_of("cube a {} objects { cube {} } lights { ambient {} }") ==
          Lines{"s:1:6: warning: 'a' is defined but never used"});
    CHECK(said_of("cube a {} objects { cube b {} } objects { cube {} } lights { ambient {} }") ==
          Lines{"s:1:6: warning: 'a' is defined but never used", "s:1:26: warning: 'b' is defined but never used"});
    CHECK(said_of("point a {} objects { a; }") == Lines{"s:1:22: error: 'a' is a light; lights stand in `lights { }`"});
    CHECK(said_of("cube a {} lights { a; }") ==
          Lines{"s:1:20: error: 'a' is an object; objects stand in `objects { }` and in CSG operations"});
    CHECK(said_of("cube a {} objects { cube { material { a; } } }") ==
          Lines{"s:1:39: error: 'a' is an object; objects stand in `objects { }` and in CSG operations"});
    CHECK(said_of("cube a {} transform t { a; }") ==
          Lines{"s:1:25: error: 'a' is an object; objects stand in `objects { }` and in CSG operations"});
    CHECK(said_of("solid a {} lights { point { a; } }") ==
          Lines{"s:1:29: error: 'a' is a material; materials stand in objects, CSG operations and textures"});
    CHECK(said_of("cube a {} a;") ==
          Lines{"s:1:11: error: 'a' cannot stand at the top level; place it in `objects { }` or `lights { }`"});
    CHECK(said_of("cube {}") ==
          Lines{"s:1:1: error: 'cube' without a name has no effect at the top level; name it, or place it in a block"});
    CHECK(said_of("objects o {}") == Lines{"s:1:9: error: 'objects' takes no name; leave out 'o'",
                                           "s:1:1: warning: this 'objects' holds no objects: it is the empty set"});
    CHECK(said_of("lights l { ambient {} }") == Lines{"s:1:8: error: 'lights' takes no name; leave out 'l'"});
    CHECK(said_of("camera c {}") == Lines{"s:1:8: error: 'camera' takes no name; leave out 'c'"});
    CHECK(said_of("solid c {} camera { c; }") == Lines{"s:1:21: error: a 'camera' block takes no names; 'c' cannot stand here"});
    CHECK(said_of("output { png p {} }") == Lines{"s:1:14: error: 'png' takes no name; leave out 'p'"});
}

TEST_CASE("Messages: branches", "[scene]") {
    CHECK(said_of("objects { union {} } lights { ambient {} }") ==
          Lines{"s:1:11: warning: this 'union' holds no objects: it is the empty set"});
    CHECK(said_of("objects { subtraction { cube {} } with {} } lights { ambient {} }") ==
          Lines{"s:1:40: warning: this branch of 'subtraction' holds no objects: it is the empty set"});
    CHECK(said_of("objects {} lights { ambient {} }") ==
          Lines{"s:1:1: warning: this 'objects' holds no objects: it is the empty set"});
    CHECK(said_of("objects { cube {} with {} }") ==
          Lines{"s:1:24: error: 'cube' takes no `with`; CSG operations and textures do"});
    CHECK(said_of("objects {} with {}") ==
          Lines{"s:1:17: error: 'objects' takes no `with`; CSG operations and textures do",
                "s:1:9: warning: this branch of 'objects' holds no objects: it is the empty set",
                "s:1:17: warning: this branch of 'objects' holds no objects: it is the empty set"});
    CHECK(said_of("transform t {} with {}") ==
          Lines{"s:1:21: error: 'transform' takes no `with`; CSG operations and textures do"});
}

TEST_CASE("Messages: transforms", "[scene]") {
    CHECK(said_of("transform t { scale(0); }") ==
          Lines{"s:1:15: error: singular transform: a scale of 0 flattens space; give a number other than 0"});
    CHECK(said_of("transform t { scale(1, 0, 1); }") ==
          Lines{"s:1:15: error: singular transform: a scale of 0 flattens space; give a number other than 0"});
    CHECK(said_of("transform t { scale(1e-310); }") ==
          Lines{"s:1:15: error: singular transform: a scale this small has no finite inverse"});
    CHECK(said_of("transform t { rotate(0, 0, 0, 1); }") == Lines{"s:1:15: error: the axis of a rotation must not be (0, 0, 0)"});
    CHECK(said_of("transform t { matrix(1,0,0, 1,0,0, 0,0,1, 0,0,0); }") ==
          Lines{"s:1:15: error: singular transform: its determinant is 0, so it flattens space"});
    CHECK(said_of("transform t { shear(1,0,1,0,0,0); }") ==
          Lines{"s:1:15: error: singular transform: its determinant is 0, so it flattens space"});
    CHECK(said_of("objects { cube { transform { scale(1e200); scale(1e200); } } }") ==
          Lines{"s:1:11: error: the transforms of this block multiply to numbers that are not finite, or to a singular map"});
}

TEST_CASE("Messages: materials", "[scene]") {
    CHECK(said_of("objects { cube { material {} } }") == Lines{"s:1:18: error: a material holds one texture block, not 0"});
    CHECK(said_of("objects { cube { material { solid {} solid {} } } }") ==
          Lines{"s:1:18: error: a material holds one texture block, not 2"});
    CHECK(said_of("objects { cube { material { colour(1,0,0); } } }") ==
          Lines{"s:1:29: error: 'colour' cannot stand directly in a material; write it inside a texture block"});
    CHECK(said_of("objects { cube { material { checkers { solid {} } } } }") ==
          Lines{"s:1:29: error: 'checkers' takes 2 textures (even and odd), not 1; a constant is written value(v); or colour(r, "
                "g, b);"});
    CHECK(said_of("objects { cube { material { solid { solid {} } } } }") ==
          Lines{"s:1:29: error: 'solid' takes no textures inside, not 1"});
    CHECK(said_of("objects { cube { material { cube {} } } }") ==
          Lines{"s:1:29: error: 'cube' is an object; objects stand in `objects { }` and in CSG operations"});
    CHECK(said_of("objects { cube { material { checkers { value(\"x\"); value(1); } } } }") ==
          Lines{"s:1:46: error: 'value' takes numbers, not the text \"x\": value(v);"});
}

TEST_CASE("Messages: camera and output", "[scene]") {
    CHECK(said_of("camera { look_at(1,2,3); screen { location(1,2,3); } }") ==
          Lines{"s:1:10: error: 'look_at' and the screen's location exclude each other; leave out one"});
    CHECK(said_of("camera { angle(1); screen { size(1,1); } }") ==
          Lines{"s:1:10: error: 'angle' and the screen's size exclude each other; leave out one"});
    CHECK(said_of("camera { location(0, 0, 1e17); }") ==
          Lines{"s:1:10: error: the camera is so far from the origin that the screen, one unit away, rounds to the same place; "
                "move the scene nearer"});
    CHECK(said_of("camera { angle(1); projection(orthographic); }") ==
          Lines{"s:1:10: error: 'angle' has no meaning for parallel rays; give the screen's size instead"});
}

TEST_CASE("Messages: what is missing", "[scene]") {
    CHECK(said_of("objects { cube {} }") == Lines{"s: warning: no light: only what reflects the background will show"});
    CHECK(said_of("lights { ambient {} }") == Lines{"s: warning: no `objects` block: the picture shows the background only"});
    CHECK(said_of("plugins \"nowhere\";") ==
          Lines{"s:1:9: error: there is no plugin folder 'nowhere'; a relative one is looked for beside the scene file"});
}

TEST_CASE("Messages: nothing is lost on the way through errors", "[scene]") {
    CHECK(said_of("objects { cube { radus(1); siz(1,2,3); transform { scale(0); rotz(x); } } spher {} } lights { pont {} } "
                  "camera { loc(1); }") ==
          Lines{"s:1:18: error: 'cube' has no property 'radus'; it takes size, colour, shininess and priority",
                "s:1:28: error: 'cube' has no property 'siz'; did you mean 'size'?",
                "s:1:52: error: singular transform: a scale of 0 flattens space; give a number other than 0",
                "s:1:67: error: 'rotz' takes numbers: rotz(a);",
                "s:1:75: error: unknown keyword 'spher'; did you mean 'sphere'? (searched: <plugins>/objects)",
                "s:1:95: error: unknown keyword 'pont'; did you mean 'point'? (searched: <plugins>/lights)",
                "s:1:114: error: 'camera' has no property 'loc'; it takes projection, location, look_at, up, angle, focus, "
                "aperture, points and rays"});
}

TEST_CASE("Messages: a plugin that does not load is refused with the reason", "[scene]") {
    std::string folder = (std::filesystem::temp_directory_path() / "lapidary-XXXXXX").string();
    REQUIRE(mkdtemp(folder.data()));
    std::filesystem::create_directory(folder + "/objects");
    std::ofstream(folder + "/objects/broken.so") << "not a library";
    const auto built = test::build("objects { broken {} broken {} }", {folder});
    std::filesystem::remove_all(folder);
    const Lines lines = built->headlines();
    CHECK(lines == Lines{"s:1:11: error: the object 'broken' cannot be used: the plugin '" + folder +
                         "/objects/broken.so' was refused: the dynamic loader cannot open it: file too short"});
}

TEST_CASE("Messages: without plugin folders, the remedy is named", "[scene]") {
    CHECK(test::build("objects { ball {} }", {})->headlines() ==
          Lines{"s:1:11: error: unknown keyword 'ball' (no plugin folder is known; name one with --plugin-path)"});
}

TEST_CASE("Messages: a scene with nothing to complain about says nothing", "[scene]") {
    CHECK(said_of("sphere ball { radius(2); } objects { ball; cube {} } lights { ambient {} }").empty());
}

}  // namespace lapidary
