// Leverage of pairs: the diagonal of the hat matrix (Hoaglin and Welsch, The Hat Matrix in Regression and
// ANOVA, 1978).
#include <algorithm>
#include <cmath>
#include <numeric>
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

double row_product(const DenseMatrix& jacobian, std::size_t row, const DenseMatrix& covariance) {
    double sum = 0;
    for (std::size_t i = 0; i < jacobian.columns; ++i)
        for (std::size_t j = 0; j < jacobian.columns; ++j)
            sum += jacobian(row, i) * covariance(i, j) * jacobian(row, j);
    return sum;
}

}  // namespace

std::vector<std::string> leverage_warnings(const DenseMatrix& jacobian, const Uncertainty& found,
                                           const std::vector<FitPair>& pairs) {
    std::vector<double> lengths(pairs.size());
    std::vector<double> used;
    for (std::size_t p = 0; p < pairs.size(); ++p) {
        if (pairs[p].is_lost) continue;
        for (const std::size_t row : {2 * p, 2 * p + 1})
            for (std::size_t i = 0; i < jacobian.columns; ++i)
                lengths[p] = std::hypot(lengths[p], jacobian(row, i));
        used.push_back(lengths[p]);
    }
    std::vector<std::string> warnings;
    if (used.empty() || static_cast<double>(found.rank) > kFewPairs * static_cast<double>(used.size()))
        return warnings;
    std::nth_element(used.begin(), used.begin() + static_cast<std::ptrdiff_t>(used.size() / 2), used.end());
    const double median = used[used.size() / 2];
    for (std::size_t p = 0; p < pairs.size(); ++p) {
        const double leverage = pairs[p].is_lost ? 0
                                                 : row_product(jacobian, 2 * p, found.covariance) +
                                                       row_product(jacobian, 2 * p + 1, found.covariance);
        if (leverage < kAllOfOne || !(lengths[p] > kNearFold * median)) continue;
        warnings.push_back(fmt::format(
            "pair {} alone fixes a part of what is free (leverage {:.2f}): its image lies near a fold, where "
            "it moves {:.0f} times as far as the median pair's, so that the fit may rest there, far from where "
            "it should, with standard deviations that are too small; leave it out, or match by another "
            "--match, and see whether the answer stays",
            p + 1, leverage, lengths[p] / median));
    }
    return warnings;
}

}  // namespace trilens
