// How many separate shapes a picture shows.
#pragma once

#include <cstddef>

#include "base/image/image.h"

namespace trilens {

/// Smaller regions are specks: a thin tip may fall apart into pixels that do not touch.
inline constexpr std::size_t kSmallestRegion = 12;  // pixels

/// The connected regions, of at least `least` pixels each, of the pixels whose alpha (channel A) is above 0:
/// of what is seen before the environment. Pixels touch by sides and by corners. Throws InputError for an
/// image without floats A of its size.
std::size_t count_regions(const Image& image, std::size_t least = kSmallestRegion);

}  // namespace trilens
