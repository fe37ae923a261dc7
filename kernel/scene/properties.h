// SPDX-License-Identifier: MIT
//
// Values checked against a schema and put into the object that it describes.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "kernel/registry/schema.h"
#include "kernel/report/messages.h"
#include "kernel/scene/build_context.h"
#include "kernel/scene/document.h"

namespace lapidary {

// Reads the properties of one block, which must stay where they are.
class PropertyReader {
public:
    // `target`: the object that the schema describes, as a pointer to its most derived class.
    PropertyReader(const SchemaBase& schema, void* target, std::string_view owner, const BuildContext& context)
        : schema_(schema), target_(target), owner_(owner), context_(context), messages_(context.messages) {}

    // False where the schema has no property of this keyword; all else is done or reported.
    bool read(const Property& property);
    // A block whose keyword is one of the properties: `radius { }` where `radius( );` is meant. False for other blocks.
    bool report_block(const Block& block);
    // Checks the conditions across properties, and lets the object derive what follows from them; to be called after the last
    // property. False where that fails.
    bool finish(const Place& place);

    // What was read, in the order of writing.
    std::vector<GivenProperty> take_given() { return std::move(given_); }
    // Where a property stands first; null where the block does not give it.
    const Place* place_of(std::string_view keyword) const;
    bool failed() const { return failed_; }
    std::vector<std::string> known() const;

private:
    bool check(const PropertySchema& schema, const Property& property);
    bool check_value(const PropertySchema& schema, const Value& value, Shape shape);
    void assign(const PropertySchema& schema, const Property& property);
    void derive(const Place& place);
    void error(const Place& place, std::string text);

    const SchemaBase& schema_;
    void* target_;
    std::string_view owner_;
    const BuildContext& context_;
    Messages& messages_;
    std::vector<GivenProperty> given_;
    bool failed_ = false;
};

// "'radius' takes 1 value, not 2: radius(r);" and the like: how a property is written.
std::string takes(const std::string& keyword, const std::string& signature, int least, int most, std::size_t given);
// " (did you mean 'width'?)" where a word in a number's place looks like a misspelt constant, else nothing.
std::string constant_meant(const Value& value, const BuildContext& context);
// "a, b and c"
std::string list_of(const std::vector<std::string>& words);
// Warns of a bare angle beyond a full turn.
void warn_of_degrees(const Value& value, Messages& messages);

}  // namespace lapidary
