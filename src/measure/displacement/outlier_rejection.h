// Tells a point's displaced image from another image of the same point: displacement is continuous, a jump is
// not.
#pragma once

#include <span>
#include <vector>

#include "measure/displacement/displacement.h"

namespace trilens {

/// A curved mirror may show one point several times. Where the image that a pixel shows has no counterpart
/// (at a rim that the facets draw a little too large, say), the nearest match is another image of the point,
/// far away, and no measure of the error. Such a pixel's shift exceeds kOtherImage times the median shift of
/// the found pixels in the 7 x 7 window round it plus half a pixel; near a fold, where shifts grow large
/// together, none does. These pixels become kLost. Pixels with fewer than kFewestNeighbours found ones round
/// them stay as they are. `width`: of the data window.
void drop_other_images(Displacement& displacement, int width);

inline constexpr double kOtherImage = 8;
inline constexpr std::size_t kFewestNeighbours = 6;

}  // namespace trilens
