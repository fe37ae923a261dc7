// SPDX-License-Identifier: MIT
//
// Random instances of every plugin, made from its schema alone: the laws of this folder must hold for all of them.
#pragma once

#include <memory>
#include <random>
#include <string>
#include <vector>

#include "kernel/registry/registry.h"

namespace lapidary::test {

// The same numbers in every run.
class Random {
public:
    explicit Random(unsigned seed) : engine_(seed) {}
    double uniform(double low, double high) { return low + (high - low) * unit_(engine_); }
    int below(int count) { return static_cast<int>(uniform(0, count)); }
    // Of any size between two powers of ten.
    double magnitude(double low_exponent, double high_exponent);
    // A unit vector.
    Vector direction();

private:
    std::mt19937_64 engine_;
    std::uniform_real_distribution<double> unit_{0, 1};
};

// The plugins of the build, opened once.
Registry& registry();
// Fails the test where the plugin is missing or refused.
const Plugin& plugin(PluginKind kind, const std::string& keyword);

// Values that the property takes: within its range, or near its default where it has none.
std::vector<Value> random_values(const PropertySchema& property, Random& random);
// Gives random values to every property of numbers and words, so that all requirements hold. `object` is the most derived
// object.
void randomize(void* object, const SchemaBase& schema, Random& random);

std::unique_ptr<Object> random_object(const Plugin& plugin, Random& random);
std::unique_ptr<Light> random_light(const Plugin& plugin, Random& random);
// With children of any kind, nested so deep at most.
MaterialPtr random_material(const Plugin& plugin, Random& random, int depth);

// What an instance looks like, for the report of a failure.
std::string describe(const void* object, const SchemaBase& schema);

}  // namespace lapidary::test
