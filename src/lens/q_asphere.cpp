#include "lens/q_asphere.h"

#include <cmath>

#include "base/util/check.h"

namespace trilens {
namespace {

/// Coefficients of 1, x, x^2, ...
using Polynomial = std::array<double, kQTerms>;

Polynomial sum(const Polynomial& p, double factor, const Polynomial& q) {
    Polynomial result = p;
    for (std::size_t i = 0; i < kQTerms; ++i) result[i] += factor * q[i];
    return result;
}

Polynomial times_x(const Polynomial& p) {
    Polynomial result{};
    for (std::size_t i = 1; i < kQTerms; ++i) result[i] = p[i - 1];
    return result;
}

double choose(std::size_t n, std::size_t k) {
    double result = 1;
    for (std::size_t i = 1; i <= k; ++i)
        result = std::round(result * static_cast<double>(n - k + i) / static_cast<double>(i));
    return result;
}

/// The Jacobi polynomial P_m^(0,4)(2x - 1), whose coefficients are whole numbers.
Polynomial qcon(std::size_t m) {
    Polynomial q{};
    for (std::size_t k = 0; k <= m; ++k)
        q[k] = ((m + k) % 2 == 0 ? 1 : -1) * choose(m, k) * choose(m + k + 4, m);
    return q;
}

/// Qbfs0 to Qbfs6 [Forbes, Robust, efficient computational methods for axially symmetric optical aspheres,
/// Optics Express 18, 2010, appendix A]: the P are orthogonal but for their neighbours, and f, g and h are
/// the Cholesky factor that parts these.
std::array<Polynomial, kQTerms> all_qbfs() {
    std::array<Polynomial, kQTerms> q{};
    Polynomial before{2}, now{6, -8};
    std::array<double, kQTerms> f{2, std::sqrt(19.0) / 2}, g{-0.5}, h{};
    q[0] = {1};
    q[1] = sum({}, 1 / f[1], sum(now, -g[0], q[0]));
    for (std::size_t m = 2; m < kQTerms; ++m) {
        const Polynomial next = sum(sum(sum({}, 2, now), -4, times_x(now)), -1, before);
        before = now;
        now = next;
        const auto order = static_cast<double>(m);
        h[m - 2] = -order * (order - 1) / (2 * f[m - 2]);
        g[m - 1] = -(1 + g[m - 2] * h[m - 2]) / f[m - 1];
        f[m] = std::sqrt(order * (order + 1) + 3 - g[m - 1] * g[m - 1] - h[m - 2] * h[m - 2]);
        q[m] = sum({}, 1 / f[m], sum(sum(now, -g[m - 1], q[m - 1]), -h[m - 2], q[m - 2]));
    }
    return q;
}

/// Of r^2, r^4, ...: terms of u^2, u^4, ..., u = r / radius.
std::array<double, kAsphereTerms> unscaled(std::array<double, kAsphereTerms> terms, double radius) {
    double unit = 1;
    for (double& term : terms) {
        unit *= radius * radius;
        term /= unit;
    }
    return terms;
}

}  // namespace

std::array<double, kAsphereTerms> qcon_coefficients(std::span<const double> a, double radius) {
    TRILENS_CHECK(a.size() <= kQTerms && radius > 0, "readers see to that");
    std::array<double, kAsphereTerms> terms{};
    for (std::size_t m = 0; m < a.size(); ++m) {
        const Polynomial q = qcon(m);
        for (std::size_t k = 0; k <= m; ++k) terms[k + 1] += a[m] * q[k];
    }
    return unscaled(terms, radius);
}

std::array<double, kAsphereTerms> qbfs_departures(std::span<const double> a, double radius) {
    TRILENS_CHECK(a.size() <= kQTerms && radius > 0, "readers see to that");
    static const std::array<Polynomial, kQTerms> kQbfs = all_qbfs();
    std::array<double, kAsphereTerms> terms{};
    for (std::size_t m = 0; m < a.size(); ++m)
        for (std::size_t k = 0; k <= m; ++k) {
            terms[k] += a[m] * kQbfs[m][k];
            terms[k + 1] -= a[m] * kQbfs[m][k];
        }
    return unscaled(terms, radius);
}

}  // namespace trilens
