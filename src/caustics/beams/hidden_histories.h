// Histories that no corner of a divided window has: found beside borders, and by probes.
#pragma once

#include "caustics/beams/beam_grid.h"
#include "caustics/beams/history_borders.h"

namespace trilens {

/// Divides triangles on whose sides a history lies hidden between two others, and such inside of which probes
/// find one: exact rays, the more the more light comes to the triangle, and more of them in what was divided
/// for one. `histories`: of the grid, whose borders are known and will be. Throws Interrupted soon after
/// `progress` says so.
void find_hidden_histories(BeamGrid& grid, GridHistories& histories, const Progress& progress);

}  // namespace trilens
