// The colours and strokes of plots, as style rules.
#pragma once

#include <cstddef>
#include <string>

namespace trilens {

/// The rules of a plot on white paper.
std::string plot_style();

/// For pages that hold plots inline, on dark paper: every rule begins with `scope`.
std::string dark_plot_style(const std::string& scope);

/// As many series differ in colour; then colours repeat.
inline constexpr std::size_t kPlotColours = 8;

/// The colour of series i on white paper: "#0072b2".
std::string plot_series_colour(std::size_t i);

/// The class that colours series i.
std::string plot_series_class(std::size_t i);

}  // namespace trilens
