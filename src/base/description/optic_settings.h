// How an optic is cut into facets: where they lie, and how the rays at their corners are chosen.
#pragma once

#include <cstdint>

#include "base/util/enum_names.h"

namespace trilens {

/// kInterpolated: each corner has its own exact ray. kFitted: corner rays are such that what is interpolated
/// between them comes nearest to the exact rays in the mean.
enum class CornerRays : std::uint8_t { kInterpolated, kFitted };

template <>
struct EnumNames<CornerRays> {
    static constexpr std::array kTable{NamedValue<CornerRays>{CornerRays::kFitted, "fitted"},
                                       NamedValue<CornerRays>{CornerRays::kInterpolated, "interpolated"}};
};

/// kSurface: N x N per face of the surface (thesis 7.2.1). kScreen: N x N over the optic's bounds on the film
/// (thesis 7.2.2); for optics of many small faces, or none.
enum class GridKind { kSurface, kScreen };

template <>
struct EnumNames<GridKind> {
    static constexpr std::array kTable{NamedValue<GridKind>{GridKind::kSurface, "surface"},
                                       NamedValue<GridKind>{GridKind::kScreen, "screen"}};
};

}  // namespace trilens
