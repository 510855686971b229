#include "inverse/solve/levenberg_marquardt.h"

#include <algorithm>
#include <cmath>

#include "base/util/check.h"
#include "inverse/solve/singular_values.h"

namespace trilens {
namespace {

double group_length(const LeastSquares& problem, std::span<const double> residuals, std::size_t group) {
    const std::span<const double> part = residuals.subspan(group * problem.group, problem.group);
    return std::sqrt(dot_product(part, part));
}

/// -V diag(s / (s^2 + lambda)) U^T r.
std::vector<double> damped_step(const SingularValues& svd, double lambda) {
    const std::size_t n = svd.values.size();
    std::vector<double> step(n);
    for (std::size_t k = 0; k < n; ++k) {
        const double s = svd.values[k];
        if (!(s > 0)) continue;
        const double along = -svd.projection[k] * s / (s * s + lambda);
        for (std::size_t i = 0; i < n; ++i) step[i] += along * svd.right(i, k);
    }
    return step;
}

/// By how much the linear problem's cost falls after the damped step.
double predicted_fall(const SingularValues& svd, double lambda) {
    double fall = 0;
    for (std::size_t k = 0; k < svd.values.size(); ++k) {
        const double square = svd.values[k] * svd.values[k];
        if (!(square > 0)) continue;
        const double left = lambda / (square + lambda);
        fall += svd.projection[k] * svd.projection[k] * (1 - left * left);
    }
    return fall;
}

constexpr double kFirstDamping = 1e-4;  // share of the largest squared singular value
constexpr int kMostTrials = 30;         // of damping, before an iteration gives up

}  // namespace

double cost_of(const LeastSquares& problem, std::span<const double> residuals) {
    double cost = 0;
    for (std::size_t g = 0; g < problem.group_count; ++g)
        cost += problem.loss.value(group_length(problem, residuals, g));
    for (const double rest : residuals.subspan(problem.group * problem.group_count)) cost += rest * rest;
    return cost;
}

Linearisation reweighted(const LeastSquares& problem, Linearisation at) {
    for (std::size_t g = 0; g < problem.group_count; ++g) {
        const double root = std::sqrt(problem.loss.weight(group_length(problem, at.residuals, g)));
        for (std::size_t i = g * problem.group; i < (g + 1) * problem.group; ++i) {
            at.residuals[i] *= root;
            for (double& value : at.jacobian.row(i)) value *= root;
        }
    }
    return at;
}

LeastSquaresReport minimise(const LeastSquares& problem, const LeastSquaresParams& params) {
    LeastSquaresReport report;
    double lambda = -1, growth = 2;
    while (report.iterations < params.most_iterations) {
        const Linearisation at = problem.linearise();
        TRILENS_CHECK(at.jacobian.columns == problem.unknowns, "one column per unknown");
        report.cost = cost_of(problem, at.residuals);
        const Linearisation weighted = reweighted(problem, at);
        const SingularValues svd = singular_values(weighted.jacobian, weighted.residuals);
        const double largest = svd.values.empty() ? 0 : svd.values.front() * svd.values.front();
        if (!(largest > 0) || !(report.cost > 0)) {
            report.converged = true;
            return report;
        }
        if (lambda < 0) lambda = kFirstDamping * largest;

        bool stepped = false, small = false;
        for (int trial = 0; trial < kMostTrials && !stepped && !small; ++trial) {
            const std::vector<double> step = damped_step(svd, lambda);
            double size = 0;
            for (const double s : step) size = std::max(size, std::abs(s));
            small = size < params.step_tolerance;
            const std::optional<std::vector<double>> after = problem.residuals_after(step);
            const double cost = after && all_finite(*after) ? cost_of(problem, *after)
                                                            : std::numeric_limits<double>::infinity();
            const double fall = report.cost - cost, predicted = predicted_fall(svd, lambda);
            if (fall > 0) {
                problem.accept(step);
                ++report.iterations;
                const double gain = predicted > 0 ? fall / predicted : 1;
                lambda *= std::max(1.0 / 9, 1 - std::pow(2 * gain - 1, 3));
                growth = 2;
                stepped = true;
                small = small || fall <= params.cost_tolerance * report.cost;
                report.cost = cost;
            } else {
                lambda = std::max(lambda, 1e-300) * growth;
                growth *= 2;
            }
        }
        if (small || !stepped) {
            report.converged = true;
            return report;
        }
    }
    return report;
}

}  // namespace trilens
