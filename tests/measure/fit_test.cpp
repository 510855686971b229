// Power laws are found again.
#include "measure/common/statistics.h"

#include <cmath>
#include <limits>
#include <random>

#include "support/test.h"

using namespace trilens;

namespace {

std::vector<FitPoint> law(double constant, double order, const std::vector<double>& ns) {
    std::vector<FitPoint> points;
    for (const double n : ns) points.push_back({n, constant * std::pow(n, -order)});
    return points;
}

}  // namespace

TEST_CASE("an exact law is recovered at any scale", "[measure][fit][law]") {
    for (const double order : {0.5, 1.0, 2.0, 4.0, -1.0}) {
        for (const double constant : {1e-6, 0.3, 7.0, 1e8}) {
            const Fit fit = fit_power_law(law(constant, order, {64, 4, 16, 8, 32})).value();
            CHECK(fit.order == Approx(order).epsilon(1e-9));
            CHECK(fit.constant == Approx(constant).epsilon(1e-8));
            CHECK(fit.r2 == Approx(1).epsilon(1e-12));
            CHECK(fit.n_for_1.has_value() == (order > 0 && std::pow(constant, 1 / order) <= 1e15));
            if (!fit.n_for_1) continue;
            // The smallest n that is good enough.
            const double n = *fit.n_for_1;
            CHECK(constant * std::pow(n, -order) <= 1 + 1e-6);
            if (n > 1) CHECK(constant * std::pow(n - 1, -order) > 1 - 1e-6);
            if (fit.n_for_half) CHECK(*fit.n_for_half >= n);
        }
    }
    const Fit round = fit_power_law(law(64, 2, {2, 4, 8})).value();
    CHECK(*round.n_for_1 == 8);  // exactly, not 9 by rounding
    CHECK(*round.n_for_half == 12);
}

TEST_CASE("noise moves the order by little", "[measure][fit]") {
    std::mt19937 random(5);
    std::normal_distribution<double> noise(0, 0.05);
    std::vector<FitPoint> points = law(3, 2, {2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64});
    for (FitPoint& point : points) point.error *= std::exp(noise(random));
    const Fit fit = fit_power_law(points).value();
    CHECK(fit.order == Approx(2).margin(0.06));
    CHECK(fit.r2 > 0.99);
    CHECK(fit.r2 < 1);
}

TEST_CASE("points that are no numbers take no part", "[measure][fit]") {
    std::vector<FitPoint> points = law(5, 2, {4, 8, 16});
    const double nan = std::numeric_limits<double>::quiet_NaN(),
                 infinity = std::numeric_limits<double>::infinity();
    for (const FitPoint bad :
         {FitPoint{32, 0}, {64, nan}, {128, infinity}, {0, 1}, {-4, 1}, {nan, 1}, {32, -1}})
        points.push_back(bad);
    const Fit fit = fit_power_law(points).value();
    CHECK(fit.order == Approx(2));
    CHECK(fit.used == std::vector<bool>{true, true, true, false, false, false, false, false, false, false});

    CHECK_FALSE(fit_power_law({}).has_value());
    CHECK_FALSE(fit_power_law(std::vector<FitPoint>{{4, 1}}).has_value());
    CHECK_FALSE(fit_power_law(std::vector<FitPoint>{{4, 1}, {4, 2}, {8, 0}}).has_value());
}

TEST_CASE("a plateau is left out where that is asked for", "[measure][fit]") {
    std::vector<FitPoint> points = law(2, 2, {4, 8, 16, 32, 64, 128, 256});
    for (FitPoint& point : points) point.error = std::max(point.error, 1e-3);
    CHECK(fit_power_law(points)->order < 1.8);
    FitOptions options;
    options.drop_plateau = true;
    const Fit fit = fit_power_law(points, options).value();
    CHECK(fit.order == Approx(2).margin(0.05));
    CHECK_FALSE(fit.used[6]);
    options = {};
    options.floor = 1e-3;
    CHECK(fit_power_law(points, options)->order == Approx(2));

    // Without a plateau nothing is left out.
    options = {};
    options.drop_plateau = true;
    const auto whole = law(2, 2, {4, 8, 16, 32});
    CHECK(fit_power_law(whole, options)->used == std::vector<bool>(4, true));
}

TEST_CASE(
    "fit: Student's t is that of the tables, and the interval of an order covers it as often as it says",
    "[measure][oracle][law]") {
    // Abramowitz and Stegun, table 26.10: 95 % and 99 %, both sides.
    const std::vector<std::pair<int, double>> table = {{1, 12.706}, {2, 4.303},  {3, 3.182},  {4, 2.776},
                                                       {5, 2.571},  {10, 2.228}, {30, 2.042}, {120, 1.980}};
    for (const auto& [degrees, t] : table) CHECK(student_t(degrees, 0.95) == Approx(t).margin(0.0006));
    CHECK(student_t(7, 0.99) == Approx(3.499).margin(0.0006));
    CHECK(student_t(2, 0.9) == Approx(2.920).margin(0.0006));

    std::mt19937 random(7);
    std::normal_distribution<double> noise(0, 0.1);
    int covered = 0;
    constexpr int kTrials = 2000;
    for (int trial = 0; trial < kTrials; ++trial) {
        std::vector<FitPoint> points;
        for (const double n : {1.0, 2.0, 4.0, 8.0, 16.0})
            points.push_back({n, 3 * std::pow(n, -2) * std::exp(noise(random))});
        const Fit fit = fit_power_law(points).value();
        covered += fit.order_low.value() <= 2 && 2 <= fit.order_high.value();
    }
    CHECK(covered / double(kTrials) == Approx(0.95).margin(0.02));
    CHECK(!fit_power_law(std::vector<FitPoint>{{1, 1}, {2, 0.25}})->order_low);
}
