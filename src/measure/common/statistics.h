// Statistics of errors: mean, percentiles and maximum of a set, and the power law error = C n^-p behind a
// convergence study, by least squares in log-log.
#pragma once

#include <optional>
#include <span>
#include <vector>

namespace trilens {

/// All zero where there are no numbers. A percentile p is the smallest number that at least p % of all do not
/// exceed (nearest rank), so it is always one of them.
struct Summary {
    double mean = 0, p50 = 0, p95 = 0, p99 = 0, max = 0;
};

/// Precondition: no NaN. The sum runs in the order given, so equal input gives equal bits.
Summary summarize(std::vector<double> values);

/// One run of a study: resolution n (N x N facets per face) and its error.
struct FitPoint {
    double n = 0;
    double error = 0;
};

struct FitOptions {
    /// Errors at or below this are left out: they measure the floor of the arithmetic or of the sampling, not
    /// the method. 0 leaves out none but exact zeros.
    double floor = 0;
    /// Finds the plateau by itself: leaves out the finest runs over whose last step the error falls with less
    /// than half the median order of all steps, as long as three runs remain.
    bool drop_plateau = false;
};

struct Fit {
    double order = 0;     // p: 2 means that doubling n quarters the error
    double constant = 0;  // C: the error that the law gives at n = 1
    double r2 = 0;        // of the line in log-log; 1 where all points lie on it
    /// The ends of the 95 % confidence interval of the order, as least squares with normal errors of the
    /// logarithms gives it (Student's t with two degrees of freedom fewer than points); none with two points.
    std::optional<double> order_low, order_high;
    std::vector<bool> used;  // per point given: whether it took part
    /// The smallest n >= 1 for which the law promises an error of one, of half a unit (a pixel, where the
    /// errors are displacements). Extrapolates freely; nothing where the error does not fall with n, or n
    /// exceeds 1e15.
    std::optional<double> n_for_1, n_for_half;
};

/// Least squares of log error over log n. Points whose n or error is not finite and positive are left out.
/// Nothing where the points left have fewer than two distinct n.
std::optional<Fit> fit_power_law(std::span<const FitPoint> points, const FitOptions& options = {});

/// The value that Student's t of this many degrees of freedom (at least 1) exceeds in size with probability
/// 1 - confidence, 0 < confidence < 1: 12.706 of 1 and 0.95. By the finite sums of Abramowitz and Stegun
/// 26.7.3 and 26.7.4. Throws UsageError for other degrees or confidences.
double student_t(int degrees, double confidence);

}  // namespace trilens
