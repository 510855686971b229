// Cholesky decomposition of symmetric positive definite systems: normal equations of least squares.
#pragma once

#include <span>
#include <vector>

#include "inverse/solve/dense_matrix.h"

namespace trilens {

/// Normal equations, filled row by row: each residual sum(coefficients[k] * x[indices[k]]) - value, squared
/// and weighted.
class NormalEquations {
  public:
    explicit NormalEquations(std::size_t unknowns) : matrix_(unknowns, unknowns), right_(unknowns) {}

    /// `indices` below the number of unknowns, each once; weight >= 0.
    void add(std::span<const std::size_t> indices, std::span<const double> coefficients, double value,
             double weight = 1);

    /// The minimum; empty where the matrix is not positive definite to rounding, that is, where the rows do
    /// not fix all unknowns.
    std::vector<double> solve() const;

  private:
    DenseMatrix matrix_;  // its lower triangle
    std::vector<double> right_;
};

}  // namespace trilens
