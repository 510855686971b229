// A plot as shapes, and how they look.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "base/math/vec.h"

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

struct PlotShape {
    enum class Kind { kLine, kRectangle, kPath, kText, kMarker };
    Kind kind = Kind::kLine;
    std::string style;  // classes of plot_style: "tp-line tp-c0"
    std::vector<Vec2>
        points;  // pixels, y down; a rectangle's are two opposite corners, a text's or a marker's one
    std::string words = {};   // of a text; of a marker: what it says where a pointer rests on it
    std::string anchor = {};  // of a text: "start", "middle", "end"
    bool is_upright = false;  // a text that is read from below to above
    std::size_t series = 0;   // of a marker: its shape
    std::string fill = {};    // of a rectangle: "#440154" instead of the style's
};

struct PlotDrawing {
    double width = 0, height = 0;
    std::string title;
    std::vector<PlotShape> shapes;
};

/// The drawing as an SVG document with styles of its own.
std::string plot_svg(const PlotDrawing& drawing);

/// The drawing as a PDF document of one page, a point per 4/3 pixels, in Helvetica, which every reader has;
/// characters that its standard encoding (Windows 1252) lacks become the nearest that it has, or "?". The
/// bytes depend on the drawing alone.
std::string plot_pdf(const PlotDrawing& drawing);

/// A marker's outline around the origin, eight shapes by turns: strokes of points; closed ones end where
/// they begin. A circle is a polygon.
std::vector<std::vector<Vec2>> marker_strokes(std::size_t series);

}  // namespace trilens
