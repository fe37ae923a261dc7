// SPDX-License-Identifier: MIT
//
// Properties declared once, by binding members. From the one declaration come loading, checking, help, printing and
// the tests:
//
//     static void describe(Schema<Torus>& schema) {
//         schema.summary("A ring.");
//         schema.add("radii", &Torus::major_, &Torus::minor_).unit(Unit::length).above(0).help("Of the ring and of its tube.");
//         schema.require("the tube must be thinner than the ring", [](const Torus& t) { return t.minor_ < t.major_; });
//         schema.derive([](Torus& t) { t.reach_ = t.major_ + t.minor_; });
//     }
//
// The type comes from the member, the default from its initialiser, private members are reachable because describe is
// itself a member.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "kernel/export.h"
#include "kernel/interfaces/material.h"
#include "kernel/math/colour.h"
#include "kernel/math/transform.h"
#include "kernel/math/vector.h"
#include "kernel/scene/document.h"

namespace lapidary {

enum class Unit : std::uint8_t { none, length, angle };

// What stands in one position of a property's parentheses.
enum class Shape : std::uint8_t { number, integer, colour, text, word };

// The range of a property's numbers.
struct Range {
    double low = -std::numeric_limits<double>::infinity();
    double high = std::numeric_limits<double>::infinity();
    bool low_open = false, high_open = false;  // the bound itself is outside
    bool contains(double v) const { return (low_open ? v > low : v >= low) && (high_open ? v < high : v <= high); }
    // The nearest number inside.
    LAPIDARY_API double clamp(double v) const;
    // "above 0", "at least 0", "0 to 1", "0deg to 180deg", or nothing.
    LAPIDARY_API std::string describe(Unit unit = Unit::none) const;
};

struct PropertySchema {
    std::string name;
    Shape shape = Shape::number;
    std::vector<Shape> shapes;              // of each value, where they differ (`relief("noise", 4)`); else empty
    int least_values = 1, most_values = 1;  // how many values the parentheses hold
    bool optional = false;                  // has no default: absent means something of its own
    bool repeats = false;                   // may be written several times, each time adding to the list
    bool direction = false;                 // a Vector or Normal: must not be zero, unless it has a range
    Unit unit = Unit::none;
    Range range;
    std::vector<std::string> words;  // of an enumeration
    std::string arguments;           // what to call the values, "R, r"; empty: by shape and name
    std::string help;

    // Checks have been done: the values fit shape, number and range.
    std::function<void(void* object, const std::vector<Value>& values)> assign;
    // The present values; nothing where an optional property is absent. A repeated property gives one list per line.
    std::function<std::vector<std::vector<Value>>(const void* object)> read;
    // Takes points, vectors and normals from the block's space into the world (lights); empty for other types.
    std::function<void(void* object, const Transform& to_world)> place;

    // What the value at an index has to be.
    Shape shape_at(std::size_t index) const { return index < shapes.size() ? shapes[index] : shape; }

    // "(r)", "(x, y, z)", "(R, r)": what the parentheses take, for messages and help.
    LAPIDARY_API std::string signature() const;
};

// A child slot of a texture tree. Children fill the slots in the order of writing.
struct ChildSchema {
    std::string name;
    std::string help;
    bool optional = false;
    bool repeats = false;  // the last slot takes any number of children
    std::function<void(void* object, MaterialPtr child)> assign;
    std::function<std::vector<MaterialPtr>(const void* object)> read;
};

struct Requirement {
    std::string sentence;  // "the tube must be thinner than the ring"
    std::function<bool(const void* object)> holds;
};

class LAPIDARY_API SchemaBase {
public:
    const std::string& summary() const { return summary_; }
    const std::vector<PropertySchema>& properties() const { return properties_; }
    const std::vector<ChildSchema>& children() const { return children_; }
    const std::vector<Requirement>& requirements() const { return requirements_; }

    // To be called when properties of an object were given values and the requirements hold, and again when they were placed. New
    // objects that a Plugin creates have derived from their defaults.
    void derive(void* object) const {
        if (derive_) derive_(object);
    }

