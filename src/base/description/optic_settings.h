// How an optic is cut into facets: where they lie, and how the rays at their corners are chosen.
#pragma once

#include <cstdint>

namespace trilens {

/// kInterpolated: each corner has its own exact ray. kFitted: corner rays are such that what is interpolated
/// between them comes nearest to the exact rays in the mean.
enum class CornerRays : std::uint8_t { kInterpolated, kFitted };

/// "interpolated", "fitted".
constexpr const char* corner_rays_name(CornerRays rays) {
    return rays == CornerRays::kFitted ? "fitted" : "interpolated";
}

/// kSurface: N x N per face of the surface (thesis 7.2.1). kScreen: N x N over the optic's bounds on the film
/// (thesis 7.2.2); for optics of many small faces, or none.
enum class GridKind { kSurface, kScreen };

}  // namespace trilens
