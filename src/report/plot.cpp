// Line plots as SVG text that stands alone. Colours: Okabe and Ito, Color Universal Design, 2008; each series
// also has a marker of its own, so that none needs colour to be told apart.
#include "report/plot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "report/plot_scale.h"
#include "report/plot_style.h"
#include "report/text.h"

namespace trilens {
namespace {

constexpr double kLeft = 68, kRight = 18, kTop = 38, kBottom = 54;  // pixels around the frame
constexpr double kCharWidth = 6.4;                                  // of the 11 px font, on average
constexpr double kReferenceLabelWidth = 36;                         // "order 2" in the small font
constexpr double kReferenceLift = 1.8;  // reference orders start so far above the data

struct Plot {
    const PlotParams& params;
    std::span<const PlotSeries> series;
    PlotScale x, y;
    std::string svg;

    bool is_log() const { return x.kind == ScaleKind::kLog; }
    bool can_show(const Vec2& point) const { return x.can_show(point.x) && y.can_show(point.y); }
    Vec2 pixel(const Vec2& point) const { return {x.pixel(point.x), y.pixel(point.y)}; }
};

std::string number(double pixel) {
    return fixed_text(pixel, 2);
}
std::string attribute(const char* name, double pixel) {
    return std::string(" ") + name + "=\"" + number(pixel) + "\"";
}
std::string line(const std::string& kind, const Vec2& a, const Vec2& b) {
    return "<line class=\"" + kind + "\"" + attribute("x1", a.x) + attribute("y1", a.y) +
           attribute("x2", b.x) + attribute("y2", b.y) + "/>\n";
}

/// `anchor`: "start", "middle" or "end" of the text stands at `at`.
std::string text(const std::string& kind, const Vec2& at, const char* anchor, const std::string& words) {
    return "<text class=\"" + kind + "\"" + attribute("x", at.x) + attribute("y", at.y) + " text-anchor=\"" +
           anchor + "\">" + escape_markup(words) + "</text>\n";
}

/// One of eight shapes of about 8 pixels around `at`.
std::string marker(std::size_t i, const Vec2& at, const std::string& inside) {
    constexpr std::array<const char*, 7> kPaths = {
        "m-3.6,-3.6h7.2v7.2h-7.2z", "m0,-5l4.6,8h-9.2z", "m0,-5l5,5l-5,5l-5,-5z", "m0,5l4.6,-8h-9.2z",
        "m-4,-4l8,8m0,-8l-8,8",     "m0,-5v10m-5,-5h10", "m-5,-2h10v4h-10z"};
    const std::string shape =
        i % 8 == 0 ? "<circle" + attribute("cx", at.x) + attribute("cy", at.y) + " r=\"4\""
                   : "<path d=\"M" + number(at.x) + "," + number(at.y) + kPaths[i % 8 - 1] + "\"";
    const std::string start = shape + " class=\"tp-marker " + plot_series_class(i) + "\"";
    return inside.empty() ? start + "/>\n"
                          : start + "><title>" + escape_markup(inside) + "</title>" +
                                (i % 8 == 0 ? "</circle>\n" : "</path>\n");
}

/// The part of the segment a-b (pixels) inside the frame; none where all of it is outside (Liang and Barsky,
/// 1984).
std::optional<std::array<Vec2, 2>> clip_to_frame(const Plot& plot, const Vec2& a, const Vec2& b) {
    double enter = 0, leave = 1;
    const Vec2 along = b - a;
    const auto keep = [&](double slope, double room) {  // the half plane slope * s <= room
        if (slope < 0) enter = std::max(enter, room / slope);
        if (slope > 0) leave = std::min(leave, room / slope);
        return slope != 0 || room >= 0;
    };
    const bool may_cross = keep(-along.x, a.x - plot.x.first) && keep(along.x, plot.x.last - a.x) &&
                           keep(-along.y, a.y - plot.y.last) && keep(along.y, plot.y.first - a.y);
    if (!may_cross || enter > leave) return std::nullopt;
    return std::array<Vec2, 2>{a + enter * along, a + leave * along};
}

void draw_frame(Plot& plot) {
    const PlotScale &x = plot.x, &y = plot.y;
    for (const PlotTick& tick : make_ticks(x)) {
        const double at = x.pixel(tick.value);
        plot.svg += line(tick.strong ? "tp-grid" : "tp-minor", {at, y.first}, {at, y.last});
        if (!tick.label.empty()) plot.svg += text("tp-tick tp-x", {at, y.first + 17}, "middle", tick.label);
    }
    for (const PlotTick& tick : make_ticks(y)) {
        const double at = y.pixel(tick.value);
        plot.svg += line(tick.strong ? "tp-grid" : "tp-minor", {x.first, at}, {x.last, at});
        if (!tick.label.empty()) plot.svg += text("tp-tick tp-y", {x.first - 7, at + 4}, "end", tick.label);
    }
    plot.svg += "<rect class=\"tp-frame\"" + attribute("x", x.first) + attribute("y", y.last) +
                attribute("width", x.last - x.first) + attribute("height", y.first - y.last) + "/>\n";

    const double middle_x = (x.first + x.last) / 2, middle_y = (y.first + y.last) / 2;
    plot.svg += text("tp-title", {x.first, 23}, "start", plot.params.title);
    plot.svg += text("tp-label", {middle_x, y.first + 38}, "middle", plot.params.x_label);
    plot.svg += "<g transform=\"translate(18," + number(middle_y) + ") rotate(-90)\">" +
                text("tp-label", {0, 0}, "middle", plot.params.y_label) + "</g>\n";
}

void draw_levels(Plot& plot) {
    for (const PlotLevel& level : plot.params.levels) {
        if (!plot.y.can_show(level.y) || level.y < plot.y.lo || level.y > plot.y.hi) continue;
        const double at = plot.y.pixel(level.y);
        plot.svg += line("tp-level", {plot.x.first, at}, {plot.x.last, at});
        plot.svg += text("tp-note", {plot.x.first + 6, at - 4}, "start", level.label);
    }
}

/// Lines of order 1 and 2 through a point a little above the leftmost, highest measurement.
void draw_reference_orders(Plot& plot) {
    Vec2 corner(INFINITY, -INFINITY);
    for (const PlotSeries& series : plot.series)
        for (const Vec2& point : series.points)
            if (plot.can_show(point)) corner = {std::min(corner.x, point.x), std::max(corner.y, point.y)};
    if (!std::isfinite(corner.x) || !std::isfinite(corner.y)) return;

    corner.y *= kReferenceLift;
    for (const int order : {1, 2}) {
        const Vec2 far(plot.x.hi, corner.y * std::pow(corner.x / plot.x.hi, order));
        const auto inside = clip_to_frame(plot, plot.pixel(corner), plot.pixel(far));
        if (!inside) continue;
        const auto& [start, end] = *inside;
        plot.svg += line("tp-reference", start, end);
        // The label stands on the line's end, where no measurement is.
        const double rise = (end.y - start.y) / (end.x - start.x) * kReferenceLabelWidth;
        plot.svg += text("tp-note", {end.x - 4, end.y - rise - 4}, "end", "order " + std::to_string(order));
    }
}

void draw_series(Plot& plot, std::size_t i) {
    const PlotSeries& series = plot.series[i];
    std::string path, markers;
    for (const Vec2& point : series.points) {
        if (!plot.can_show(point)) continue;
        const Vec2 at = plot.pixel(point);
        path += (path.empty() ? "M" : "L") + number(at.x) + "," + number(at.y);
        markers +=
            marker(i, at, series.name + ": " + rounded_text(point.x, 6) + " → " + rounded_text(point.y, 4));
    }
    // With a fit the fit is the line; without one the measurements are joined.
    if (plot.is_log() && series.fit && series.fit->constant > 0) {
        const auto on_fit = [&](double x) {
            return plot.pixel({x, series.fit->constant * std::pow(x, -series.fit->order)});
        };
        const auto inside = clip_to_frame(plot, on_fit(plot.x.lo), on_fit(plot.x.hi));
        if (inside) plot.svg += line("tp-fit " + plot_series_class(i), (*inside)[0], (*inside)[1]);
        if (!path.empty())
            plot.svg += "<path class=\"tp-join " + plot_series_class(i) + "\" d=\"" + path + "\"/>\n";
    } else if (!path.empty()) {
        plot.svg += "<path class=\"tp-line " + plot_series_class(i) + "\" d=\"" + path + "\"/>\n";
    }
    plot.svg += markers;
}

/// The corner of the frame where a box of this size hides the fewest measurements; right before left, top
/// before bottom.
Vec2 emptiest_corner(const Plot& plot, const Vec2& size) {
    constexpr double kGap = 8;
    const double left = plot.x.first + kGap, right = plot.x.last - kGap - size.x;
    const double top = plot.y.last + kGap, bottom = plot.y.first - kGap - size.y;
    const std::array<Vec2, 4> corners = {Vec2(right, top), Vec2(left, bottom), Vec2(left, top),
                                         Vec2(right, bottom)};
    std::array<std::size_t, 4> hidden{};
    for (std::size_t corner = 0; corner < corners.size(); ++corner)
        for (const PlotSeries& series : plot.series)
            for (const Vec2& point : series.points) {
                if (!plot.can_show(point)) continue;
                const Vec2 offset = plot.pixel(point) - corners[corner];
                hidden[corner] +=
                    offset.x > -6 && offset.y > -6 && offset.x < size.x + 6 && offset.y < size.y + 6;
            }
    return corners[static_cast<std::size_t>(std::min_element(hidden.begin(), hidden.end()) - hidden.begin())];
}

std::size_t character_count(const std::string& utf8) {
    return static_cast<std::size_t>(std::count_if(
        utf8.begin(), utf8.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }));
}

void draw_legend(Plot& plot) {
    if (plot.series.empty()) return;
    std::vector<std::string> entries;
    std::size_t longest = 0;
    for (const PlotSeries& series : plot.series) {
        std::string entry = series.name;
        if (plot.is_log() && series.fit) entry += ": order " + fixed_text(series.fit->order, 2);
        longest = std::max(longest, character_count(entry));
        entries.push_back(entry);
    }
    const Vec2 size(34 + kCharWidth * static_cast<double>(longest),
                    10 + 17 * static_cast<double>(entries.size()));
    const Vec2 corner = emptiest_corner(plot, size);
    plot.svg += "<rect class=\"tp-legend\" rx=\"4\"" + attribute("x", corner.x) + attribute("y", corner.y) +
                attribute("width", size.x) + attribute("height", size.y) + "/>\n";
    for (std::size_t i = 0; i < entries.size(); ++i) {
        const double middle = corner.y + 13 + 17 * static_cast<double>(i);
        plot.svg += marker(i, {corner.x + 14, middle}, "");
        plot.svg += text("tp-entry", {corner.x + 26, middle + 4}, "start", entries[i]);
    }
}

void draw_left_out(Plot& plot) {
    std::size_t left_out = 0, shown = 0;
    for (const PlotSeries& series : plot.series)
        for (const Vec2& point : series.points) ++(plot.can_show(point) ? shown : left_out);
    if (shown == 0)
        plot.svg += text("tp-label", {(plot.x.first + plot.x.last) / 2, (plot.y.first + plot.y.last) / 2},
                         "middle", "nothing to draw");
    if (left_out == 0) return;
    const std::string words =
        std::to_string(left_out) + (left_out == 1 ? " point" : " points") +
        " left out: " + (plot.is_log() ? "zero, negative or not a number" : "not a number");
    plot.svg += text("tp-note", {plot.x.last, plot.y.first + 49}, "end", words);
}

std::string draw(const PlotParams& params, std::span<const PlotSeries> series, ScaleKind kind) {
    std::vector<double> xs, ys;
    const PlotScale any{kind, 0, 1, 0, 1};
    for (const PlotSeries& one : series)
        for (const Vec2& point : one.points) {
            if (!any.can_show(point.x) || !any.can_show(point.y)) continue;
            xs.push_back(point.x);
            ys.push_back(point.y);
        }
    if (kind == ScaleKind::kLog && params.reference_orders && !ys.empty())
        ys.push_back(kReferenceLift * *std::max_element(ys.begin(), ys.end()));
    Plot plot{params, series, fit_scale(kind, xs), fit_scale(kind, ys), ""};
    plot.x.first = kLeft, plot.x.last = params.width - kRight;
    plot.y.first = params.height - kBottom, plot.y.last = kTop;

    const std::string width = std::to_string(params.width), height = std::to_string(params.height);
    plot.svg = "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"tp\" width=\"" + width + "\" height=\"" +
               height + "\" viewBox=\"0 0 " + width + " " + height + "\" role=\"img\" aria-label=\"" +
               escape_markup(params.title) + "\">\n" + "<style>" + plot_style() + "</style>\n" +
               "<rect class=\"tp-paper\" width=\"" + width + "\" height=\"" + height + "\"/>\n";
    draw_frame(plot);
    draw_levels(plot);
    if (plot.is_log() && params.reference_orders) draw_reference_orders(plot);
    for (std::size_t i = 0; i < series.size(); ++i) draw_series(plot, i);
    draw_legend(plot);
    draw_left_out(plot);
    return plot.svg + "</svg>\n";
}

}  // namespace

std::string log_log_plot(const PlotParams& params, std::span<const PlotSeries> series) {
    return draw(params, series, ScaleKind::kLog);
}

std::string linear_plot(const PlotParams& params, std::span<const PlotSeries> series) {
    return draw(params, series, ScaleKind::kLinear);
}

}  // namespace trilens
