// Line plots as SVG text that stands alone. Colours: Okabe and Ito, Color Universal Design, 2008; each series
// also has a marker of its own, so that none needs colour to be told apart.
#include "report/plot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <set>
#include <utility>

#include "report/text.h"

namespace trilens {
namespace {

constexpr double kPlotLeft = 62, kPlotRight = 16,
                 kPlotBottom = 44;  // pixels around the frame, without the legend
constexpr double kTitleSize = 14, kLabelSize = 12, kNoteSize = 11;  // pixels, as in plot_style.cpp
constexpr double kLegendRow = 18, kMarkerRoom = 22;
constexpr double kReferenceLift = 1.8;  // reference orders start so far above the data
constexpr std::size_t kMostTicks = 24;  // measured values that are ticks; with more, round values are

struct Plot {
    const PlotParams& params;
    std::span<const PlotSeries> series;
    PlotScale x, y;
    std::vector<PlotShape> shapes;
    PlotRoom room, lines;  // words and measurements; where lines are drawn
    double height = 0;     // of all that was drawn

    bool is_log() const { return x.kind == ScaleKind::kLog; }
    bool can_show(const Vec2& point) const { return x.can_show(point.x) && y.can_show(point.y); }
    Vec2 pixel(const Vec2& point) const { return {x.pixel(point.x), y.pixel(point.y)}; }
};

PlotShape line(const std::string& kind, const Vec2& a, const Vec2& b) {
    return {PlotShape::Kind::kLine, kind, {a, b}};
}

/// `anchor`: "start", "middle" or "end" of the text stands at `at`.
PlotShape text(const std::string& kind, const Vec2& at, const char* anchor, const std::string& words) {
    return {PlotShape::Kind::kText, kind, {at}, words, anchor};
}

PlotShape marker(std::size_t i, const Vec2& at, const std::string& inside) {
    return {PlotShape::Kind::kMarker, "tp-marker " + plot_series_class(i), {at}, inside, "", false, i};
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
        plot.shapes.push_back(
            text(is_x ? "tp-tick tp-x" : "tp-tick tp-y", at, is_x ? "middle" : "end", tick.label));
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
        plot.shapes.push_back(line(tick.strong ? "tp-grid" : "tp-minor", {at, y.first}, {at, y.last}));
    }
    for (const PlotTick& tick : up) {
        const double at = y.pixel(tick.value);
        plot.shapes.push_back(line(tick.strong ? "tp-grid" : "tp-minor", {x.first, at}, {x.last, at}));
    }
    draw_tick_labels(plot, across, true);
    draw_tick_labels(plot, up, false);
    plot.shapes.push_back({PlotShape::Kind::kRectangle, "tp-frame", {{x.first, y.last}, {x.last, y.first}}});

