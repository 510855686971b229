// The colours of named maps, for transfer functions.
#pragma once

#include <string>
#include <vector>

#include "base/math/vec.h"
#include "volume/volume_data.h"

namespace trilens {

/// The names of the colour maps: "grey", "heat", "viridis".
const std::vector<std::string>& color_map_names();

/// The colours of a map, linear Rec.709, at even steps from its lower to its upper end. grey: black to white,
/// even in light. heat: black, red, yellow, white (the colours of a black body as pictures of temperatures
/// have them). viridis: ten colours of the map of van der Walt and Smith, A Better Default Colormap for
/// Matplotlib, SciPy 2015 (CC0), given there in sRGB. Throws UsageError with the nearest name where there is
/// none.
std::vector<Vec3> color_map(const std::string& name);

}  // namespace trilens
