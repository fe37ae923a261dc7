// SPDX-License-Identifier: MIT
//
// What good scenes are read as: blocks, values, places, and the work of let, repeat and include.
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "kernel/math/colour.h"
#include "loaders/scene/load.h"
#include "support/catch.h"

namespace lapidary {

namespace {

void print(const Items& items, std::ostream& out);

void print(const Value& value, std::ostream& out) {
    if (value.kind == Value::Kind::number)
        out << value.number << (value.angle ? "rad" : "");
    else if (value.kind == Value::Kind::text)
        out << '"' << value.text << '"';
    else
        out << value.text;
}

void print(const Property& property, std::ostream& out) {
    out << property.keyword << '(';
    for (std::size_t i = 0; i < property.values.size(); ++i) {
        if (i > 0) out << ',';
        print(property.values[i], out);
    }
    out << ");";
}

void print(const Reference& reference, std::ostream& out) { out << reference.name << ';'; }

void print(const std::unique_ptr<Block>& block, std::ostream& out) {
    out << block->keyword << (block->name.empty() ? "" : " ") << block->name;
    for (std::size_t i = 0; i < block->branches.size(); ++i) {
        out << (i > 0 ? "with{" : "{");
        print(block->branches[i].items, out);
        out << '}';
    }
}

void print(const Items& items, std::ostream& out) {
    for (const Item& item : items) std::visit([&](const auto& one) { print(one, out); }, item);
}

// The Document in the shortest form.
std::string read(std::string text) {
    Messages messages;
    const Document document = load_scene_text("s", std::move(text), {}, messages);
    for (const Message& message : messages.all()) FAIL_CHECK(message.format());
    std::ostringstream out;
    out.precision(15);
    print(document.items, out);
    return out.str();
}

std::vector<Value> values_of(const std::string& values) {
    Messages messages;
    const Document document = load_scene_text("s", "p(" + values + ");", {}, messages);
    for (const Message& message : messages.all()) FAIL_CHECK(message.format());
    return document.items.empty() ? std::vector<Value>() : std::get<Property>(document.items.at(0)).values;
}

double number(const std::string& expression) { return values_of(expression).at(0).number; }
bool is_angle(const std::string& expression) { return values_of(expression).at(0).angle; }

}  // namespace

TEST_CASE("Blocks, properties and references", "[parser]") {
    CHECK(read("") == "");
    CHECK(read("objects { sphere ball { radius(2); } ball; }") == "objects{sphere ball{radius(2);}ball;}");
    CHECK(read("union{}with{a;}with{b;c;}d;") == "union{}with{a;}with{b;c;}d;");
    CHECK(read("output { name(\"a b.png\"); exr { aov(depth, normal); } png {} }") ==
          "output{name(\"a b.png\");exr{aov(depth,normal);}png{}}");
    CHECK(read("plugins \"own\"; plugins(\"more\");") == "plugins(\"own\");plugins(\"more\");");
    CHECK(read("p();") == "p();");
    CHECK(read("/*/ a */p(1)/**/;// b\n/***/q(//\n2/* \" { */);") == "p(1);q(2);");
    CHECK(read("\xEF\xBB\xBF"
               "sphere\r\n{\r\n}\r\n") == "sphere{}");
    CHECK(read("sphere würfel_2 { } würfel_2;") == "sphere würfel_2{}würfel_2;");
    // Keywords of statements are ordinary words elsewhere.
    CHECK(read("sphere include_2 {} p(let, with);") == "sphere include_2{}p(let,with);");
}

TEST_CASE("Items know their places", "[parser]") {
    Messages messages;
    const Document document =
        load_scene_text("s", "\xEF\xBB\xBF\n\tunion both {\n} with { ball; }\n/* \n */ p( a,\n\"b\", 1+1);", {}, messages);
    const auto at = [&](const Place& place) {
        CHECK(place.file == &document.sources->files().front());
        return std::pair(place.line, place.column);
    };
    using Pair = std::pair<std::uint32_t, std::uint32_t>;
    const Block& block = *std::get<std::unique_ptr<Block>>(document.items.at(0));
    CHECK(at(block.place) == Pair(2, 2));
    CHECK(at(block.name_place) == Pair(2, 8));
    CHECK(at(block.branches.at(0).place) == Pair(2, 13));
    CHECK(at(block.branches.at(1).place) == Pair(3, 8));
    CHECK(at(std::get<Reference>(block.branches.at(1).items.at(0)).place) == Pair(3, 10));
    const Property& property = std::get<Property>(document.items.at(1));
    CHECK(at(property.place) == Pair(5, 5));
    CHECK(at(property.values.at(0).place) == Pair(5, 8));
    CHECK(at(property.values.at(1).place) == Pair(6, 1));
    CHECK(at(property.values.at(2).place) == Pair(6, 6));
}

TEST_CASE("Numbers and expressions", "[parser]") {
    CHECK(number("1") == 1);
    CHECK(number("-.5") == -.5);
    CHECK(number("1e-3") == 1e-3);
    CHECK(number("2.5E+2") == 250);
    CHECK(number("1.") == 1);
    CHECK(number("0.1") == 0.1);
    CHECK(number("1.7976931348623157e308") == 1.7976931348623157e308);
    CHECK(number("5e-324") == 5e-324);
    CHECK(number("1e-400") == 0);
    CHECK(number("0.000001e-320") == 0);
    CHECK(number("1+2*3") == 7);
    CHECK(number("(1+2)*3") == 9);
    CHECK(number("8/4/2") == 1);
    CHECK(number("5-2-1") == 2);
    CHECK(number("--+-2") == -2);
    CHECK(number("2*-3") == -6);
    CHECK(number("2-3") == -1);
    CHECK(number("pi") == std::numbers::pi);
    CHECK(number("sin(pi/6)*2") == Approx(1));
    CHECK(number("cos(0)+tan(0)") == 1);
    CHECK(number("asin(1)+acos(1)+atan(0)") == Approx(std::numbers::pi / 2));
    CHECK(number("atan2(1,-1)") == Approx(std::numbers::pi * 3 / 4));
    CHECK(number("sqrt(2)") == std::sqrt(2.0));
    CHECK(number("abs(-3)+floor(-1.5)") == 1);
    CHECK(number("min(3,1,2)+10*max(3,1,2)") == 31);
    CHECK(number("pow(2,10)+exp(0)+log(1)") == 1025);
}

TEST_CASE("Units", "[parser]") {
    CHECK(number("180deg") == Approx(std::numbers::pi));
    CHECK(number("45 deg") == Approx(std::numbers::pi / 4));
    CHECK(number("0.5rad") == 0.5);
    CHECK(number("1e1deg") == Approx(std::numbers::pi / 18));
    CHECK(number("(30+60)deg") == Approx(std::numbers::pi / 2));
    CHECK(number("-90deg") == Approx(-std::numbers::pi / 2));

    for (const char* angle : {"45deg", "-45deg", "2*45deg", "45deg/2", "45deg+1", "atan2(1,1)", "min(1,2deg)", "abs(-3deg)"})
        CHECK(is_angle(angle));
    for (const char* plain : {"45", "pi", "sin(45deg)", "90deg/45deg", "sqrt(2)", "pow(2,3)"}) CHECK_FALSE(is_angle(plain));
    CHECK(read("let step = 45deg; p(2*step);") == "p(1.5707963267949rad);");
}

TEST_CASE("Colours arrive as three linear numbers", "[parser]") {
    CHECK(read("p(srgb(1,0,1));") == "p(1,0,1);");
    CHECK(read("p(hex(\"#f0f\"),hex(\"00ff00\"));") == "p(1,0,1,0,1,0);");
    CHECK(values_of("srgb(0.5,1/4,0)").at(0).number == srgb_decode(0.5));
    CHECK(values_of("srgb(0.5,1/4,0)").at(1).number == srgb_decode(0.25));
    CHECK(values_of("hex(\"#ff8000\")").at(1).number == srgb_decode(128 / 255.0));
}

TEST_CASE("A word is a constant where one is defined", "[parser]") {
    CHECK(read("p(y);") == "p(y);");
    CHECK(read("let y = 3; p(y);") == "p(3);");
    CHECK(values_of("pi").at(0).text == "pi");
    CHECK(values_of("pi*1").at(0).text.empty());

    Messages messages;
    CHECK(load_scene_text("s", "let width = 3; p(width);", {}, messages).constants == std::vector<std::string>{"pi", "width"});
}

TEST_CASE("Loops repeat what they hold", "[parser]") {
    CHECK(read("repeat i (1, 3) { p(i); }") == "p(1);p(2);p(3);");
    CHECK(read("repeat i (-1, -1) { p(i); }") == "p(-1);");
    CHECK(read("union { repeat i (0, 1) { repeat j (i, 1) { p(i, j); } } a; }") == "union{p(0,0);p(0,1);p(1,1);a;}");
    CHECK(read("let n = 2; repeat i (0, n - 1) { let a = 10*i; p(a); }") == "p(0);p(10);");
    CHECK(read("repeat i (0, 1) { p(i); } repeat i (2, 3) { p(i); }") == "p(0);p(1);p(2);p(3);");
    CHECK(read("union { repeat i (0, 1) { sphere { radius(i); } with { a; } } }") ==
          "union{sphere{radius(0);}with{a;}sphere{radius(1);}with{a;}}");
    // The place is that of the text, in every round.
    Messages messages;
    const Document document = load_scene_text("s", "repeat i (0, 2) {\n\n p(i); }", {}, messages);
    for (const Item& item : document.items) CHECK(std::get<Property>(item).place.line == 3);
}

TEST_CASE("Errors do not stop the reading", "[parser]") {
    Messages messages;
    const Document document =
        load_scene_text("s", "a(1) b(2; c(3,,); ) d(4); { x; } e(5); f { g(6); ? h(7) } i(1/0); j(8);", {}, messages);
    std::ostringstream out;
    print(document.items, out);
    CHECK(out.str() == "a(1);d(4);e(5);f{g(6);h(7);}j(8);");
    CHECK(messages.errors() == 7);
}

TEST_CASE("Includes stand for the text of their files", "[parser]") {
    std::string name = (std::filesystem::temp_directory_path() / "lapidary-XXXXXX").string();
    REQUIRE(mkdtemp(name.data()));
    const std::filesystem::path folder = name;
    std::filesystem::create_directories(folder / "parts" / "small");
    std::ofstream(folder / "main") << "let n = 2; include \"parts/one\" c(n); repeat i (1, 2) { include \"two\"; }";
    std::ofstream(folder / "parts/one") << "\xEF\xBB\xBF"
                                           "a(n); include \"small/three\"; let unused = 1;";
    std::ofstream(folder / "parts/small/three") << "b { c(n + 1); }";
    std::ofstream(folder / "parts/two") << "d(i);";

    Messages messages;
    LoadOptions options;
    options.include_path = {folder / "nowhere", folder / "parts"};
    const Document document = load_scene_file(folder / "main", options, messages);
    std::ostringstream out;
    print(document.items, out);
    CHECK(out.str() == "a(2);b{c(3);}c(2);d(1);d(2);");
    CHECK(messages.all().empty());

    // Every file is kept once, and knows where it was included.
    CHECK(document.sources->files().size() == 4);
    CHECK(document.sources->files().at(2).name == (folder / "parts/small/three").string());
    CHECK(document.sources->files().at(2).included_at.file == &document.sources->files().at(1));
    CHECK(document.sources->files().at(2).included_at.column == 15);
    std::filesystem::remove_all(folder);
}

}  // namespace lapidary
