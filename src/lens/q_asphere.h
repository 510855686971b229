// Q-type aspheres [Forbes, Shape specification for axially symmetric optical surfaces, Optics Express 15,
// 2007] as polynomials of r^2.
#pragma once

#include <array>
#include <span>

#include "base/description/lens_side.h"

namespace trilens {

/// How many Q polynomials a side takes: the last one has r^16.
inline constexpr std::size_t kQTerms = kAsphereTerms - 1;

/// Forbes' strong aspheres, for LensSide::coefficients: u^4 (a0 Qcon0(u^2) + a1 Qcon1(u^2) + ...), u = r /
/// radius; added to a conicoid. At most kQTerms coefficients.
std::array<double, kAsphereTerms> qcon_coefficients(std::span<const double> a, double radius);

/// Forbes' mild aspheres, for LensSide::normal_departures: u^2 (1 - u^2) (a0 Qbfs0(u^2) + ...), departures
/// from the sphere along its normals. At most kQTerms coefficients.
std::array<double, kAsphereTerms> qbfs_departures(std::span<const double> a, double radius);

}  // namespace trilens
