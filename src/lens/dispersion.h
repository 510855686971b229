// Dispersion formulas of glass catalogues: indices at the lines d, C and F, from which scenes take index and
// Abbe number.
#pragma once

#include <array>
#include <string>

#include "lens/prescription.h"

namespace trilens {

/// In micrometres.
double wavelength_of(SpectralLine line);

/// K1, L1, K2, L2, K3, L3 in n^2 = 1 + sum of K w^2 / (w^2 - L), w in micrometres.
using SellmeierTerms = std::array<double, 6>;

/// The glass of that formula. Throws InputError(file, place) where it has no index from 1 to 10 at a line, or
/// does not fall from F to C.
Glass sellmeier_glass(const std::string& name, const SellmeierTerms& terms, const std::string& file,
                      const std::string& place);

/// Schott's older formula: n^2 = a0 + a1 w^2 + a2 w^-2 + a3 w^-4 + a4 w^-6 + a5 w^-8. Throws likewise.
Glass schott_glass(const std::string& name, const std::array<double, 6>& terms, const std::string& file,
                   const std::string& place);

/// The glass that has these indices, and the Abbe number that follows. Throws likewise.
struct LineIndices {
    double d, c, f;
};
Glass glass_of_lines(const std::string& name, const LineIndices& indices, const std::string& file,
                     const std::string& place);

}  // namespace trilens
