// Leverage of pairs: the diagonal of the hat matrix (Hoaglin and Welsch, The Hat Matrix in Regression and
// ANOVA, 1978).
#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "base/util/format.h"
#include "inverse/fit/fit_problem.h"

namespace trilens {
namespace {

/// Of the 2 that a pair may have; that much of one number follows whatever it says.
constexpr double kAllOfOne = 0.9;
/// A pair whose image moves so many times as far as the median pair's lies near a fold.
constexpr double kNearFold = 30;
/// Where each pair must tell of more than this part of an unknown, high leverage is how things are.
constexpr double kFewPairs = 0.25;

double leverage_of(std::span<const double> row, const DenseMatrix& covariance) {
    double sum = 0;
    for (std::size_t i = 0; i < row.size(); ++i) sum += row[i] * dot_product(covariance.row(i), row);
    return sum;
}

}  // namespace

double median_of(std::vector<double> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

std::vector<std::string> leverage_warnings(const DenseMatrix& jacobian, const Uncertainty& found,
                                           const std::vector<FitPair>& pairs) {
    std::vector<double> lengths(pairs.size());
    std::vector<double> used;
    for (std::size_t p = 0; p < pairs.size(); ++p) {
        if (pairs[p].is_lost) continue;
        const std::span<const double> x = jacobian.row(2 * p), y = jacobian.row(2 * p + 1);
        lengths[p] = std::sqrt(dot_product(x, x) + dot_product(y, y));
        used.push_back(lengths[p]);
    }
    std::vector<std::string> warnings;
    if (used.empty() || static_cast<double>(found.rank) > kFewPairs * static_cast<double>(used.size()))
        return warnings;
    const double median = median_of(std::move(used));
    for (std::size_t p = 0; p < pairs.size(); ++p) {
        if (!(lengths[p] > kNearFold * median)) continue;  // lost ones have none
        const double leverage = leverage_of(jacobian.row(2 * p), found.covariance) +
                                leverage_of(jacobian.row(2 * p + 1), found.covariance);
        if (leverage < kAllOfOne) continue;
        warnings.push_back(fmt::format(
            "pair {} alone fixes a part of what is free (leverage {:.2f}): its image lies near a fold, where "
            "it moves {:.0f} times as far as the median pair's, and an error of its own would not show; "
            "leave it "
            "out, and see whether the answer stays",
            p + 1, leverage, lengths[p] / median));
    }
    return warnings;
}

}  // namespace trilens