    const double middle_x = (x.first + x.last) / 2, middle_y = (y.first + y.last) / 2;
    const double width = plot.params.width - 20, tall = y.first - y.last + 20;
    plot.shapes.push_back(
        text("tp-title", {10, 21}, "start", shortened_text(plot.params.title, kTitleSize, width)));
    if (!plot.params.subtitle.empty())
        plot.shapes.push_back(
            text("tp-note", {10, 37}, "start", shortened_text(plot.params.subtitle, kNoteSize, width)));
    plot.shapes.push_back(text("tp-label", {middle_x, y.first + 37}, "middle",
                               shortened_text(plot.params.x_label, kLabelSize, width - x.first)));
    PlotShape upright =
        text("tp-label", {15, middle_y}, "middle", shortened_text(plot.params.y_label, kLabelSize, tall));
    upright.is_upright = true;
    plot.shapes.push_back(upright);
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
            plot.shapes.push_back(text("tp-note tp-inside", at, anchor, words));
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
        plot.shapes.push_back(line("tp-level", {plot.x.first, at}, {plot.x.last, at}));
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
        plot.shapes.push_back(line("tp-reference", start, end));
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

void draw_places(Plot& plot) {
    for (const PlotPlace& place : plot.params.places) {
        if (!plot.x.can_show(place.x) || place.x < plot.x.lo || place.x > plot.x.hi) continue;
        const double at = plot.x.pixel(place.x), top = plot.y.last + 14, bottom = plot.y.first - 6;
        plot.shapes.push_back(line("tp-level", {at, plot.y.last}, {at, plot.y.first}));
        take_line(plot, {at, plot.y.last}, {at, plot.y.first});
        draw_note(plot, place.label,
                  {{{at + 5, top}, "start"},
                   {{at - 5, top}, "end"},
                   {{at + 5, bottom}, "start"},
                   {{at - 5, bottom}, "end"},
                   {{at + 5, (top + bottom) / 2}, "start"},
                   {{at - 5, (top + bottom) / 2}, "end"}});
    }
}

/// The first earlier series whose measurements lie on those of series i, to a pixel.
std::optional<std::size_t> lies_on(const Plot& plot, std::size_t i) {
    const auto shown = [&](const PlotSeries& series) {
        std::vector<Vec2> pixels;
        for (const Vec2& point : series.points)
            if (plot.can_show(point)) pixels.push_back(plot.pixel(point));
        return pixels;
    };
    const std::vector<Vec2> mine = shown(plot.series[i]);
    for (std::size_t other = 0; other < i && !mine.empty(); ++other)
        if (std::ranges::equal(mine, shown(plot.series[other]),
                               [](const Vec2& a, const Vec2& b) { return length(a - b) < 1; }))
            return other;
    return std::nullopt;
}

void draw_series(Plot& plot, std::size_t i) {
    const std::string over = lies_on(plot, i) ? " tp-over" : "";
    const PlotSeries& series = plot.series[i];
    std::vector<Vec2> path;
    std::vector<PlotShape> markers;
    for (const Vec2& point : series.points) {
        if (!plot.can_show(point)) continue;
        path.push_back(plot.pixel(point));
        markers.push_back(
            marker(i, path.back(),
                   series.name + ": " + rounded_text(point.x, 6) + " → " + rounded_text(point.y, 4)));
        markers.back().style += over;
    }
    // With a fit the fit is the line; without one the measurements are joined.
    const bool has_fit = plot.is_log() && series.fit && series.fit->constant > 0;
    if (has_fit) {
        const auto on_fit = [&](double x) {
            return plot.pixel({x, series.fit->constant * std::pow(x, -series.fit->order)});
        };
        const auto inside = clip_to_frame(plot, on_fit(plot.x.lo), on_fit(plot.x.hi));
        if (inside) {
            plot.shapes.push_back(line("tp-fit " + plot_series_class(i) + over, (*inside)[0], (*inside)[1]));
            take_line(plot, (*inside)[0], (*inside)[1]);
        }
    }
    if (!path.empty() && plot.params.joins_points)
        plot.shapes.push_back({PlotShape::Kind::kPath,
                               (has_fit ? "tp-join " : "tp-line ") + plot_series_class(i) + over, path});
    plot.shapes.insert(plot.shapes.end(), markers.begin(), markers.end());
}

/// The series in rows below the frame, as many to a row as fit.
void draw_legend(Plot& plot) {
    const double left = 10, right = plot.params.width - 10;
    Vec2 at(left, plot.y.first + kPlotBottom + kLegendRow - 6);
    for (std::size_t i = 0; i < plot.series.size(); ++i) {
        const PlotSeries& series = plot.series[i];
        const std::optional<std::size_t> below = lies_on(plot, i);
        std::string order = plot.is_log() && series.fit ? ": order " + fixed_text(series.fit->order, 2) : "";
        if (below) order = ": as " + plot.series[*below].name;
        const double most = right - left - kMarkerRoom - text_width(order, kLabelSize);
        const std::string entry = shortened_text(series.name, kLabelSize, most) + order;
        const double width = kMarkerRoom + text_width(entry, kLabelSize);
        if (at.x > left && at.x + width > right) at = {left, at.y + kLegendRow};
        plot.shapes.push_back(marker(i, {at.x + 7, at.y - 4}, ""));
        if (below) plot.shapes.back().style += " tp-over";
        plot.shapes.push_back(text("tp-entry", {at.x + 17, at.y}, "start", entry));
        at.x += width;
        plot.height = at.y + 8;
    }
}

void draw_left_out(Plot& plot) {
    std::size_t left_out = 0, shown = 0;
    for (const PlotSeries& series : plot.series)
        for (const Vec2& point : series.points) ++(plot.can_show(point) ? shown : left_out);
    if (shown == 0)
        plot.shapes.push_back(text("tp-label",
                                   {(plot.x.first + plot.x.last) / 2, (plot.y.first + plot.y.last) / 2},
                                   "middle", "nothing to draw"));
    if (left_out == 0) return;
    const std::string words =
        std::to_string(left_out) + (left_out == 1 ? " point" : " points") +
        " left out: " + (plot.is_log() ? "zero, negative or not a number" : "not a number");
    plot.shapes.push_back(text("tp-note", {10, plot.height + 8}, "start", words));
    plot.height += 16;
}

PlotDrawing draw(const PlotParams& params, std::span<const PlotSeries> series, ScaleKind kind) {
    std::vector<double> xs, ys;
    const PlotScale any{kind, 0, 1, 0, 1};
    for (const PlotSeries& one : series)
        for (const Vec2& point : one.points) {
            if (!any.can_show(point.x) || !any.can_show(point.y)) continue;
            xs.push_back(point.x);
            ys.push_back(point.y);
        }
    for (const PlotPlace& place : params.places)
        if (any.can_show(place.x)) xs.push_back(place.x);
    if (kind == ScaleKind::kLog && params.reference_orders && !ys.empty())
        ys.push_back(kReferenceLift * *std::max_element(ys.begin(), ys.end()));
    Plot plot{params, series, fit_scale(kind, xs), fit_scale(kind, ys), {}, {}, {}, 0};
    plot.x.first = kPlotLeft, plot.x.last = params.width - kPlotRight;
    plot.y.first = params.height - kPlotBottom, plot.y.last = params.subtitle.empty() ? 34 : 48;
    plot.height = params.height;

    draw_frame(plot);
    take_markers(plot);
    for (std::size_t i = 0; i < series.size(); ++i) draw_series(plot, i);
    if (plot.is_log() && params.reference_orders) draw_reference_orders(plot);
    draw_levels(plot);
    draw_places(plot);
    draw_legend(plot);
    draw_left_out(plot);

    return {static_cast<double>(params.width), plot.height, params.title, std::move(plot.shapes)};
}

}  // namespace

PlotDrawing draw_plot(const PlotParams& params, std::span<const PlotSeries> series) {
    return draw(params, series, params.is_linear ? ScaleKind::kLinear : ScaleKind::kLog);
}

std::string log_log_plot(const PlotParams& params, std::span<const PlotSeries> series) {
    return plot_svg(draw(params, series, ScaleKind::kLog));
}

std::string linear_plot(const PlotParams& params, std::span<const PlotSeries> series) {
    return plot_svg(draw(params, series, ScaleKind::kLinear));
}

}  // namespace trilens
