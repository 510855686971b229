// Laws of the real roots: none missed, none invented, residuals small, multiple roots counted.
#include "base/math/roots.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "support/test.h"

using trilens::real_roots;
using trilens::RealRoots;

namespace {

using Coefficients = std::array<double, 4>;

long double exact_value(const Coefficients& c, long double t) {
    return ((c[3] * t + c[2]) * t + c[1]) * t + c[0];
}

// |p(r)| as a share of the sum of its terms.
double residual(const Coefficients& c, double r) {
    long double sum = 0, power = 1;
    for (const double x : c) sum += std::fabs(x * power), power *= r;
    const long double v = std::fabs(exact_value(c, r));
    return v == 0 ? 0 : static_cast<double>(v / sum);
}

double log_uniform(std::mt19937_64& random, double low, double high) {
    std::uniform_real_distribution<double> exponent(std::log(low), std::log(high));
    const double magnitude = std::exp(exponent(random));
    return random() % 2 ? magnitude : -magnitude;
}

// lead (t - r0)(t - r1)(t - r2), rounded once per coefficient.
Coefficients from_roots(double lead, const std::array<double, 3>& r) {
    const long double a = r[0], b = r[1], c = r[2], l = lead;
    return {static_cast<double>(-l * a * b * c), static_cast<double>(l * (a * b + b * c + c * a)),
            static_cast<double>(-l * (a + b + c)), lead};
}

// The number of real roots of a cubic by its discriminant in long double, or -1 where it is too small to say.
int count_by_discriminant(const Coefficients& k) {
    const long double d = k[0], c = k[1], b = k[2], a = k[3];
    const long double terms[] = {18 * a * b * c * d, -4 * b * b * b * d, b * b * c * c, -4 * a * c * c * c,
                                 -27 * a * a * d * d};
    long double sum = 0, size = 0;
    for (const long double term : terms) sum += term, size += std::fabs(term);
    if (std::fabs(sum) < 1e-12L * size) return -1;
    return sum > 0 ? 3 : 1;
}

}  // namespace

TEST_CASE("roots: random cubics over sixteen decades keep every root", "[base][roots][law]") {
    std::mt19937_64 random(1);
    int three = 0, unsure = 0;
    double worst = 0;
    for (int trial = 0; trial < 300000; ++trial) {
        const Coefficients c{log_uniform(random, 1e-8, 1e8), log_uniform(random, 1e-8, 1e8),
                             log_uniform(random, 1e-8, 1e8), log_uniform(random, 1e-8, 1e8)};
        const RealRoots roots = real_roots(c);
        const int expected = count_by_discriminant(c);
        if (expected < 0) ++unsure;
        if (expected >= 0 && expected != roots.count) FAIL("count at trial " << trial);
        for (const double r : roots) worst = std::max(worst, residual(c, r));
        if (!std::is_sorted(roots.begin(), roots.end())) FAIL("order at trial " << trial);
        three += roots.count == 3;
    }
    CHECK(worst <= trilens::kRootResidual);
    CHECK(three > 30000);
    CHECK(unsure < 300);
}

TEST_CASE("roots: every sign change on a fine grid has its root", "[base][roots][law]") {
    // Independent of any formula: walk outward in steps of 3 % on both sides of zero.
    std::mt19937_64 random(2);
    std::vector<double> grid;
    for (double t = 1e-12; t < 1e12; t *= 1.03) grid.push_back(t), grid.push_back(-t);
    std::sort(grid.begin(), grid.end());
    for (int trial = 0; trial < 3000; ++trial) {
        Coefficients c;
        for (double& x : c) x = random() % 8 ? log_uniform(random, 1e-4, 1e4) : 0.0;
        const RealRoots roots = real_roots(c);
        for (std::size_t i = 0; i + 1 < grid.size(); ++i) {
            const long double a = exact_value(c, grid[i]), b = exact_value(c, grid[i + 1]);
            if (a == 0 || b == 0 || (a < 0) == (b < 0)) continue;
            const auto inside = std::count_if(roots.begin(), roots.end(),
                                              [&](double r) { return r >= grid[i] && r <= grid[i + 1]; });
            if (inside % 2 != 1) FAIL("trial " << trial << " between " << grid[i] << " and " << grid[i + 1]);
        }
    }
}