    const PropertySchema* find(std::string_view name) const;
    // The default values of a property, as the scene language would write them: "1", "(1, 0.25)", "none".
    std::string default_text(const PropertySchema& property) const;

protected:
    std::string summary_;
    std::vector<PropertySchema> properties_;
    std::vector<ChildSchema> children_;
    std::vector<Requirement> requirements_;
    std::function<void(void* object)> derive_;
    std::shared_ptr<const void> specimen_;  // one default-constructed object, from which defaults are read
};

// How a member of a type is filled from values and printed back.
template <class T>
struct MemberTraits;

LAPIDARY_API Value number_value(double v);
LAPIDARY_API Value text_value(std::string v);
LAPIDARY_API Value word_value(std::string v);

template <>
struct MemberTraits<double> {
    static constexpr Shape shape = Shape::number;
    static constexpr int count = 1;
    static double from(const Value* v) { return v[0].number; }
    static void to(double m, std::vector<Value>& out) { out.push_back(number_value(m)); }
};
template <>
struct MemberTraits<int> {
    static constexpr Shape shape = Shape::integer;
    static constexpr int count = 1;
    static int from(const Value* v) {
        using Limits = std::numeric_limits<int>;
        return static_cast<int>(std::clamp<double>(v[0].number, Limits::min(), Limits::max()));
    }
    static void to(int m, std::vector<Value>& out) { out.push_back(number_value(m)); }
};
template <>
struct MemberTraits<std::string> {
    static constexpr Shape shape = Shape::text;
    static constexpr int count = 1;
    static std::string from(const Value* v) { return v[0].text; }
    static void to(const std::string& m, std::vector<Value>& out) { out.push_back(text_value(m)); }
};
template <class Triple, Shape triple_shape>
struct TripleTraits {
    static constexpr Shape shape = triple_shape;
    static constexpr int count = 3;
    static Triple from(const Value* v) { return Triple{v[0].number, v[1].number, v[2].number}; }
    static void to(const Triple& m, std::vector<Value>& out) {
        const auto [a, b, c] = m;
        for (double component : {a, b, c}) out.push_back(number_value(component));
    }
};
template <>
struct MemberTraits<Point> : TripleTraits<Point, Shape::number> {
    static void place(Point& p, const Transform& t) { p = t.to_parent(p); }
};
template <>
struct MemberTraits<Vector> : TripleTraits<Vector, Shape::number> {
    static void place(Vector& v, const Transform& t) { v = t.to_parent(v); }
};
template <>
struct MemberTraits<Normal> : TripleTraits<Normal, Shape::number> {
    static void place(Normal& n, const Transform& t) { n = t.to_parent(n); }
};
template <>
struct MemberTraits<Colour> : TripleTraits<Colour, Shape::colour> {};

template <class T>
concept Placeable = requires(T& t, const Transform& m) {
    MemberTraits<T>::place(t, m);
};

template <class T>
class Schema : public SchemaBase {
public:
    Schema() {
        specimen_ = std::make_shared<T>();
        T::describe(*this);
    }

    Schema& summary(std::string sentence) {
        summary_ = std::move(sentence);
        return *this;
    }
    using SchemaBase::summary;

    // Refines the property added last; in the order: schema.add(…).unit(…).above(…).help(…).
    class Added {
    public:
        Added(Schema& schema, std::size_t index) : schema_(schema), index_(index) {}
        Added& unit(Unit u) {
            return edit([&](auto& p) { p.unit = u; });
        }
        Added& above(double low) {
            return edit([&](auto& p) { p.range.low = low, p.range.low_open = true; });
        }
        Added& at_least(double low) {
            return edit([&](auto& p) { p.range.low = low, p.range.low_open = false; });
        }
        Added& below(double high) {
            return edit([&](auto& p) { p.range.high = high, p.range.high_open = true; });
        }
        Added& at_most(double high) {
            return edit([&](auto& p) { p.range.high = high, p.range.high_open = false; });
        }
        Added& between(double low, double high) { return at_least(low).at_most(high); }
        // What help and messages call the values: "R, r".
        Added& arguments(std::string names) {
            return edit([&](auto& p) { p.arguments = std::move(names); });
        }
        Added& help(std::string sentence) {
            return edit([&](auto& p) { p.help = std::move(sentence); });
        }

    private:
        template <class F>
        Added& edit(F change) {
            change(schema_.properties_[index_]);
            return *this;
        }
        Schema& schema_;
        std::size_t index_;
    };

