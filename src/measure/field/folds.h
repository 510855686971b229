// Fold curves of a position field: where its map from the screen turns over (singularities, Whitney folds).
#pragma once

#include <cstdint>
#include <vector>

#include "measure/field/position_field.h"

namespace trilens {

/// One entry per pixel of the data window of `field` (with its links): 1 within kFoldReach pixels of a fold,
/// else 0. A fold is where the map from the screen to what is seen turns over: cells of four pixels on either
/// side of it cover one object side by side with opposite orientations. In a mirror it is where a caustic of
/// the eye's rays touches the scene; there a small error of the surface moves an image by its square root, so
/// that a mean over the displacements d of many pixels falls like d log(1 / d), not like d. Creases where an
/// object's normal turns by less than 120 degrees are no folds. Depends on this field alone, hence the same
/// pixels for every test of one reference.
std::vector<std::uint8_t> near_folds(const PositionField& field);

inline constexpr int kFoldReach = 4;

}  // namespace trilens
