// Singular value decomposition: Householder QR, then one-sided Jacobi rotations (Hestenes 1958).
#pragma once

#include <span>
#include <vector>

#include "inverse/solve/dense_matrix.h"

namespace trilens {

/// A = U diag(values) V^T of a matrix with n columns, together with U^T b of a right-hand side b.
struct SingularValues {
    std::vector<double> values;      // n, descending, not negative
    DenseMatrix right;               // n x n: column k of V belongs to values[k]; orthonormal
    std::vector<double> projection;  // n: U^T b; 0 where the value is 0
};

/// Of any matrix, also one with fewer rows than columns; small singular values come out with a relative
/// error near rounding times the condition of the column-scaled matrix (Demmel and Veselic 1992). `b`: as
/// many numbers as A has rows.
SingularValues singular_values(const DenseMatrix& a, std::span<const double> b);

}  // namespace trilens
