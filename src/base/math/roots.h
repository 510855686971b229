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

/// Each root r that real_roots returns satisfies |p(r)| <= kRootResidual * sum |c_i r^i|.
inline constexpr double kRootResidual = 1e-14;

/// Roots beyond this magnitude are not returned: the polynomial counts as one of lower degree.
inline constexpr double kFarthestRoot = 1e100;

/// The real roots of c[0] + c[1] t + c[2] t^2 + c[3] t^3, ascending; none is missed. No coefficient is taken
/// for zero because it is small: a small leading one makes a far root, which is returned up to kFarthestRoot.
/// A double root is returned twice and a triple root three times, so that count and the degree have one
/// parity and every sign change of the polynomial is one root of odd multiplicity. Roots so close that
/// rounding of the coefficients in their last bit could merge them (a relative distance of about 1e-8, or
/// 1e-5 for three) may be returned as one multiple root, and an extremum that misses zero by no more than
/// that may be returned as a double root. None where a coefficient is not
/// finite.
RealRoots real_roots(const std::array<double, 4>& c);

}  // namespace trilens
