#include "inverse/solve/cholesky.h"

#include <algorithm>
#include <cmath>

namespace trilens {
namespace {

/// A pivot below this share of its diagonal entry has lost all digits to cancellation.
constexpr double kLostPivot = 1e-13;

}  // namespace

void NormalEquations::add(std::span<const std::size_t> indices, std::span<const double> coefficients,
                          double value, double weight) {
    for (std::size_t i = 0; i < indices.size(); ++i) {
        const double scaled = weight * coefficients[i];
        right_[indices[i]] += scaled * value;
        for (std::size_t k = 0; k < indices.size(); ++k)
            if (indices[k] <= indices[i]) matrix_(indices[i], indices[k]) += scaled * coefficients[k];
    }
}

std::vector<double> NormalEquations::solve() const {
    const std::size_t n = right_.size();
    DenseMatrix l = matrix_;
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j <= i; ++j) {
            const double rest = l(i, j) - dot_product(l.row(i).first(j), l.row(j).first(j));
            if (j < i) {
                l(i, j) = rest / l(j, j);
                continue;
            }
            if (!(rest > kLostPivot * matrix_(i, i))) return {};
            l(i, i) = std::sqrt(rest);
        }
    std::vector<double> x = right_;
    for (std::size_t i = 0; i < n; ++i)
        x[i] = (x[i] - dot_product(l.row(i).first(i), std::span(x).first(i))) / l(i, i);
    for (std::size_t i = n; i-- > 0;) {
        for (std::size_t k = i + 1; k < n; ++k) x[i] -= l(k, i) * x[k];
        x[i] /= l(i, i);
    }
    return x;
}

}  // namespace trilens
