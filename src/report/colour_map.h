// From a number to a colour that the colour-blind tell apart and that also prints in grey.
#pragma once

#include <array>
#include <string>

namespace trilens {

using LinearRgb = std::array<float, 3>;  // linear Rec.709, 0..1

/// Viridis (van der Walt and Smith, 2015), by Matt Zucker's polynomial of degree 6 (within 0.02); `share` is
/// clamped to 0..1, NaN counts as 0.
LinearRgb viridis(double share);

/// The same colour for style sheets: "#440154".
std::string viridis_hex(double share);

/// A range of positive values shown on a logarithmic colour scale.
struct ColourRange {
    double lo = 0.01, hi = 10;

    /// 0 at lo and below, 1 at hi and above.
    double share(double value) const;
};

}  // namespace trilens