    // One property that fills one member, or several members of one type one after the other.
    template <class Owner, class M, class... More>
    requires std::is_base_of_v<Owner, T> &&(std::is_same_v<M, More>&&...)Added
        add(std::string name, M Owner::*first, More Owner::*... more) {
        using Traits = MemberTraits<M>;
        const std::array<M Owner::*, 1 + sizeof...(More)> members{first, more...};
        PropertySchema p;
        p.name = std::move(name);
        p.shape = Traits::shape;
        p.least_values = p.most_values = Traits::count * static_cast<int>(members.size());
        p.direction = std::is_same_v<M, Vector> || std::is_same_v<M, Normal>;
        p.assign = [members](void* object, const std::vector<Value>& values) {
            const Value* v = values.data();
            for (auto member : members) {
                owner<Owner>(object).*member = Traits::from(v);
                v += Traits::count;
            }
        };
        p.read = [members](const void* object) {
            std::vector<Value> values;
            for (auto member : members) Traits::to(owner<Owner>(object).*member, values);
            return std::vector<std::vector<Value>>{std::move(values)};
        };
        if constexpr (Placeable<M>)
            p.place = [members](void* object, const Transform& t) {
                for (auto member : members) Traits::place(owner<Owner>(object).*member, t);
            };
        return push(std::move(p));
    }

    // A property without default: absent means something of its own.
    template <class Owner, class M>
    requires std::is_base_of_v<Owner, T> Added add(std::string name, std::optional<M> Owner::*member) {
        using Traits = MemberTraits<M>;
        PropertySchema p;
        p.name = std::move(name);
        p.shape = Traits::shape;
        if constexpr (requires { Traits::shapes; }) p.shapes.assign(std::begin(Traits::shapes), std::end(Traits::shapes));
        p.least_values = p.most_values = Traits::count;
        p.optional = true;
        p.direction = std::is_same_v<M, Vector> || std::is_same_v<M, Normal>;
        p.assign = [member](void* object, const std::vector<Value>& values) {
            owner<Owner>(object).*member = Traits::from(values.data());
        };
        p.read = [member](const void* object) {
            std::vector<std::vector<Value>> lines;
            if (const auto& m = owner<Owner>(object).*member) Traits::to(*m, lines.emplace_back());
            return lines;
        };
        return push(std::move(p));
    }

    // A property that may be written several times (Shape::number, colour …: one element a line), or that takes any
    // number of words in one pair of parentheses (std::string: `aov(depth, normal);`).
    template <class Owner, class M>
    requires std::is_base_of_v<Owner, T> Added add(std::string name, std::vector<M> Owner::*member) {
        using Traits = MemberTraits<M>;
        PropertySchema p;
        p.name = std::move(name);
        p.optional = true;
        if constexpr (std::is_same_v<M, std::string>) {
            p.shape = Shape::word;
            p.least_values = 1;
            p.most_values = std::numeric_limits<int>::max();
            p.assign = [member](void* object, const std::vector<Value>& values) {
                auto& list = owner<Owner>(object).*member;
                list.clear();
                for (const Value& v : values) list.push_back(v.text);
            };
            p.read = [member](const void* object) {
                std::vector<std::vector<Value>> lines;
                for (const auto& m : owner<Owner>(object).*member) {
                    if (lines.empty()) lines.emplace_back();
                    lines.back().push_back(word_value(m));
                }
                return lines;
            };
        } else {
            p.shape = Traits::shape;
            p.least_values = p.most_values = Traits::count;
            p.repeats = true;
            p.assign = [member](void* object, const std::vector<Value>& values) {
                (owner<Owner>(object).*member).push_back(Traits::from(values.data()));
            };
            p.read = [member](const void* object) {
                std::vector<std::vector<Value>> lines;
                for (const auto& m : owner<Owner>(object).*member) Traits::to(m, lines.emplace_back());
                return lines;
            };
        }
        return push(std::move(p));
    }

