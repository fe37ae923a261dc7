// SPDX-License-Identifier: MIT
//
// Measurements of stress tests fail where they must. Their lines in the report are wrong on purpose.

#include "support/measurement.h"

#include <limits>

#include "support/catch.h"

namespace lapidary::test {

TEST_CASE("a measurement within its bound holds") {
    Measurement measured({"unit", "errors up to the bound", "u", 2});
    measured.record(-2);
    measured.record(0.5);
    measured.expect(true);
    CHECK(measured.timed([] { return 7; }) == 7);
}

TEST_CASE("an error beyond the bound fails", "[!shouldfail]") {
    Measurement measured({"unit", "too large, on purpose", "u", 2});
    measured.record(-2.1);
}

TEST_CASE("an error that is no number fails", "[!shouldfail]") {
    Measurement measured({"unit", "no number, on purpose", "u", 2});
    measured.record(std::numeric_limits<double>::quiet_NaN());
}

TEST_CASE("a wrong case fails", "[!shouldfail]") {
    Measurement measured({"unit", "a wrong case, on purpose", "", 0});
    measured.expect(true);
    measured.expect(false);
}

TEST_CASE("a measurement of nothing fails", "[!shouldfail]") {
    const Measurement measured({"unit", "nothing, on purpose", "", 0});
}

}  // namespace lapidary::test
