// How the rays at the corners of an optic's facets are chosen.
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

}  // namespace trilens
