// SPDX-License-Identifier: MIT
//
// One number for many: where it is the same, their bits are the same.
#pragma once

#include <bit>
#include <cstdint>

namespace lapidary::test {

// FNV-1a, over the bits of numbers.
class Fingerprint {
public:
    void add(double number) { add(std::bit_cast<std::uint64_t>(number), 64); }
    void add(float number) { add(std::bit_cast<std::uint32_t>(number), 32); }
    std::uint64_t value() const { return hash_; }

private:
    void add(std::uint64_t bits, int count) {
        for (int shift = 0; shift < count; shift += 8) hash_ = (hash_ ^ ((bits >> shift) & 0xff)) * 0x100000001b3;
    }
    std::uint64_t hash_ = 0xcbf29ce484222325;
};

}  // namespace lapidary::test
