// Line plots as SVG text that stands alone. Colours: Okabe and Ito, Color Universal Design, 2008; each series
// also has a marker of its own, so that none needs colour to be told apart.
#include "report/plot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <set>
#include <utility>

#include "report/plot_labels.h"
#include "report/plot_scale.h"
#include "report/plot_style.h"
#include "report/text.h"

namespace trilens {
namespace {

constexpr double kLeft = 62, kRight = 16, kBottom = 44;  // pixels around the frame, without the legend
constexpr double kTitleSize = 14, kLabelSize = 12, kNoteSize = 11;  // pixels, as in plot_style.cpp
constexpr double kLegendRow = 18, kMarkerRoom = 22;
constexpr double kReferenceLift = 1.8;  // reference orders start so far above the data
constexpr std::size_t kMostTicks = 24;  // measured values that are ticks; with more, round values are

struct Plot {
    const PlotParams& params;
    std::span<const PlotSeries> series;
    PlotScale x, y;
    std::string svg;
    PlotRoom room, lines;  // words and measurements; where lines are drawn
    double height = 0;     // of all that was drawn

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

/// Where two labels would touch, the later of: the first and the last of the axis, decades, the others.
void draw_tick_labels(Plot& plot, std::vector<PlotTick> ticks, bool is_x) {
    constexpr double kGap = 5;
    std::vector<std::pair<int, PlotTick>> labelled;
    for (std::size_t i = 0; i < ticks.size(); ++i)
        if (!ticks[i].label.empty())
            labelled.push_back({i == 0 || i + 1 == ticks.size() ? 0 : ticks[i].strong ? 1 : 2, ticks[i]});
    std::ranges::stable_sort(labelled, {}, &std::pair<int, PlotTick>::first);
    PlotRoom row;
    for (const auto& [rank, tick] : labelled) {
        // A long number at the right end moves into the picture.
        const double half = text_width(tick.label, kLabelSize) / 2;
        const Vec2 at =
            is_x ? Vec2(std::min(plot.x.pixel(tick.value), plot.params.width - half), plot.y.first + 17)
                 : Vec2(plot.x.first - 7, plot.y.pixel(tick.value) + 4);
        PlotBox box = text_box(at, is_x ? "middle" : "end", tick.label, kLabelSize);
        if (is_x) box.lo.x -= kGap, box.hi.x += kGap;
        if (!row.take_if_free(box)) continue;
        plot.svg += text(is_x ? "tp-tick tp-x" : "tp-tick tp-y", at, is_x ? "middle" : "end", tick.label);
    }
}

/// The values at which there are measurements, each a tick; none where they are too many.
std::vector<PlotTick> measured_ticks(const Plot& plot) {
    std::set<double> values;
    for (const PlotSeries& series : plot.series)
        for (const Vec2& point : series.points)
            if (plot.can_show(point)) values.insert(point.x);
    std::vector<PlotTick> ticks;
    if (values.size() > kMostTicks) return ticks;
    for (const double value : values) ticks.push_back({value, rounded_text(value, 6), true});
    return ticks;
}

void draw_frame(Plot& plot) {
    const PlotScale &x = plot.x, &y = plot.y;
    const std::vector<PlotTick> measured =
        plot.params.ticks_at_points ? measured_ticks(plot) : std::vector<PlotTick>();
    const std::vector<PlotTick> across = measured.empty() ? make_ticks(x) : measured, up = make_ticks(y);
    for (const PlotTick& tick : across) {
        const double at = x.pixel(tick.value);
        plot.svg += line(tick.strong ? "tp-grid" : "tp-minor", {at, y.first}, {at, y.last});
    }
    for (const PlotTick& tick : up) {
        const double at = y.pixel(tick.value);
        plot.svg += line(tick.strong ? "tp-grid" : "tp-minor", {x.first, at}, {x.last, at});
    }
    draw_tick_labels(plot, across, true);
    draw_tick_labels(plot, up, false);
    plot.svg += "<rect class=\"tp-frame\"" + attribute("x", x.first) + attribute("y", y.last) +
                attribute("width", x.last - x.first) + attribute("height", y.first - y.last) + "/>\n";

    const double middle_x = (x.first + x.last) / 2, middle_y = (y.first + y.last) / 2;
    const double width = plot.params.width - 20, tall = y.first - y.last + 20;
    plot.svg += text("tp-title", {10, 21}, "start", shortened_text(plot.params.title, kTitleSize, width));
    if (!plot.params.subtitle.empty())
        plot.svg +=
            text("tp-note", {10, 37}, "start", shortened_text(plot.params.subtitle, kNoteSize, width));
    plot.svg += text("tp-label", {middle_x, y.first + 37}, "middle",
                     shortened_text(plot.params.x_label, kLabelSize, width - x.first));
    plot.svg += "<g transform=\"translate(15," + number(middle_y) + ") rotate(-90)\">" +
                text("tp-label", {0, 0}, "middle", shortened_text(plot.params.y_label, kLabelSize, tall)) +
                "</g>\n";
}

/// Draws the note at the first of the places where it lies in the frame and covers nothing, or else, where it
/// covers a line at most; nowhere if there is none.
void draw_note(Plot& plot, const std::string& words,
               const std::vector<std::pair<Vec2, const char*>>& places) {
    for (const bool may_cover_lines : {false, true})
        for (const auto& [at, anchor] : places) {
            const PlotBox box = text_box(at, anchor, words, kNoteSize);
            const bool is_inside = box.lo.x > plot.x.first && box.hi.x < plot.x.last &&
                                   box.lo.y > plot.y.last && box.hi.y < plot.y.first;
            if (!is_inside || (!may_cover_lines && !plot.lines.is_free(box)) || !plot.room.take_if_free(box))
                continue;
            plot.svg += text("tp-note tp-inside", at, anchor, words);
            return;
        }
}

/// Remembers where a line runs, in steps of a few pixels.
void take_line(Plot& plot, const Vec2& a, const Vec2& b) {
    const int steps = 1 + static_cast<int>(length(b - a) / 4);
    for (int i = 0; i <= steps; ++i) {
        const Vec2 at = a + static_cast<double>(i) / steps * (b - a);
        plot.lines.take({at - Vec2(1), at + Vec2(1)});
    }
}

/// Measurements take their place before any word does.
void take_markers(Plot& plot) {
    for (const PlotSeries& series : plot.series)
        for (const Vec2& point : series.points)
            if (plot.can_show(point)) {
                const Vec2 at = plot.pixel(point);
                plot.room.take({at - Vec2(6), at + Vec2(6)});
            }
}

void draw_levels(Plot& plot) {
    for (const PlotLevel& level : plot.params.levels) {
        if (!plot.y.can_show(level.y) || level.y < plot.y.lo || level.y > plot.y.hi) continue;
        const double at = plot.y.pixel(level.y);
        plot.svg += line("tp-level", {plot.x.first, at}, {plot.x.last, at});
        const double left = plot.x.first + 6, right = plot.x.last - 6;
        draw_note(plot, level.label,
                  {{{right, at - 4}, "end"},
                   {{left, at - 4}, "start"},
                   {{right, at + 12}, "end"},
                   {{left, at + 12}, "start"},
                   {{(left + right) / 2, at - 4}, "middle"}});
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
        take_line(plot, start, end);
        // The label stands above the line, as near to its end as there is room.
        std::vector<std::pair<Vec2, const char*>> places;
        for (const double share : {0.98, 0.85, 0.7, 0.55, 0.4})
            places.push_back({start + share * (end - start) + Vec2(4, -5), "start"});
        for (const double share : {0.98, 0.85, 0.7, 0.55, 0.4})
            places.push_back({start + share * (end - start) + Vec2(-4, 14), "end"});
        draw_note(plot, "order " + std::to_string(order), places);
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
        if (inside) {
            plot.svg += line("tp-fit " + plot_series_class(i), (*inside)[0], (*inside)[1]);
            take_line(plot, (*inside)[0], (*inside)[1]);
        }
        if (!path.empty())
            plot.svg += "<path class=\"tp-join " + plot_series_class(i) + "\" d=\"" + path + "\"/>\n";
    } else if (!path.empty()) {
        plot.svg += "<path class=\"tp-line " + plot_series_class(i) + "\" d=\"" + path + "\"/>\n";
    }
    plot.svg += markers;
}

/// The series in rows below the frame, as many to a row as fit.
void draw_legend(Plot& plot) {
    const double left = 10, right = plot.params.width - 10;
    Vec2 at(left, plot.y.first + kBottom + kLegendRow - 6);
    for (std::size_t i = 0; i < plot.series.size(); ++i) {
        const PlotSeries& series = plot.series[i];
        const std::string order =
            plot.is_log() && series.fit ? ": order " + fixed_text(series.fit->order, 2) : "";
        const double most = right - left - kMarkerRoom - text_width(order, kLabelSize);
        const std::string entry = shortened_text(series.name, kLabelSize, most) + order;
        const double width = kMarkerRoom + text_width(entry, kLabelSize);
        if (at.x > left && at.x + width > right) at = {left, at.y + kLegendRow};
        plot.svg += marker(i, {at.x + 7, at.y - 4}, "");
        plot.svg += text("tp-entry", {at.x + 17, at.y}, "start", entry);
        at.x += width;
        plot.height = at.y + 8;
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
    plot.svg += text("tp-note", {10, plot.height + 8}, "start", words);
    plot.height += 16;
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
    Plot plot{params, series, fit_scale(kind, xs), fit_scale(kind, ys), "", {}, {}, 0};
    plot.x.first = kLeft, plot.x.last = params.width - kRight;
    plot.y.first = params.height - kBottom, plot.y.last = params.subtitle.empty() ? 34 : 48;
    plot.height = params.height;

    draw_frame(plot);
    take_markers(plot);
    for (std::size_t i = 0; i < series.size(); ++i) draw_series(plot, i);
    if (plot.is_log() && params.reference_orders) draw_reference_orders(plot);
    draw_levels(plot);
    draw_legend(plot);
    draw_left_out(plot);

    const std::string width = std::to_string(params.width), height = number(plot.height);
    return "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"tp\" width=\"" + width + "\" height=\"" +
           height + "\" viewBox=\"0 0 " + width + " " + height + "\" role=\"img\" aria-label=\"" +
           escape_markup(params.title) + "\">\n" + "<style>" + plot_style() + "</style>\n" +
           "<rect class=\"tp-paper\" width=\"" + width + "\" height=\"" + height + "\"/>\n" + plot.svg +
           "</svg>\n";
}

}  // namespace

std::string log_log_plot(const PlotParams& params, std::span<const PlotSeries> series) {
    return draw(params, series, ScaleKind::kLog);
}

std::string linear_plot(const PlotParams& params, std::span<const PlotSeries> series) {
    return draw(params, series, ScaleKind::kLinear);
}

}  // namespace trilens
