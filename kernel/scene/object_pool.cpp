// SPDX-License-Identifier: MIT
#include "kernel/scene/object_pool.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>

namespace lapidary {

namespace {

// What words and texts say may depend on where they stand.
bool is_of_numbers(const GivenProperty& given) {
    const Shape shape = given.schema->shape;
    return given.schema->shapes.empty() && (shape == Shape::number || shape == Shape::integer || shape == Shape::colour);
}

std::uint64_t bits_of(const Value& value) { return std::bit_cast<std::uint64_t>(value.number); }

// The same in every run: what shares an object may be told from what does not where solids without known faces coincide.
std::uint64_t hash_of(const Plugin& plugin, const std::vector<GivenProperty>& properties) {
    std::uint64_t hash = std::hash<std::string>()(plugin.keyword());
    for (const GivenProperty& given : properties)
        for (const Value& value : given.property->values) {
            const std::uint64_t bits = bits_of(value);
            hash = (std::rotl(hash, 29) ^ bits ^ bits >> 32) * 0x9E3779B97F4A7C15;  // what differs in numbers is mostly high bits
        }
    return hash;
}

bool are_same(const GivenProperty& a, const GivenProperty& b) {
    return a.schema == b.schema && std::ranges::equal(a.property->values, b.property->values, {}, bits_of, bits_of);
}

}  // namespace

std::shared_ptr<const Object> ObjectPool::share(std::shared_ptr<const Object> object, const Plugin& plugin,
                                                std::vector<GivenProperty> properties) {
    if (!std::ranges::all_of(properties, is_of_numbers)) return object;
    const std::uint64_t hash = hash_of(plugin, properties);
    Kept& kept = kept_[(hash >> 48) % kept_.size()];
    const bool is_alike =
        kept.hash == hash && kept.plugin == &plugin && std::ranges::equal(kept.properties, properties, are_same);
    if (!is_alike) kept = {hash, &plugin, std::move(properties), std::move(object)};
    return kept.object;
}

}  // namespace lapidary