TEST_CASE("roots: planted roots of any magnitude come back", "[base][roots][law]") {
    std::mt19937_64 random(3);
    double worst = 0;
    for (int trial = 0; trial < 100000; ++trial) {
        std::array<double, 3> planted{log_uniform(random, 1e-8, 1e8), log_uniform(random, 1e-8, 1e8),
                                      log_uniform(random, 1e-8, 1e8)};
        std::sort(planted.begin(), planted.end());
        const Coefficients c = from_roots(log_uniform(random, 1e-8, 1e8), planted);
        // Rounded coefficients move a root by its condition; skip those that are close to another.
        bool apart = true;
        for (std::size_t i = 0; i < 2; ++i) {
            apart &= planted[i + 1] - planted[i] >
                     1e-3 * std::max(std::fabs(planted[i]), std::fabs(planted[i + 1]));
        }
        if (!apart) continue;
        const RealRoots roots = real_roots(c);
        if (roots.count != 3) FAIL("count " << roots.count << " at trial " << trial);
        for (std::size_t i = 0; i < 3; ++i) {
            worst = std::max(worst, std::fabs(roots.root[i] - planted[i]) / std::fabs(planted[i]));
        }
    }
    CHECK(worst < 1e-8);
}

TEST_CASE("roots: a double root is returned twice, a triple root three times", "[base][roots][law]") {
    std::mt19937_64 random(4);
    double worst_double = 0, worst_triple = 0, worst_residual = 0;
    for (int trial = 0; trial < 50000; ++trial) {
        const double lead = log_uniform(random, 1e-8, 1e8), r = log_uniform(random, 1e-4, 1e4);
        const double s = log_uniform(random, 1e-4, 1e4);
        // A third root close to the double one makes it nearly triple: another case.
        if (std::fabs(r - s) > 0.1 * std::max(std::fabs(r), std::fabs(s))) {
            const Coefficients c = from_roots(lead, {r, r, s});
            const RealRoots roots = real_roots(c);
            if (roots.count != 3) FAIL("double: count " << roots.count << " at trial " << trial);
            const std::size_t at = r < s ? 0 : 1;
            for (const std::size_t i : {at, at + 1}) {
                worst_double = std::max(worst_double, std::fabs(roots.root[i] - r) / std::fabs(r));
            }
            for (const double t : roots) worst_residual = std::max(worst_residual, residual(c, t));
        }
        const Coefficients cube = from_roots(lead, {r, r, r});
        const RealRoots triple = real_roots(cube);
        if (triple.count != 3) FAIL("triple: count " << triple.count << " at trial " << trial);
        for (const double t : triple) {
            worst_triple = std::max(worst_triple, std::fabs(t - r) / std::fabs(r));
            worst_residual = std::max(worst_residual, residual(cube, t));
        }
    }
    CHECK(worst_double < 1e-6);
    CHECK(worst_triple < 1e-4);
    CHECK(worst_residual <= trilens::kRootResidual);

    const RealRoots exact = real_roots({-4, 8, -5, 1});  // (t - 1)(t - 2)^2
    REQUIRE(exact.count == 3);
    CHECK(exact.root[0] == Approx(1).epsilon(1e-15));
    CHECK(exact.root[1] == 2);
    CHECK(exact.root[2] == 2);
}

