// The colours and strokes of plots, as style rules.
#pragma once

#include <cstddef>
#include <string>

namespace trilens {

/// The rules of a plot on white paper.
std::string plot_style();

/// For pages that hold plots inline, on dark paper: every rule begins with `scope`.
std::string dark_plot_style(const std::string& scope);

/// The class that colours series i.
std::string plot_series_class(std::size_t i);

}  // namespace trilens
