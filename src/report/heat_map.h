// A table of numbers as colours: one value per pair of settings.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "report/plot_drawing.h"

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

}  // namespace trilens
