#include "measure/common/statistics.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "base/util/error.h"

namespace trilens {
namespace {

std::vector<std::size_t> usable_by_n(std::span<const FitPoint> points, double floor) {
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const auto [n, error] = points[i];
        if (std::isfinite(n) && n > 0 && std::isfinite(error) && error > 0 && error > floor)
            order.push_back(i);
    }
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return points[a].n < points[b].n; });
    return order;
}

/// The order that each step from one run to the next finer one shows; steps between equal n show none.
std::vector<double> step_orders(std::span<const FitPoint> points, const std::vector<std::size_t>& runs) {
    std::vector<double> orders;
    for (std::size_t i = 1; i < runs.size(); ++i) {
        const FitPoint &coarse = points[runs[i - 1]], &fine = points[runs[i]];
        if (fine.n > coarse.n)
            orders.push_back(std::log(coarse.error / fine.error) / std::log(fine.n / coarse.n));
    }
    return orders;
}

void drop_plateau(std::span<const FitPoint> points, std::vector<std::size_t>& runs) {
    std::vector<double> orders = step_orders(points, runs);
    if (orders.empty()) return;
    std::nth_element(orders.begin(), orders.begin() + static_cast<std::ptrdiff_t>(orders.size() / 2),
                     orders.end());
    const double median = orders[orders.size() / 2];
    if (!(median > 0)) return;
    while (runs.size() > 3) {
        const std::vector<double> left = step_orders(points, runs);
        if (left.empty() || left.back() >= median / 2) return;
        runs.pop_back();
    }
}

std::optional<double> resolution_for(const Fit& fit, double error) {
    if (!(fit.order > 0)) return std::nullopt;
    const double n = std::ceil(std::pow(fit.constant / error, 1 / fit.order) * (1 - 1e-12));
    if (!(n <= 1e15)) return std::nullopt;
    return std::max(1.0, n);
}

/// The probability that Student's t lies within +-t, as a function of theta = atan(t / sqrt(degrees)).
double probability_within(int degrees, double theta) {
    const double c = std::cos(theta), s = std::sin(theta);
    double term = degrees % 2 == 0 ? 1 : c, sum = degrees == 1 ? 0 : term;
    for (int k = degrees % 2 == 0 ? 2 : 3; k <= degrees - 2; k += 2) {
        term *= c * c * (k - 1) / k;
        sum += term;
    }
    return degrees % 2 == 0 ? s * sum : 2 / std::numbers::pi * (theta + s * sum);
}

}  // namespace

double student_t(int degrees, double confidence) {
    if (degrees < 1 || !(confidence > 0 && confidence < 1))
        throw UsageError("Student's t needs a degree of freedom and a confidence between 0 and 1");
    double low = 0, high = std::numbers::pi / 2;
    for (int i = 0; i < 200 && high - low > 0; ++i) {
        const double middle = (low + high) / 2;
        if (middle <= low || middle >= high) break;
        (probability_within(degrees, middle) < confidence ? low : high) = middle;
    }
    return std::sqrt(static_cast<double>(degrees)) * std::tan(low);
}

std::optional<Fit> fit_power_law(std::span<const FitPoint> points, const FitOptions& options) {
    std::vector<std::size_t> runs = usable_by_n(points, options.floor);
    if (options.drop_plateau) drop_plateau(points, runs);
    if (runs.size() < 2 || points[runs.front()].n == points[runs.back()].n) return std::nullopt;

    // Centre the logarithms first: their spread is small beside their size.
    const double count = static_cast<double>(runs.size());
    double mean_x = 0, mean_y = 0;
    for (const std::size_t i : runs) {
        mean_x += std::log(points[i].n) / count;
        mean_y += std::log(points[i].error) / count;
    }
    double xx = 0, xy = 0, yy = 0;
    for (const std::size_t i : runs) {
        const double x = std::log(points[i].n) - mean_x, y = std::log(points[i].error) - mean_y;
        xx += x * x;
        xy += x * y;
        yy += y * y;
    }

    Fit fit;
    fit.order = -xy / xx;
    fit.constant = std::exp(mean_y + fit.order * mean_x);
    fit.r2 = yy > 0 ? xy * xy / (xx * yy) : 1;
    if (runs.size() > 2) {
        const double residual = std::max(0.0, yy - xy * xy / xx);
        const double half =
            student_t(static_cast<int>(runs.size()) - 2, 0.95) * std::sqrt(residual / (count - 2) / xx);
        fit.order_low = fit.order - half;
        fit.order_high = fit.order + half;
    }
    fit.used.assign(points.size(), false);
    for (const std::size_t i : runs) fit.used[i] = true;
    fit.n_for_1 = resolution_for(fit, 1);
    fit.n_for_half = resolution_for(fit, 0.5);
    return fit;
}

Summary summarize(std::vector<double> values) {
    Summary summary;
    if (values.empty()) return summary;
    double sum = 0;
    for (const double value : values) sum += value;
    summary.mean = sum / static_cast<double>(values.size());

    // In rising order: behind each only larger values are left.
    auto first = values.begin();
    const auto percentile = [&](std::size_t percent) {
        const std::size_t rank = (percent * values.size() + 99) / 100;  // at least 1
        const auto at = values.begin() + static_cast<std::ptrdiff_t>(rank - 1);
        std::nth_element(first, at, values.end());
        first = at;
        return *at;
    };
    summary.p50 = percentile(50);
    summary.p95 = percentile(95);
    summary.p99 = percentile(99);
    summary.max = *std::max_element(first, values.end());
    return summary;
}

}  // namespace trilens
