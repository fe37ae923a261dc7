// SPDX-License-Identifier: MIT
#include "support/measurement.h"

#define CATCH_CONFIG_EXTERNAL_INTERFACES  // Catch2 2.13 hides listeners otherwise

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <iostream>
#include <iterator>
#include <limits>

#include "support/catch.h"

namespace lapidary::test {
namespace {

struct Row {
    Question question;
    Findings findings;
};

// All rows of this run, those of one test and name as one.
class Report {
public:
    static Report& of_this_run() {
        static Report report;
        return report;
    }

    void add(const Question& question, const Findings& findings) {
        const auto same = [&](const Row& row) {
            return row.question.test == question.test && row.question.what == question.what;
        };
        const auto row = std::find_if(rows_.begin(), rows_.end(), same);
        if (row == rows_.end()) {
            rows_.push_back({question, findings});
            return;
        }
        Findings& sum = row->findings;
        sum.worst = std::max(sum.worst, findings.worst);
        sum.cases += findings.cases;
        sum.failures += findings.failures;
        sum.nanoseconds += findings.nanoseconds;
        sum.timed += findings.timed;
    }

    void tell() {
        if (rows_.empty()) return;
        std::stable_sort(rows_.begin(), rows_.end(),
                         [](const Row& a, const Row& b) { return a.question.test < b.question.test; });
        std::cout << table();
        if (const char* file = std::getenv("LAPIDARY_STRESS_REPORT")) append_to(file);
    }

private:
    // A duration for the eye.
    static std::string duration(double nanoseconds) {
        if (nanoseconds < 1000) return fmt::format("{:.1f} ns", nanoseconds);
        if (nanoseconds < 1e6) return fmt::format("{:.1f} us", nanoseconds / 1e3);
        return fmt::format("{:.1f} ms", nanoseconds / 1e6);
    }

    std::string table() const {
        std::size_t name = 4, width = 4;
        for (const auto& [question, findings] : rows_) {
            name = std::max(name, question.test.size());
            width = std::max(width, question.what.size());
        }
        std::string text = fmt::format("\n{:<{}}  {:<{}}  {:>9} {:>9}  {:<16} {:>9} {:>8} {:>9}\n", "test", name, "what", width,
                                       "worst", "bound", "unit", "cases", "failures", "a case");
        for (const auto& [question, findings] : rows_) {
            const bool measured = !question.unit.empty();
            text += fmt::format("{:<{}}  {:<{}}  {:>9} {:>9}  {:<16} {:>9} {:>8} {:>9}\n", question.test, name, question.what,
                                width, measured ? fmt::format("{:.3g}", findings.worst) : "",
                                measured ? fmt::format("{:.3g}", question.bound) : "", question.unit, findings.cases,
                                findings.failures, findings.timed ? duration(findings.nanoseconds / findings.timed) : "");
        }
        return text;
    }

    // One writing for all lines, so that tests that run side by side do not tear each other's.
    void append_to(const char* name) const {
        std::string lines;
        if (std::ifstream(name).peek() == std::ifstream::traits_type::eof())
            lines = "test,what,worst,bound,unit,cases,failures,nanoseconds\n";
        for (const auto& [question, findings] : rows_)
            lines += fmt::format("{},\"{}\",{},{},\"{}\",{},{},{}\n", question.test, question.what, findings.worst,
                                 question.bound, question.unit, findings.cases, findings.failures,
                                 findings.timed ? fmt::format("{:.2f}", findings.nanoseconds / findings.timed) : "");
        std::ofstream file(name, std::ios::app);
        file << lines << std::flush;
        if (!file) std::cerr << name << ": cannot be written\n";
    }

    std::vector<Row> rows_;
};

#if defined(LAPIDARY_CATCH2_VERSION) && LAPIDARY_CATCH2_VERSION >= 3
using Listener = Catch::EventListenerBase;
#else
using Listener = Catch::TestEventListenerBase;
#endif

class ReportAtTheEnd final : public Listener {
public:
    using Listener::Listener;
    void testRunEnded(const Catch::TestRunStats&) override { Report::of_this_run().tell(); }
};

}  // namespace

void Measurement::record(double error) {
    const double size = std::isnan(error) ? std::numeric_limits<double>::infinity() : std::fabs(error);
    findings_.worst = std::max(findings_.worst, size);
    expect(size <= question_.bound);
}

void Measurement::expect(bool right) {
    ++findings_.cases;
    findings_.failures += !right;
}

void Measurement::add_time(std::chrono::nanoseconds time, std::size_t cases) {
    findings_.nanoseconds += static_cast<double>(time.count());
    findings_.timed += cases;
}

Measurement::~Measurement() noexcept(false) {
    Report::of_this_run().add(question_, findings_);
    if (std::uncaught_exceptions() > 0) return;  // the test has failed already
    INFO(question_.test << ", " << question_.what << " [" << question_.unit << "]");
    CHECK(findings_.cases > 0);
    CHECK(findings_.failures == 0);
    CHECK(findings_.worst <= question_.bound);
}

CATCH_REGISTER_LISTENER(ReportAtTheEnd)

}  // namespace lapidary::test
