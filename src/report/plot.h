// A plot as shapes, and how they look: its scales, their ticks, and labels that do not touch one another.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
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

// A plot's scales, their ticks, and labels that do not touch one another.

enum class ScaleKind { kLinear, kLog };

/// Maps values lo..hi to pixels first..last; on a log scale lo and hi are positive.
struct PlotScale {
    ScaleKind kind = ScaleKind::kLinear;
    double lo = 0, hi = 1;
    double first = 0, last = 1;

    /// Whether the scale can show `value` somewhere: finite, and positive on a log scale.
    bool can_show(double value) const;
    double pixel(double value) const;
};

struct PlotTick {
    double value = 0;
    std::string label;    // empty: a faint line only
    bool strong = false;  // a decade, or every labelled tick of a linear scale
};

/// A scale whose range holds all `values` that it can show, with a margin; a log range is at least one decade
/// long. Without any such value: 0..1, or 1..10 on a log scale.
PlotScale fit_scale(ScaleKind kind, std::span<const double> values);

/// The ticks within the range, ascending: decades and their multiples 2..9 on a log scale, round steps on a
/// linear one.
std::vector<PlotTick> make_ticks(const PlotScale& scale);

/// A rectangle of pixels, y down.
struct PlotBox {
    Vec2 lo{0}, hi{0};
};

/// The width that a text takes at most in the fonts that plots ask for, pixels.
double text_width(const std::string& utf8, double font_size);

/// The text, or as much of it as fits into `width` pixels, and then "…".
std::string shortened_text(const std::string& utf8, double font_size, double width);

/// Where a text stands: `anchor` is "start", "middle" or "end", `at` is on its baseline.
PlotBox text_box(const Vec2& at, const std::string& anchor, const std::string& utf8, double font_size);

/// What is taken of a picture.
class PlotRoom {
  public:
    void take(const PlotBox& box) { taken_.push_back(box); }
    bool is_free(const PlotBox& box) const;
    /// Takes the box where it is free, and says whether it was.
    bool take_if_free(const PlotBox& box);

  private:
    std::vector<PlotBox> taken_;
};

// Line plots as SVG text that stands alone: measurements over a swept value, with their fits.

/// The line y = constant * x^-order.
struct PlotFit {
    double order = 0, constant = 0;
};

struct PlotSeries {
    std::string name;
    std::vector<Vec2> points;    // joined in the order given
    std::optional<PlotFit> fit;  // drawn on log-log plots
};

/// A horizontal line that the eye should compare with, such as y = 1 px.
struct PlotLevel {
    double y = 0;
    std::string label;
};

/// A vertical line: what something beside the series takes.
struct PlotPlace {
    double x = 0;
    std::string label;
};

struct PlotParams {
    std::string title, x_label, y_label;  // labels with units: "mean displacement [px]"
    std::vector<PlotLevel> levels;
    bool reference_orders = true;   // faint lines of order 1 and 2, on log-log plots
    int width = 400, height = 340;  // the legend comes below and adds to the height
    bool ticks_at_points = false;   // x ticks where measurements are, if they are few; else at round values
    std::string subtitle = {};      // small, below the title
    bool is_linear = false;         // of draw_plot: both axes linear, else both logarithmic
    bool joins_points = true;       // a line through the measurements of a series
    std::vector<PlotPlace> places = {};
};

/// The plot as shapes: log_log_plot or linear_plot, by `is_linear`.
PlotDrawing draw_plot(const PlotParams& params, std::span<const PlotSeries> series);

/// An SVG document with both axes logarithmic. Points that are not finite or not positive are left out, and a
/// note in the picture says how many. No word covers another word or a measurement: those without room are
/// left out, but for titles and the legend, which are cut short. A series that lies on an earlier one is
/// drawn dashed and with hollow markers, so that both are seen, and the legend says so. Eight series differ
/// in colour and marker; from the ninth on they repeat. The text depends on the arguments alone.
std::string log_log_plot(const PlotParams& params, std::span<const PlotSeries> series);

/// The same with both axes linear: only points that are not finite are left out; no fits and reference
/// orders.
std::string linear_plot(const PlotParams& params, std::span<const PlotSeries> series);

// Maps of values over two axes, in the colours of viridis.

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
