// The colours in which FLIP compares: linear sRGB (D65), CIE XYZ, YCxCz (Y, red-green, blue-yellow), L*a*b*.
#pragma once

#include <array>
#include <cmath>

namespace trilens {

using Colour = std::array<double, 3>;

/// A colour relative to white in XYZ (relative_to_white) as YCxCz.
Colour ycxcz_of_relative(const Colour& relative);

/// Linear sRGB as XYZ, each divided by white's.
Colour relative_to_white(const Colour& rgb);

/// YCxCz as linear sRGB.
Colour rgb_of_ycxcz(const Colour& ycxcz);

/// Linear sRGB as L*a*b* with the chroma weighted by lightness (Hunt: what is dark has less colour).
Colour hunt_lab(const Colour& rgb);

/// HyAB (Abasi, Amani Tehran, Fairchild 2020): city blocks in lightness, straight in chroma.
inline double hyab(const Colour& a, const Colour& b) {
    return std::abs(a[0] - b[0]) + std::hypot(a[1] - b[1], a[2] - b[2]);
}

}  // namespace trilens
