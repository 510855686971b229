#include "inverse/solve/singular_values.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/util/check.h"

namespace trilens {

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

}  // namespace trilens
