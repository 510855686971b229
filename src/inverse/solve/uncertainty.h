// Covariance, correlations and null vectors of least squares at its minimum.
#pragma once

#include <vector>

#include "inverse/solve/dense_matrix.h"

namespace trilens {

/// What a fit knows about its unknowns, each in the scale in which 1 is a large step.
struct Uncertainty {
    std::size_t rank = 0;
    /// (J^T J)^-1 over the directions that the residuals fix; what they do not fix adds nothing.
    DenseMatrix covariance;
    /// Unit vectors of unknowns along which the residuals do not move, the least fixed last.
    std::vector<std::vector<double>> null_vectors;
    double condition = 0;  // largest over smallest singular value; infinite where one is 0
};

struct UncertaintyParams {
    double relative = 1e-7;  // a singular value below this share of the largest is 0
    /// A singular value below this is none either: with residuals in units of their standard deviation, the
    /// direction's own standard deviation is above 1 / least.
    double least = 1;
};

/// Of residuals in units of their standard deviation, with this Jacobian.
Uncertainty uncertainty_of(const DenseMatrix& jacobian, const UncertaintyParams& params = {});

/// covariance(i, j) / sqrt(covariance(i, i) covariance(j, j)); 0 where a variance is 0, 1 on the diagonal.
DenseMatrix correlations(const DenseMatrix& covariance);

}  // namespace trilens
