#include "inverse/solve/uncertainty.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "inverse/solve/singular_values.h"

namespace trilens {

Uncertainty uncertainty_of(const DenseMatrix& jacobian, const UncertaintyParams& params) {
    const std::size_t n = jacobian.columns;
    const SingularValues svd = singular_values(jacobian, std::vector<double>(jacobian.rows));
    const double largest = n > 0 ? svd.values.front() : 0;
    const double floor = std::max(params.relative * largest, params.least);
    Uncertainty result{0, DenseMatrix(n, n), {}, 0};
    result.condition = n > 0 && svd.values.back() > 0 ? largest / svd.values.back()
                                                      : std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < n; ++k) {
        if (!(svd.values[k] > floor)) {
            result.null_vectors.emplace_back();
            for (std::size_t i = 0; i < n; ++i) result.null_vectors.back().push_back(svd.right(i, k));
            continue;
        }
        ++result.rank;
        const double variance = 1 / (svd.values[k] * svd.values[k]);
        for (std::size_t i = 0; i < n; ++i)
            for (std::size_t j = 0; j < n; ++j)
                result.covariance(i, j) += variance * svd.right(i, k) * svd.right(j, k);
    }
    return result;
}

DenseMatrix correlations(const DenseMatrix& covariance) {
    DenseMatrix result(covariance.rows, covariance.columns);
    for (std::size_t i = 0; i < covariance.rows; ++i)
        for (std::size_t j = 0; j < covariance.columns; ++j) {
            const double scale = std::sqrt(covariance(i, i)) * std::sqrt(covariance(j, j));
            result(i, j) = i == j ? 1 : scale > 0 ? covariance(i, j) / scale : 0;
        }
    return result;
}

}  // namespace trilens
