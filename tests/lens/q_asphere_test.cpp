// Q-type aspheres against Forbes' definitions: Jacobi's recurrence, published polynomials, orthogonality.
#include <cmath>
#include <numbers>
#include <vector>

#include "lens/q_asphere.h"
#include "lens/sequential_rays.h"
#include "support/test.h"

using namespace trilens;

namespace {

/// P_m^(0,4)(t) by the recurrence in m.
double jacobi(int m, double t) {
    const double a = 0, b = 4;
    double before = 1, now = (a + 1) + (a + b + 2) * (t - 1) / 2;
    if (m == 0) return before;
    for (int n = 2; n <= m; ++n) {
        const double s = 2 * n + a + b;
        const double next =
            ((s - 1) * (s * (s - 2) * t + a * a - b * b) * now - 2 * (n + a - 1) * (n + b - 1) * s * before) /
            (2 * n * (n + a + b) * (s - 2));
        before = now;
        now = next;
    }
    return now;
}

std::vector<double> unit_vector(std::size_t m) {
    std::vector<double> a(kQTerms, 0);
    a[m] = 1;
    return a;
}

/// The departure u^2 (1 - u^2) Qbfs_m(u^2), and its slope by u, at a radius of 1.
Sag qbfs_at(std::size_t m, double u) {
    const Sag by_s = polynomial_at(qbfs_departures(unit_vector(m), 1), u * u);
    return {by_s.z, by_s.by_s * 2 * u, 0};
}

}  // namespace

TEST_CASE("Qcon aspheres are Jacobi polynomials over u^4", "[lens][oracle]") {
    const double radius = 7.5;
    for (std::size_t m = 0; m < kQTerms; ++m) {
        LensSide side;
        side.aperture = radius;
        side.coefficients = qcon_coefficients(unit_vector(m), radius);
        for (const double u : {0.1, 0.37, 0.62, 0.88, 1.0}) {
            CAPTURE(m, u);
            const double expected = std::pow(u, 4) * jacobi(static_cast<int>(m), 2 * u * u - 1);
            CHECK(std::fabs(sag_at(side, u * u * radius * radius).z - expected) < 1e-11);
        }
    }
    // Forbes 2007, in his own form: Qcon2 = 15 - 14 x (3 - 2 x), Qcon3 = -(35 - 12 x (14 - x (21 - 10 x))).
    const double x = 0.3;
    const auto value = [&](std::size_t m) {
        return polynomial_at(qcon_coefficients(unit_vector(m), 1), x).z / (x * x);
    };
    CHECK(std::fabs(value(2) - (15 - 14 * x * (3 - 2 * x))) < 1e-13);
    CHECK(std::fabs(value(3) + (35 - 12 * x * (14 - x * (21 - 10 * x)))) < 1e-12);
}

TEST_CASE("Qbfs aspheres have slopes that are orthonormal in the mean, and are those that Forbes published",
          "[lens][oracle]") {
    constexpr int kPlaces = 64;  // of a period; exact up to degree 63
    for (std::size_t m = 0; m < kQTerms; ++m) {
        for (std::size_t n = 0; n <= m; ++n) {
            double mean = 0;
            for (int i = 0; i < kPlaces; ++i) {
                const double u = std::sin(2 * std::numbers::pi * i / kPlaces);
                mean += qbfs_at(m, u).by_s * qbfs_at(n, u).by_s / kPlaces;
            }
            CAPTURE(m, n);
            CHECK(std::fabs(mean - (m == n ? 1 : 0)) < 1e-9);
        }
    }
    const double x = 0.41, u = std::sqrt(x);
    const double published[] = {
        1,
        (13 - 16 * x) / std::sqrt(19.0),
        std::sqrt(2 / 95.0) * (29 - 4 * x * (25 - 19 * x)),
        std::sqrt(2 / 2545.0) * (207 - 4 * x * (315 - x * (577 - 320 * x))),
        (7737 - 16 * x * (4653 - 2 * x * (7381 - 8 * x * (1168 - 509 * x)))) / (3 * std::sqrt(131831.0)),
        (66657 - 32 * x * (28338 - x * (135325 - 8 * x * (35884 - x * (34661 - 12432 * x))))) /
            (3 * std::sqrt(6632213.0))};
    for (std::size_t m = 0; m < std::size(published); ++m)
        CHECK(std::fabs(qbfs_at(m, u).z / (x * (1 - x)) - published[m]) < 1e-11);
}

TEST_CASE("a Qbfs side departs along its sphere's normals, with derivatives that are its differences'",
          "[lens][oracle]") {
    LensSide side{1 / 40.0, 0, {}, 15};
    const std::vector<double> a{0.05, -0.02, 0.008, 0.001};
    side.normal_departures = qbfs_departures(a, 16);
    for (const double r : {0.5, 4.0, 9.3, 15.0}) {
        CAPTURE(r);
        const double c = side.curvature, u = r / 16, cosine = std::sqrt(1 - c * c * r * r);
        double departure = 0;
        for (std::size_t m = 0; m < a.size(); ++m) departure += a[m] * qbfs_at(m, u).z;
        const double s = r * r, step = 1e-3;
        const Sag sag = sag_at(side, s), up = sag_at(side, s + step), down = sag_at(side, s - step);
        CHECK(std::fabs(sag.z - ((1 - cosine) / c + departure / cosine)) < 1e-13);
        CHECK(std::fabs(sag.by_s - (up.z - down.z) / (2 * step)) < 1e-9);
        CHECK(std::fabs(sag.by_ss - (up.by_s - down.by_s) / (2 * step)) < 1e-9);
        const auto most = largest_slopes(side);
        CHECK(std::fabs(sag.by_s) <= most[0]);
        CHECK(std::fabs(sag.by_ss) <= most[1]);
        CHECK(std::fabs(up.by_ss - down.by_ss) / (2 * step) <= most[2]);
    }
    // Twice as large, twice the sag.
    CHECK(std::fabs(sag_at(with_scaled_shape(side, 2), 400).z - 2 * sag_at(side, 100).z) < 1e-13);
    CHECK(!is_conicoid(side));
}

TEST_CASE("Seidel's sums know the first terms of a Qbfs side", "[lens][oracle]") {
    LensPrescription lens{"Q", "Q", {}};
    lens.rows.resize(2);
    lens.rows[0] = {{1 / 40.0, 0, {}, 10}, 5, {"glass", 1.5, 0}};
    lens.rows[0].side.normal_departures = qbfs_departures(std::vector<double>{0.02, 0.01}, 10);
    lens.rows[1].side.aperture = 10;
    double before = 0;
    for (const double height : {2.0, 1.0, 0.5}) {
        const SeidelSums seidel = seidel_sums(lens, {height, 0});
        const FirstOrder first = first_order(lens);
        const auto ray = trace_lens(lens, {{0, height, -5}, {0, 0, 1}});
        REQUIRE(ray);
        const double aside = ray->origin.y + (first.length + first.back_focal_length - ray->origin.z) *
                                                 ray->direction.y / ray->direction.z;
        const double off = std::fabs(aside / (seidel.sum.spherical / (2 * seidel.image_slope)) - 1);
        if (before > 0) CHECK(std::fabs(off / before - 0.25) < 0.05);
        before = off;
    }
    CHECK(before < 0.01);
}
