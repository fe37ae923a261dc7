// SPDX-License-Identifier: MIT
//
// How progress is told: durations, the estimate of the time that is left, the bar.
#include "apps/lapidary/progress.h"

#include "support/catch.h"

using namespace lapidary;

TEST_CASE("durations are told with two digits that matter") {
    CHECK(format_duration(0.04) == "0.0 s");
    CHECK(format_duration(1.25) == "1.3 s");
    CHECK(format_duration(9.96) == "10 s");
    CHECK(format_duration(59.4) == "59 s");
    CHECK(format_duration(59.6) == "1 min 00 s");
    CHECK(format_duration(187) == "3 min 07 s");
    CHECK(format_duration(3600 * 2 + 60 * 5 + 3) == "2 h 05 min");
    CHECK(format_duration(-1) == "unknown time");
    CHECK(format_duration(std::nan("")) == "unknown time");
}

TEST_CASE("at a steady speed the remaining time is exact") {
    RemainingTime remaining;
    CHECK_FALSE(remaining.seconds());
    for (int i = 1; i <= 50; ++i) remaining.update(0.1 * i, 0.01 * i);
    REQUIRE(remaining.seconds());
    CHECK(*remaining.seconds() == Approx(5));
}

TEST_CASE("the estimate follows a change of speed") {
    RemainingTime remaining;
    for (int i = 1; i <= 100; ++i) remaining.update(0.1 * i, 0.005 * i);              // half done in ten seconds
    for (int i = 1; i <= 100; ++i) remaining.update(10 + 0.1 * i, 0.5 + 0.0005 * i);  // then ten times slower
    CHECK(*remaining.seconds() == Approx(0.45 / 0.005).epsilon(0.1));
}

TEST_CASE("nothing is promised too early, nor where nothing moves") {
    RemainingTime remaining;
    remaining.update(0.2, 0.5);
    CHECK_FALSE(remaining.seconds());
    RemainingTime stuck;
    stuck.update(10, 0);
    CHECK_FALSE(stuck.seconds());
}

TEST_CASE("percent never shows the end before it is there") {
    CHECK(progress_text(0.9999, std::nullopt) == "99 %");
    CHECK(progress_text(1, std::nullopt) == "100 %");
    CHECK(progress_text(0.371, 12.2) == "37 %, 12 s left");
}

TEST_CASE("the bar fills from the left and fits every width") {
    CHECK(progress_bar(0.5, std::nullopt, 28) == "[##########----------]  50 %");
    CHECK(progress_bar(0, std::nullopt, 28).find('#') == std::string::npos);
    CHECK(progress_bar(1, std::nullopt, 28).find('-') == std::string::npos);
    for (std::size_t columns = 0; columns < 200; ++columns) CHECK(progress_bar(0.37, 12.0, columns).size() <= columns);
    CHECK(progress_bar(0.37, 12.0, 200).size() <= 80);
}
