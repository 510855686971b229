// Transfer functions: which colour and extinction a scalar has, piecewise linear.
#pragma once

#include <string>
#include <vector>

#include "base/math/vec.h"

namespace trilens {

/// What a volume is like where its scalar has this value.
struct TransferPoint {
    double value = 0;
    Vec3 color{1};          // radiance that an opaque volume of it has, linear Rec.709
    double extinction = 0;  // per world unit: how much of the light is lost over a short way, divided by it

    bool operator==(const TransferPoint&) const = default;
};

/// Linear between its points, constant beyond the first and the last.
struct TransferFunction {
    std::vector<TransferPoint> points;  // at least one; their values rise

    bool operator==(const TransferFunction&) const = default;

    /// The colour and extinction at this value.
    TransferPoint at(double value) const;
};

/// The names of the colour maps: "grey", "heat", "viridis".
const std::vector<std::string>& color_map_names();

/// The colours of a map, linear Rec.709, at even steps from its lower to its upper end. grey: black to white,
/// even in light. heat: black, red, yellow, white (the colours of a black body as pictures of temperatures
/// have them). viridis: ten colours of the map of van der Walt and Smith, A Better Default Colormap for
/// Matplotlib, SciPy 2015 (CC0), given there in sRGB. Throws UsageError with the nearest name where there is
/// none.
std::vector<Vec3> color_map(const std::string& name);

}  // namespace trilens
