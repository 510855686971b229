// Two facets that share an edge, and a scene triangle across it whose straight edges do not meet there
// (Vallance 2005, figure 5.1).
#pragma once

#include <array>
#include <cstdint>

#include "thesis/configuration.h"

namespace trilens {

/// Corners 0, 1, 2, 3 of a square on the screen, clockwise from its top left; facets (0, 1, 2) and (0, 2, 3).
struct TwoFacets {
    std::array<Ray, 4> corner;
    SceneTriangle triangle;
    double gap =
        0;  // how far the straight edges miss one another on the shared edge, as a share of its length
};

/// Seeks a clear discontinuity; the same for the same seed.
TwoFacets search_discontinuity(std::uint64_t seed);

}  // namespace trilens
