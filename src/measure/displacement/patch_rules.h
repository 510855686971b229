// What counts as smooth, and as lying on a patch.
#pragma once

#include <limits>

namespace trilens {

/// Steps along the lines of a patch change so little that a cubic through them means something where a third
/// difference is at most a quarter of the longest step (this is squared). A jump at a patch's end gives 1, a
/// crease of 25 % gives a quarter.
inline constexpr double kSmoothThird = 1.0 / 16;

/// What may be left over where a patch comes closest to a point that lies on it: shares of the patch's own
/// bends and of its shorter tangent, and the rounding of float positions, of the point's distance.
inline constexpr double kBendShare = 0.5, kTangentShare = 0.05;
inline constexpr double kRounding = 4.0 * std::numeric_limits<float>::epsilon();

}  // namespace trilens
