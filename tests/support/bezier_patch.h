// A bumpy bicubic patch.
#pragma once

#include <cstddef>
#include <cstdint>

#include "scene/data/patches.h"
#include "support/draw.h"

namespace trilens_test {

/// Control points in a square lattice from -1.5 to 1.5, each moved by at most so much.
inline trilens::BezierPatch random_patch(std::uint64_t seed, double along, double up) {
    Draw draw(seed);
    trilens::BezierPatch patch;
    for (std::size_t k = 0; k < 16; ++k)
        patch[k] =
            trilens::Vec3(static_cast<double>(k % 4) - 1.5, static_cast<double>(k / 4) - 1.5, 0) +
            trilens::Vec3(draw.uniform(-along, along), draw.uniform(-along, along), draw.uniform(-up, up));
    return patch;
}

}  // namespace trilens_test
