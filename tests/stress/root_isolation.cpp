// SPDX-License-Identifier: MIT
//
// T22: sign changes of polynomials of degree 4 to 8, with simple roots, double roots and clusters, isolated in doubles and
// counted in 200-bit arithmetic. What goes deeper than the search promises must be found, and nothing that is not there.
#include <fmt/format.h>
#include <lapidary/root_isolation.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "stress/exact.h"
#include "support/catch.h"
#include "support/measurement.h"

namespace lapidary::test {
namespace {

// Scaled so that the magnitudes of its coefficients add up to 1: on [0, 1] its values do not exceed that.
struct ScaledPolynomial {
    std::vector<double> coefficients;
    bool touches_zero = false;

    explicit ScaledPolynomial(const std::vector<double>& roots) : coefficients{1} {
        for (double root : roots) {
            std::vector<double> next(coefficients.size() + 1, 0.0);
            for (std::size_t i = 0; i < coefficients.size(); ++i) {
                next[i + 1] += coefficients[i];
                next[i] -= root * coefficients[i];
            }
            coefficients = next;
        }
        double sum = 0;
        for (double c : coefficients) sum += std::fabs(c);
        for (double& c : coefficients) c /= sum;
    }

    Slope operator()(double t) const {
        Slope f;
        for (auto c = coefficients.rbegin(); c != coefficients.rend(); ++c) {
            f.slope = f.slope * t + f.value;
            f.value = f.value * t + *c;
        }
        return f;
    }
    double curvature() const {
        double bound = 0;
        for (std::size_t i = 2; i < coefficients.size(); ++i)
            bound += static_cast<double>(i * (i - 1)) * std::fabs(coefficients[i]);
        return bound;
    }
    Polynomial exact() const { return {coefficients.begin(), coefficients.end()}; }
};

bool is_above(double value) { return value > 0; }
using Search = FirstChange<ScaledPolynomial, decltype(is_above)>;

std::vector<double> isolated(const ScaledPolynomial& f, double step = 0x1p-8) {
    Search search(f, f.curvature(), is_above);
    std::vector<double> places;
    for (double t = 0; (t = search.find(t, 1, step)) < infinity;) places.push_back(t);
    return places;
}

// Whether a value is beyond what Horner's rule in doubles rounds away: 2 n u times the sum of the terms' magnitudes.
bool is_clear(const Exact& value) { return abs(value) > 0x1p-48; }

void compare(const ScaledPolynomial& f, Measurement& counts, Measurement& places) {
    const Polynomial exact = f.exact();
    const auto truth = sign_changes(exact, 0, 1);
    const auto found = isolated(f);
    // Between neighbouring changes the polynomial must go deep enough for both of them to count.
    const double least = Search::lost_depth(f.curvature(), 0x1p-8);
    std::vector<bool> deep;
    for (std::size_t i = 0; i <= truth.size(); ++i) {
        const Exact low = i == 0 ? Exact(0) : truth[i - 1], high = i == truth.size() ? Exact(1) : truth[i];
        deep.push_back(abs(evaluate(exact, (low + high) / 2)) > least);
    }
    for (std::size_t i = 0; i < truth.size(); ++i) {
        if (!deep[i] || !deep[i + 1]) continue;
        Exact nearest = 1;
        for (double t : found) nearest = std::min(nearest, Exact(abs(Exact(t) - truth[i])));
        places.record(static_cast<double>(nearest) * std::fabs(f(static_cast<double>(truth[i])).slope) / u);
    }
    // Where nothing is shallow, nothing is found twice. What only touches zero may be, in the rounding of the values.
    const bool all_deep = std::all_of(deep.begin(), deep.end(), [](bool is_deep) { return is_deep; });
    if (all_deep && !f.touches_zero) counts.expect(found.size() == truth.size());
    // Nothing is found where the polynomial is clear of zero.
    for (double t : found) counts.expect(!is_clear(evaluate(exact, t)));
}

void check_polynomials(int count) {
    struct Case {
        const char* what;
        bool doubled;
        int clustered;
    };
    Random random(22);
    for (const Case& c : {Case{"simple roots", false, 0}, Case{"a double root", true, 0}, Case{"a cluster of roots", false, 4}}) {
        Measurement counts({"T22", fmt::format("polynomials with {}", c.what), "", 0}),
            places({"T22", fmt::format("{}, where", c.what), "u / slope", 2});
        std::vector<ScaledPolynomial> all;
        for (int i = 0; i < count; ++i) {
            const int degree = 4 + i % 5;
            std::vector<double> roots;
            for (int k = 0; k < degree; ++k) roots.push_back(random.uniform(-0.2, 1.2));
            if (c.doubled) roots[1] = roots[0];
            // Evenly spaced, as Wilkinson's, and close together.
            for (int k = 0; k < c.clustered; ++k)
                roots[static_cast<std::size_t>(k)] = 0.5 + (k - 1.5) * std::pow(10, -random.uniform(0.5, 3.0));
            all.emplace_back(roots).touches_zero = c.doubled;
            compare(all.back(), counts, places);
        }
        counts.time(all, [](const ScaledPolynomial& f) { return isolated(f).size(); });
    }
}

}  // namespace

TEST_CASE("T22: sign changes of polynomials are found, and no others") { check_polynomials(70); }
TEST_CASE("T22: a place where a polynomial is flat does not hide what comes behind it") {
    Measurement measured({"T22", "roots in one step with a fourfold one", "", 0});
    Random random(4);
    for (int i = 0; i < 50; ++i) {
        const double flat = random.uniform(0.05, 0.3), in = random.uniform(0.51, 0.65), out = random.uniform(0.8, 0.99);
        const auto found = isolated(ScaledPolynomial({flat, flat, flat, flat, in, out}), 1);
        for (const double root : {in, out})
            measured.expect(std::any_of(found.begin(), found.end(), [&](double t) { return std::fabs(t - root) < 1e-9; }));
    }
}
TEST_CASE("T22: sign changes of six thousand polynomials", "[.long]") { check_polynomials(2000); }

}  // namespace lapidary::test