TEST_CASE("roots: quadratics, lines and constants", "[base][roots]") {
    std::mt19937_64 random(5);
    for (int trial = 0; trial < 100000; ++trial) {
        const double a = log_uniform(random, 1e-8, 1e8), r = log_uniform(random, 1e-8, 1e8);
        const double s = trial % 3 ? log_uniform(random, 1e-8, 1e8) : r;
        const Coefficients c{
            static_cast<double>(static_cast<long double>(a) * r * s),
            static_cast<double>(-static_cast<long double>(a) * (static_cast<long double>(r) + s)), a, 0};
        const RealRoots roots = real_roots(c);
        if (roots.count != 2) FAIL("count " << roots.count << " at trial " << trial);
        for (const double t : roots) {
            if (residual(c, t) > trilens::kRootResidual) FAIL("residual at trial " << trial);
        }
        if (r == s && std::fabs(roots.root[0] - r) > 1e-7 * std::fabs(r))
            FAIL("double root at trial " << trial);
    }
    CHECK(real_roots({1, 1, 1, 0}).count == 0);
    CHECK(real_roots({5, 0, 0, 0}).count == 0);
    CHECK_FALSE(real_roots({5, 0, 0, 0}).all);
    CHECK(real_roots({0, 0, 0, 0}).all);
    CHECK(real_roots({0, 0, 0, 0}).count == 0);
    const RealRoots line = real_roots({-3, 2, 0, 0});
    REQUIRE(line.count == 1);
    CHECK(line.root[0] == 1.5);
    const RealRoots zeros = real_roots({0, 0, -3, 2});
    REQUIRE(zeros.count == 3);
    CHECK(zeros.root == (std::array<double, 3>{0, 0, 1.5}));
}

TEST_CASE("roots: a negligible leading coefficient loses no finite root", "[base][roots]") {
    // (t - 1)(t + 2) with ever smaller cubic terms: the third root leaves for infinity.
    for (int exponent = 0; exponent < 300; ++exponent) {
        for (const double sign : {-1.0, 1.0}) {
            const double tiny = sign * std::pow(10.0, -exponent);
            const RealRoots roots = real_roots({-2, 1, 1, tiny});
            if (exponent > 3) {
                REQUIRE(roots.count == (exponent < 100 ? 3 : 2));
                const std::size_t first = exponent < 100 && sign > 0 ? 1 : 0;
                CHECK(roots.root[first] == Approx(-2).epsilon(1e-2));
                CHECK(roots.root[first + 1] == Approx(1).epsilon(1e-2));
                if (exponent < 100) CHECK(roots.root[sign > 0 ? 0 : 2] == Approx(-1 / tiny).epsilon(1e-2));
            }
            CHECK(real_roots({-2, tiny, 0, 0}).count == (exponent < 100 ? 1 : 0));
        }
    }
}

TEST_CASE("roots: scaling the polynomial or its variable scales the roots", "[base][roots][law]") {
    std::mt19937_64 random(6);
    std::uniform_real_distribution<double> uniform(-1, 1);
    for (int trial = 0; trial < 20000; ++trial) {
        const Coefficients c{uniform(random), uniform(random), uniform(random), uniform(random)};
        const RealRoots plain = real_roots(c);
        // Powers of two are exact, so the roots must agree to their last bits.
        const int f = static_cast<int>(random() % 400) - 200, s = static_cast<int>(random() % 60) - 30;
        Coefficients scaled;
        for (int i = 0; i < 4; ++i) {
            scaled[static_cast<std::size_t>(i)] = std::ldexp(c[static_cast<std::size_t>(i)], f - i * s);
        }
        const RealRoots roots = real_roots(scaled);
        if (roots.count != plain.count) FAIL("count at trial " << trial);
        for (int i = 0; i < roots.count; ++i) {
            const std::size_t k = static_cast<std::size_t>(i);
            if (residual(scaled, std::ldexp(plain.root[k], s)) > trilens::kRootResidual)
                FAIL("trial " << trial);
            if (residual(scaled, roots.root[k]) > trilens::kRootResidual) FAIL("trial " << trial);
        }
    }
}
