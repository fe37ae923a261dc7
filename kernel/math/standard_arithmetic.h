// SPDX-License-Identifier: MIT
//
// The arithmetic that everything here counts on: results rounded to nearest, small ones kept and not flushed to zero, no traps.
// A program may have set other modes for itself (audio and game engines like to flush), and exact sums, bounds and the
// roots of tiny solids do not survive them.
#pragma once

#include <cfenv>

namespace lapidary {

// Sets it for the thread while it lives, then puts back what was set before.
class StandardArithmetic {
public:
    StandardArithmetic() {
        std::fegetenv(&before_);
        std::fesetenv(FE_DFL_ENV);
    }
    ~StandardArithmetic() { std::fesetenv(&before_); }
    StandardArithmetic(const StandardArithmetic&) = delete;
    StandardArithmetic& operator=(const StandardArithmetic&) = delete;

private:
    std::fenv_t before_{};
};

}  // namespace lapidary
