// Line plots as SVG text that stands alone: measurements over a swept value, with their fits.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/math/vec.h"
#include "report/plot_style.h"

namespace trilens {

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

}  // namespace trilens
