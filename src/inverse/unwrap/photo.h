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

/// The largest value, of any of the three colours, of the pixels that sample_footprint makes that mean of.
float brightest_in_footprint(const Texture& photo, const Vec2& at, const Mat2& jacobian);

/// The mean of the pixels that may be used.
struct UsableMean {
    Vec3 colour{0};
    double share = 0;  // of the weights of all; a colour only where it is above 0
};
/// The same mean over the photograph's pixels at which `mask`, of its size, has red of 1/2 or more.
UsableMean sample_usable(const Texture& photo, const Texture& mask, const Vec2& at, const Mat2& jacobian);

}  // namespace trilens