    // An enumeration: the words stand for the values 0, 1, 2 … of the member's enum (or bool) type.
    template <class Owner, class E>
    requires std::is_base_of_v<Owner, T> &&(std::is_enum_v<E> || std::is_same_v<E, bool>)Added
        add(std::string name, E Owner::*member, std::vector<std::string> words) {
        PropertySchema p;
        p.name = std::move(name);
        p.shape = Shape::word;
        p.words = std::move(words);
        p.assign = [member, words = p.words](void* object, const std::vector<Value>& values) {
            for (std::size_t i = 0; i < words.size(); ++i)
                if (words[i] == values[0].text) owner<Owner>(object).*member = static_cast<E>(i);
        };
        p.read = [member, words = p.words](const void* object) {
            const auto index = static_cast<std::size_t>(owner<Owner>(object).*member);
            return std::vector<std::vector<Value>>{{word_value(words.at(index))}};
        };
        return push(std::move(p));
    }

    // An enumeration by its names, and a number that may follow: `filter("mitchell", 2);`.
    template <class Owner, class E>
    requires std::is_base_of_v<Owner, T> && std::is_enum_v<E> Added add(std::string name, E Owner::*member,
                                                                        std::vector<std::string> words,
                                                                        std::optional<double> Owner::*number) {
        const Added added = add(std::move(name), member, std::move(words));
        PropertySchema& p = properties_.back();
        p.shape = Shape::text;
        p.shapes = {Shape::text, Shape::number};
        p.most_values = 2;
        p.assign = [choose = std::move(p.assign), number](void* object, const std::vector<Value>& values) {
            choose(object, values);
            auto& follows = owner<Owner>(object).*number;
            follows.reset();
            if (values.size() > 1) follows = values[1].number;
        };
        p.read = [chosen = std::move(p.read), number](const void* object) {
            std::vector<Value> values{text_value(chosen(object).front().front().text)};
            if (const auto& follows = owner<Owner>(object).*number) values.push_back(number_value(*follows));
            return std::vector<std::vector<Value>>{std::move(values)};
        };
        return added;
    }

    class AddedChild {
    public:
        explicit AddedChild(ChildSchema& child) : child_(child) {}
        AddedChild& help(std::string sentence) {
            child_.help = std::move(sentence);
            return *this;
        }
        AddedChild& optional() {
            child_.optional = true;
            return *this;
        }

    private:
        ChildSchema& child_;
    };

    // A child slot; `Child` is assignable from a MaterialPtr and gives one back by .material().
    template <class Owner, class Child>
    requires std::is_base_of_v<Owner, T> AddedChild child(std::string name, Child Owner::*member) {
        ChildSchema c;
        c.name = std::move(name);
        c.assign = [member](void* object, MaterialPtr child) { owner<Owner>(object).*member = std::move(child); };
        c.read = [member](const void* object) { return std::vector<MaterialPtr>{owner<Owner>(object).*member}; };
        children_.push_back(std::move(c));
        return AddedChild(children_.back());
    }

    // Any number of children, after the single slots.
    template <class Owner, class Child>
    requires std::is_base_of_v<Owner, T> AddedChild children(std::string name, std::vector<Child> Owner::*member) {
        ChildSchema c;
        c.name = std::move(name);
        c.repeats = true;
        c.assign = [member](void* object, MaterialPtr child) { (owner<Owner>(object).*member).push_back(std::move(child)); };
        c.read = [member](const void* object) {
            const auto& list = owner<Owner>(object).*member;
            return std::vector<MaterialPtr>(list.begin(), list.end());
        };
        children_.push_back(std::move(c));
        return AddedChild(children_.back());
    }
    using SchemaBase::children;

    // A condition across properties. The sentence is the error, the help line and the documentation.
    void require(std::string sentence, std::function<bool(const T&)> holds) {
        requirements_.push_back(
            {std::move(sentence), [holds = std::move(holds)](const void* object) { return holds(owner<T>(object)); }});
    }

    // What follows from the properties, computed once all of them are known: so that what is asked for every ray need not be.
    void derive(std::function<void(T&)> compute) {
        derive_ = [compute = std::move(compute)](void* object) { compute(owner<T>(object)); };
    }
    using SchemaBase::derive;

private:
    // Objects travel as pointers to the most derived class.
    template <class Owner>
    static Owner& owner(void* object) {
        return *static_cast<T*>(object);
    }
    template <class Owner>
    static const Owner& owner(const void* object) {
        return *static_cast<const T*>(object);
    }

    Added push(PropertySchema p) {
        properties_.push_back(std::move(p));
        return Added(*this, properties_.size() - 1);
    }
};

}  // namespace lapidary
