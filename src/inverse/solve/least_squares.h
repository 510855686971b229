// Dense least squares: Cholesky and singular value decompositions, Levenberg-Marquardt, and the covariance at the
// minimum.
#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace trilens {

// Dense matrices of doubles, row by row, for problems of up to some hundred unknowns.

/// rows x columns numbers; zero at first.
struct DenseMatrix {
    std::size_t rows = 0, columns = 0;
    std::vector<double> values;

    DenseMatrix() = default;
    DenseMatrix(std::size_t row_count, std::size_t column_count)
        : rows(row_count), columns(column_count), values(row_count * column_count) {}

    double& operator()(std::size_t row, std::size_t column) { return values[row * columns + column]; }
    double operator()(std::size_t row, std::size_t column) const { return values[row * columns + column]; }
    std::span<double> row(std::size_t r) { return std::span(values).subspan(r * columns, columns); }
    std::span<const double> row(std::size_t r) const {
        return std::span(values).subspan(r * columns, columns);
    }
};

double dot_product(std::span<const double> a, std::span<const double> b);

/// Where every value is finite.
bool all_finite(std::span<const double> values);

// Cholesky decomposition of symmetric positive definite systems: normal equations of least squares.

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

// Singular value decomposition: Householder QR, then one-sided Jacobi rotations (Hestenes 1958).

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

// Levenberg-Marquardt with a robust loss (iteratively reweighted), for dense problems of few unknowns.

/// Huber's loss of a residual's length r, in the residual's own unit: r^2 up to the threshold, then
/// 2 threshold r - threshold^2; threshold infinite: r^2 everywhere.
struct HuberLoss {
    double threshold = std::numeric_limits<double>::infinity();

    double value(double r) const { return r <= threshold ? r * r : (2 * r - threshold) * threshold; }
    /// Of r^2 in the reweighted problem: 1 up to the threshold, then threshold / r.
    double weight(double r) const { return r <= threshold ? 1 : threshold / r; }
};

/// Residuals at one place of the unknowns, in groups of `LeastSquares::group` that share a loss (x and y of
/// an image); those after the grouped ones are plain squares (priors).
struct Linearisation {
    std::vector<double> residuals;
    DenseMatrix jacobian;  // residuals.size() x unknowns
};

/// What is minimised: the sum of loss(|group|) over groups, plus squares of the rest. Unknowns are increments
/// about a present place that the problem keeps, each scaled so that 1 is a large step.
struct LeastSquares {
    std::size_t unknowns = 0;
    std::size_t group = 1;        // residuals that share a loss
    std::size_t group_count = 0;  // groups at the front of the residuals
    HuberLoss loss;

    /// At the present place.
    std::function<Linearisation()> linearise;
    /// The residuals after `step`; none where there is no such place. What it is compared with are the
    /// residuals that linearise gave.
    std::function<std::optional<std::vector<double>>(std::span<const double> step)> residuals_after;
    /// Makes the place after `step` the present one.
    std::function<void(std::span<const double> step)> accept;
};

struct LeastSquaresParams {
    int most_iterations = 100;
    double step_tolerance = 1e-12;  // largest component of a step, in the unknowns' scales
    double cost_tolerance = 1e-12;  // relative fall of the cost
    double negligible_fall = 0;     // of the cost: what derivatives may promise in vain
};

struct LeastSquaresReport {
    int iterations = 0;  // steps taken
    double cost = 0;     // at the end
    /// Steps have become small, or no step lowers the cost and the derivatives promise none that would.
    bool converged = false;
};

double cost_of(const LeastSquares& problem, std::span<const double> residuals);

/// The linearisation with each group's rows times the square root of its weight.
Linearisation reweighted(const LeastSquares& problem, Linearisation at);

/// Steps downhill until nothing falls any more. Each iteration decomposes the Jacobian once by singular
/// values; all damped steps follow from it (Levenberg 1944, Marquardt 1963; damping as Nielsen 1999).
LeastSquaresReport minimise(const LeastSquares& problem, const LeastSquaresParams& params = {});

// Covariance, correlations and null vectors of least squares at its minimum.

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
