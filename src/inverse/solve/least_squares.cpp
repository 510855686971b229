#include "inverse/solve/least_squares.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/util/check.h"

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

double dot_product(std::span<const double> a, std::span<const double> b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
    return sum;
}

bool all_finite(std::span<const double> values) {
    return std::all_of(values.begin(), values.end(), [](double value) { return std::isfinite(value); });
}

namespace {

/// Columns side by side, each contiguous: what both steps work on.
struct Columns {
    std::size_t length = 0;
    std::vector<std::vector<double>> column;
};

Columns columns_of(const DenseMatrix& a) {
    // Rows of zeros where there are fewer rows than columns: R is square then too.
    Columns result{std::max(a.rows, a.columns), {}};
    for (std::size_t c = 0; c < a.columns; ++c) {
        result.column.emplace_back(result.length);
        for (std::size_t r = 0; r < a.rows; ++r) result.column.back()[r] = a(r, c);
    }
    return result;
}

/// Householder QR in place: R above, and b becomes Q^T b. What lies below the diagonal is not used again.
void triangularise(Columns& a, std::vector<double>& b) {
    for (std::size_t k = 0; k < a.column.size(); ++k) {
        std::vector<double>& pivot = a.column[k];
        const std::span<double> tail = std::span(pivot).subspan(k);
        const double norm = std::sqrt(dot_product(tail, tail));
        if (!(norm > 0)) continue;
        const double alpha = tail[0] > 0 ? -norm : norm;
        std::vector<double> v(tail.begin(), tail.end());
        v[0] -= alpha;
        const double square = dot_product(v, v);
        const auto reflect = [&](std::vector<double>& x) {
            const std::span<double> part = std::span(x).subspan(k);
            const double factor = 2 * dot_product(v, part) / square;
            for (std::size_t i = 0; i < part.size(); ++i) part[i] -= factor * v[i];
        };
        for (std::size_t c = k; c < a.column.size(); ++c) reflect(a.column[c]);
        reflect(b);
    }
    const std::size_t n = a.column.size();
    for (std::size_t c = 0; c < n; ++c) {
        a.column[c].resize(n);
        std::fill(a.column[c].begin() + static_cast<std::ptrdiff_t>(c) + 1, a.column[c].end(), 0.0);
    }
    a.length = n;
}

/// Turns columns p and q of A and V so that those of A are at right angles; whether they were not.
bool rotate_pair(std::vector<double>& ap, std::vector<double>& aq, std::vector<double>& vp,
                 std::vector<double>& vq) {
    const double pp = dot_product(ap, ap), qq = dot_product(aq, aq), pq = dot_product(ap, aq);
    if (!(std::abs(pq) > 1e-15 * std::sqrt(pp) * std::sqrt(qq))) return false;
    const double zeta = (qq - pp) / (2 * pq);
    const double t = (zeta >= 0 ? 1 : -1) / (std::abs(zeta) + std::hypot(1, zeta));
    const double c = 1 / std::hypot(1, t), s = c * t;
    const auto turn = [&](std::vector<double>& x, std::vector<double>& y) {
        for (std::size_t i = 0; i < x.size(); ++i) {
            const double old = x[i];
            x[i] = c * old - s * y[i];
            y[i] = s * old + c * y[i];
        }
    };
    turn(ap, aq);
    turn(vp, vq);
    return true;
}

constexpr int kMostSweeps = 60;

}  // namespace

SingularValues singular_values(const DenseMatrix& a, std::span<const double> b) {
    TRILENS_CHECK(b.size() == a.rows, "a right-hand side has one number per row");
    Columns work = columns_of(a);
    std::vector<double> rhs(work.length);
    std::copy(b.begin(), b.end(), rhs.begin());
    triangularise(work, rhs);
    const std::size_t n = a.columns;
    Columns v{n, std::vector<std::vector<double>>(n, std::vector<double>(n))};
    for (std::size_t k = 0; k < n; ++k) v.column[k][k] = 1;
    bool turned = true;
    for (int sweep = 0; turned && sweep < kMostSweeps; ++sweep) {
        turned = false;
        for (std::size_t p = 0; p + 1 < n; ++p)
            for (std::size_t q = p + 1; q < n; ++q)
                turned |= rotate_pair(work.column[p], work.column[q], v.column[p], v.column[q]);
    }

    std::vector<double> norms(n);
    for (std::size_t k = 0; k < n; ++k) norms[k] = std::sqrt(dot_product(work.column[k], work.column[k]));
    std::vector<std::size_t> order(n);
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t i, std::size_t j) { return norms[i] > norms[j]; });
    SingularValues result{std::vector<double>(n), DenseMatrix(n, n), std::vector<double>(n)};
    const std::span<const double> top = std::span(rhs).first(n);
    for (std::size_t k = 0; k < n; ++k) {
        const std::size_t from = order[k];
        result.values[k] = norms[from];
        if (norms[from] > 0) result.projection[k] = dot_product(work.column[from], top) / norms[from];
        for (std::size_t i = 0; i < n; ++i) result.right(i, k) = v.column[from][i];
    }
    return result;
}

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
/// Share of the cost that the linear problem may still promise to take away where it rests.
constexpr double kRest = 1e-6;
constexpr double kNoFall = 1e-14;  // of squared singular values, to the largest: nothing is promised there

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
            // Where derivatives promise a fall that no step finds, it stands at a fold or a jump.
            const double promised = predicted_fall(svd, kNoFall * largest);
            report.converged = stepped || promised <= std::max(kRest * report.cost, params.negligible_fall);
            return report;
        }
    }
    return report;
}

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
