// A photograph to sample: bicubic (Catmull-Rom; Keys 1981), and averaged over the parallelogram that a pixel
// of another picture covers on it.
#pragma once

#include "base/description/material.h"
#include "base/math/vec.h"

namespace trilens {

/// The colour at a place in pixels from the top left (centres at .5), not below 0; beyond the border the
/// nearest pixels are repeated.
Vec3 sample_bicubic(const Texture& photo, const Vec2& at);

/// The mean over the parallelogram `jacobian` * [-1/2, 1/2]^2 about the place, less what the photograph's own
/// pixels have averaged already: m x n bicubic samples, as many along each side as it is pixels long, 1 to
/// kMostFootprint.
Vec3 sample_footprint(const Texture& photo, const Vec2& at, const Mat2& jacobian);

inline constexpr int kMostFootprint = 32;

}  // namespace trilens
