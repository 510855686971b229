// A plot as shapes, and how they look: its scales, their ticks, and labels that do not touch one another.
#pragma once

#include <cstddef>
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

}  // namespace trilens
