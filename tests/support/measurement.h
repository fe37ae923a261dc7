// SPDX-License-Identifier: MIT
//
// What a stress test measures: the worst error of many cases against its bound, the cases that are wrong, and what one costs.
//
//     Measurement measured({"T02", "unit ball, far away", "u D / cos", 2});   // test, what, unit of the error, bound
//     for (const Case& c : cases) {
//         measured.expect(hits(c) == truly_hits(c));                          // a case that is right or wrong
//         measured.record(error(c));                                          // a case that is off by so much
//     }
//     measured.time(lines, [&](const LocalLine& line) { return ball_span(line, 1); });
//
// At its end it checks that no case was wrong and no error beyond the bound; a test without cases fails, too. What is only
// right or wrong has the bound 0 and no unit. The time of a case is measured, never judged.
//
// When all tests have run the program prints a table of all measurements. The variable LAPIDARY_STRESS_REPORT names a file
// to which they are appended as well, as comma-separated values; rows of the same test and name are one measurement.
#pragma once

#include <chrono>
#include <cstddef>
#include <string>
#include <vector>

namespace lapidary::test {

// What is measured.
struct Question {
    std::string test;  // as the catalogue numbers it: "T02"
    std::string what;  // of a few words
    std::string unit;  // of the error and its bound; empty where there is only right and wrong
    double bound = 0;  // on the error
};

// What came of it.
struct Findings {
    double worst = 0;  // of the errors; NaN counts as infinite
    std::size_t cases = 0, failures = 0;
    double nanoseconds = 0;  // of all timed cases together
    std::size_t timed = 0;
};

class Measurement {
public:
    explicit Measurement(Question question) : question_(std::move(question)) {}
    // Checks and reports.
    ~Measurement() noexcept(false);
    Measurement(const Measurement&) = delete;
    Measurement& operator=(const Measurement&) = delete;

    void record(double error);
    void expect(bool right);

    // Times a short piece of work: runs through all inputs, several times, and takes the quickest round.
    template <class Inputs, class Work>
    void time(const Inputs& inputs, const Work& work) {
        std::chrono::nanoseconds best = std::chrono::nanoseconds::max();
        const auto start = Clock::now();
        do {
            const auto begin = Clock::now();
            for (const auto& input : inputs) keep(work(input));
            best = std::min(best, std::chrono::nanoseconds(Clock::now() - begin));
        } while (Clock::now() - start < std::chrono::milliseconds(2));
        add_time(best, std::size(inputs));
    }

    // Does a longer piece of work, of a microsecond or more, once and adds its time: as much as `cases` cases take.
    template <class Work>
    auto timed(const Work& work, std::size_t cases = 1) {
        const auto begin = Clock::now();
        auto result = work();
        add_time(Clock::now() - begin, cases);
        return result;
    }

private:
    using Clock = std::chrono::steady_clock;

    // Makes the compiler believe that somebody reads the value.
    template <class Value>
    static void keep(const Value& value) {
        asm volatile("" : : "r"(&value) : "memory");
    }
    void add_time(std::chrono::nanoseconds time, std::size_t cases);

    Question question_;
    Findings findings_;
};

}  // namespace lapidary::test
