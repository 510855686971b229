// Real roots of polynomials of degree 0 to 3.
#pragma once

#include <array>

namespace trilens {

/// Up to three real roots, ascending.
struct RealRoots {
    int count = 0;
    std::array<double, 3> root{};
    bool all = false;  // the polynomial is zero: every number is a root, and count is 0

    const double* begin() const { return root.data(); }
    const double* end() const { return root.data() + count; }
};

/// The real roots of c[0] + c[1] t + c[2] t^2 + c[3] t^3, ascending. The degree is that of the last coefficient
/// that matters: see roots.cpp. A double root is returned twice and a triple root three times, so that count
/// and the degree have one parity and every sign change of the polynomial is one root of odd multiplicity.
/// Each root r satisfies |p(r)| <= kRootResidual * sum |c_i r^i|.
/// Coefficients must be finite; any magnitude.
RealRoots real_roots(const std::array<double, 4>& c);

inline constexpr double kRootResidual = 1e-14;

}  // namespace trilens
