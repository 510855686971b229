// Dense least squares: decompositions against each other, and Levenberg-Marquardt against known minima.
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "base/math/vec.h"
#include "inverse/solve/least_squares.h"
#include "support/test.h"

using namespace trilens;

namespace {

DenseMatrix random_matrix(std::mt19937& random, std::size_t rows, std::size_t columns) {
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> decades(-4, 4);
    DenseMatrix a(rows, columns);
    for (double& value : a.values) value = normal(random);
    for (std::size_t c = 0; c < columns; ++c) {
        const double scale = std::pow(10, decades(random));
        for (std::size_t r = 0; r < rows; ++r) a(r, c) *= scale;
    }
    return a;
}

}  // namespace

TEST_CASE("singular values rebuild the Gram matrix, and solve what Cholesky solves", "[inverse][oracle]") {
    std::mt19937 random(7);
    for (int trial = 0; trial < 40; ++trial) {
        const std::size_t columns = 1 + random() % 9, rows = columns + random() % 30;
        const DenseMatrix a = random_matrix(random, rows, columns);
        std::vector<double> b(rows);
        for (double& value : b) value = std::normal_distribution<double>()(random);
        const SingularValues svd = singular_values(a, b);
        REQUIRE(std::is_sorted(svd.values.rbegin(), svd.values.rend()));

        // V^T A^T A V = diag(values^2), entry by entry against the columns' sizes.
        std::vector<double> norm(columns);
        for (std::size_t c = 0; c < columns; ++c)
            for (std::size_t r = 0; r < rows; ++r) norm[c] = std::hypot(norm[c], a(r, c));
        for (std::size_t i = 0; i < columns; ++i)
            for (std::size_t j = 0; j < columns; ++j) {
                double gram = 0, rebuilt = 0;
                for (std::size_t r = 0; r < rows; ++r) gram += a(r, i) * a(r, j);
                for (std::size_t k = 0; k < columns; ++k)
                    rebuilt += svd.right(i, k) * svd.values[k] * svd.values[k] * svd.right(j, k);
                CHECK(std::abs(gram - rebuilt) <=
                      1e-11 * norm[i] * norm[j] + 1e-12 * svd.values[0] * svd.values[0] * 1e-3);
            }

        NormalEquations normal(columns);
        std::vector<std::size_t> all(columns);
        for (std::size_t c = 0; c < columns; ++c) all[c] = c;
        for (std::size_t r = 0; r < rows; ++r) normal.add(all, a.row(r), b[r]);
        const std::vector<double> x = normal.solve();
        if (x.empty()) continue;
        for (std::size_t i = 0; i < columns; ++i) {
            double y = 0;
            for (std::size_t k = 0; k < columns; ++k)
                if (svd.values[k] > 0) y += svd.right(i, k) * svd.projection[k] / svd.values[k];
            CHECK(std::abs(x[i] - y) * norm[i] <= 1e-4);
        }
    }
}

TEST_CASE("an unknown that no residual moves is a null vector and not in the covariance", "[inverse]") {
    std::mt19937 random(3);
    DenseMatrix a(20, 4);
    for (std::size_t r = 0; r < 20; ++r) {
        for (std::size_t c = 0; c < 2; ++c) a(r, c) = 100 * std::normal_distribution<double>()(random);
        a(r, 2) = 2 * a(r, 0);  // so that (2, 0, -1, 0) moves nothing
    }
    const Uncertainty found = uncertainty_of(a);
    REQUIRE(found.rank == 2);
    REQUIRE(found.null_vectors.size() == 2);
    for (const std::vector<double>& v : found.null_vectors) {
        CHECK(std::abs(v[0] + 2 * v[2]) <= 1e-12);
        CHECK(std::abs(v[1]) <= 1e-12);
    }
    CHECK(found.covariance(3, 3) == 0);
    CHECK(correlations(found.covariance)(3, 3) == 1);
}

TEST_CASE(
    "Levenberg-Marquardt reaches the minimum of Rosenbrock's valley, and Huber's loss leaves outliers out",
    "[inverse]") {
    Vec2 at(-1.2, 1);
    LeastSquares valley;
    valley.unknowns = 2;
    valley.group = 1;
    valley.group_count = 2;
    const auto residuals = [](const Vec2& p) { return std::vector<double>{1 - p.x, 10 * (p.y - p.x * p.x)}; };
    valley.linearise = [&] {
        Linearisation result{residuals(at), DenseMatrix(2, 2)};
        result.jacobian(0, 0) = -1;
        result.jacobian(1, 0) = -20 * at.x;
        result.jacobian(1, 1) = 10;
        return result;
    };
    valley.residuals_after = [&](std::span<const double> step) {
        return std::optional(residuals(at + Vec2(step[0], step[1])));
    };
    valley.accept = [&](std::span<const double> step) { at += Vec2(step[0], step[1]); };
    const LeastSquaresReport report = minimise(valley);
    CHECK(report.converged);
    CHECK(std::abs(at.x - 1) <= 1e-9);
    CHECK(std::abs(at.y - 1) <= 1e-9);

    // A mean of 10 values, one far off: Huber's estimate is the closed form (sum of the rest + threshold)
    // / 9.
    double mean = 50;
    const std::vector<double> values{1, 2, 1, 2, 1, 2, 1, 2, 1.5, 1000};
    LeastSquares middle;
    middle.unknowns = 1;
    middle.group_count = values.size();
    middle.loss = {4};
    const auto off = [&](double m) {
        std::vector<double> result;
        for (const double value : values) result.push_back(m - value);
        return result;
    };
    middle.linearise = [&] {
        Linearisation result{off(mean), DenseMatrix(values.size(), 1)};
        std::fill(result.jacobian.values.begin(), result.jacobian.values.end(), 1.0);
        return result;
    };
    middle.residuals_after = [&](std::span<const double> step) { return std::optional(off(mean + step[0])); };
    middle.accept = [&](std::span<const double> step) { mean += step[0]; };
    CHECK(minimise(middle).converged);
    CHECK(std::abs(mean - (13.5 + 4) / 9) <= 1e-6);
}
