// Maps of values over two axes, in the colours of viridis.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "report/plot_style.h"

namespace trilens {

struct HeatMapParams {
    std::string title, subtitle, x_label, y_label, value_label;
    std::vector<std::string> x_values, y_values;
    std::vector<double> values;  // row by row, the first value of y first; NaN: none

    double cell(std::size_t column, std::size_t row) const { return values[row * x_values.size() + column]; }
};

/// The cells in viridis on a logarithmic scale over the values above zero, each with its number where there
/// is room; zero is the scale's low end, and a cell without a value is left white. The first value of y is
/// below.
PlotDrawing draw_heat_map(const HeatMapParams& params);

using LinearRgb = std::array<float, 3>;  // linear Rec.709, 0..1

/// Viridis (van der Walt and Smith, 2015), by Matt Zucker's polynomial of degree 6 (within 0.02); `share` is
/// clamped to 0..1, NaN counts as 0.
LinearRgb viridis(double share);

/// The same colour for style sheets: "#440154".
std::string viridis_hex(double share);

/// A range of positive values shown on a logarithmic colour scale.
struct ColourRange {
    double lo = 0.01, hi = 10;

    /// 0 at lo and below, 1 at hi and above.
    double share(double value) const;
};

}  // namespace trilens
