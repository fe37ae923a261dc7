// SPDX-License-Identifier: MIT
//
// Blocks, loops and includes within one another, bounded so that no input overflows the stack.
#pragma once

namespace lapidary::scene_language {

inline constexpr int deepest_nesting = 1000;

class Nesting {
public:
    explicit Nesting(int& depth) : depth_(depth) { ++depth_; }
    ~Nesting() { --depth_; }
    Nesting(const Nesting&) = delete;
    Nesting& operator=(const Nesting&) = delete;

private:
    int& depth_;
};

}  // namespace lapidary::scene_language
