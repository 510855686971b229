// Levenberg-Marquardt with a robust loss (iteratively reweighted), for dense problems of few unknowns.
#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "inverse/solve/dense_matrix.h"

namespace trilens {

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
};

struct LeastSquaresReport {
    int iterations = 0;  // steps taken
    double cost = 0;     // at the end
    bool converged = false;
};

double cost_of(const LeastSquares& problem, std::span<const double> residuals);

/// The linearisation with each group's rows times the square root of its weight.
Linearisation reweighted(const LeastSquares& problem, Linearisation at);

/// Steps downhill until nothing falls any more. Each iteration decomposes the Jacobian once by singular
/// values; all damped steps follow from it (Levenberg 1944, Marquardt 1963; damping as Nielsen 1999).
LeastSquaresReport minimise(const LeastSquares& problem, const LeastSquaresParams& params = {});

}  // namespace trilens
