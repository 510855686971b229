#include "sweep/report/sweep_report.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "report/plot.h"
#include "report/text.h"

namespace trilens {

// The plots of a sweep: error along its axes, and what accuracy costs.

namespace {

constexpr const char* kAll = "all";
constexpr double kMostByOthers = 0.1;  // share of the machine that other work may take of a measured time

bool can_show(const SweepFit& fit) {
    return std::any_of(fit.points.begin(), fit.points.end(),
                       [](const SweepPoint& point) { return std::isfinite(point.value) && point.value > 0; });
}

/// What the plots of one sweep have in common.
struct Plots {
    const SweepSummary& summary;
    const Axis* along;  // null: no axis of numbers
    std::vector<PlotGroups> pages;
    std::vector<NamedPlot> plots = {};

    bool has_one_group() const { return pages.size() == 1 && pages[0].groups.size() == 1; }

    PlotParams params(const std::string& title, const std::string& y_label, const PlotGroups& page) const {
        PlotParams params;
        params.title = title;
        params.subtitle = page.title;
        params.x_label = along->kind.label;
        params.y_label = y_label;
        params.ticks_at_points = true;
        params.is_linear = !along->kind.is_scale;
        return params;
    }
    void add(const std::string& name, const PlotParams& params, const std::vector<PlotSeries>& series) {
        if (!series.empty()) plots.push_back({name, draw_plot(params, series)});
    }
};

/// One line per optic; "all" only where it says more than the one optic does.
std::vector<PlotSeries> optic_lines(const SweepSummary& summary, const std::string& layer,
                                    const std::string& metric) {
    const bool is_mean = metric == "disp_mean_px";
    std::vector<const SweepFit*> fits;
    for (const SweepFit& fit : summary.fits)
        if (fit.layer == layer && fit.metric == metric) fits.push_back(&fit);
    std::vector<PlotSeries> series;
    for (const SweepFit* fit : fits)
        if (can_show(*fit) && (fits.size() != 2 || fit->optic != kAll)) {
            series.push_back(plot_series(*fit, fit->optic));
            const SweepFit* const off =
                is_mean ? find_fit_off_folds(summary.fits, layer, fit->optic) : nullptr;
            if (off) series.push_back(plot_series(*off, fit->optic + ", off folds"));
        }
    return series;
}

std::vector<PlotSeries> group_lines(const SweepSummary& summary, const PlotGroups& page,
                                    const std::string& layer, const std::string& metric) {
    std::vector<PlotSeries> series;
    for (const PlotGroup& group : page.groups) {
        const SweepFit* const fit = find_fit(summary.fits, layer, kAll, metric, &group.at);
        if (fit && can_show(*fit)) series.push_back(plot_series(*fit, group.name));
    }
    return series;
}

void add_displacement(Plots& plots, const std::string& layer, const std::string& metric) {
    const bool is_mean = metric == "disp_mean_px";
    for (const PlotGroups& page : plots.pages) {
        PlotParams params = plots.params(
            std::string(is_mean ? "Mean" : "95 %") + " displacement of " + what_layer_shows(layer),
            is_mean ? "mean displacement [px]" : "95 % of pixels within [px]", page);
        params.subtitle =
            (page.title.empty() ? "of the pixels that were measured: " : page.title + "; measured: ") +
            measured_range(plots.summary, layer);
        params.levels = {{1, "1 px"}, {0.5, "0.5 px"}};
        plots.add(layer + "_" + metric + page.file, params,
                  plots.has_one_group() ? optic_lines(plots.summary, layer, metric)
                                        : group_lines(plots.summary, page, layer, metric));
    }
}

void add_colour(Plots& plots) {
    for (const PlotGroups& page : plots.pages) {
        std::vector<PlotSeries> series = group_lines(plots.summary, page, "", "rgb_rmse");
        if (plots.has_one_group() && !series.empty()) series[0].name = "RGB";
        plots.add("rgb_rmse" + page.file,
                  plots.params("Colour error of the whole picture", "RMSE of RGB [linear Rec.709]", page),
                  series);
    }
}

/// What tracing the truths of these runs took, the median; none where nothing says so.
std::optional<double> tracer_seconds(const PlotGroups& page) {
    std::vector<double> seconds;
    for (const PlotGroup& group : page.groups)
        for (const RunRecord* run : group.runs)
            if (const auto one = find_value(run->metrics, "t_trace_s"); one && *one > 0)
                seconds.push_back(*one);
    if (seconds.empty()) return std::nullopt;
    const auto middle = seconds.begin() + static_cast<std::ptrdiff_t>(seconds.size() / 2);
    std::ranges::nth_element(seconds, middle);
    return *middle;
}

/// Error over time of the runs whose time may be believed; of all where none may, which the plot says.
void add_time(Plots& plots, const std::string& layer, bool is_only_layer) {
    const auto is_measured = [](const RunRecord& run) {
        return run.state == RunState::kDone && is_timed_alone(run);
    };
    const bool has_measured = std::ranges::any_of(plots.summary.runs, is_measured);
    std::size_t left_out = 0;
    for (const PlotGroups& page : plots.pages) {
        std::vector<PlotSeries> series;
        for (const PlotGroup& group : page.groups) {
            PlotSeries one{plots.has_one_group() ? layer : group.name, {}, std::nullopt};
            for (const RunRecord* run : group.runs) {
                const MetricValues* const all = find_displacement(*run, layer, kAll);
                const auto seconds = find_value(run->metrics, "t_total_s"),
                           error = all ? find_value(*all, "disp_mean_px") : std::nullopt;
                if (!seconds || !error || !(*error > 0)) continue;
                if (has_measured && !is_measured(*run)) ++left_out;
                if (!has_measured || is_measured(*run)) one.points.push_back({*seconds, *error});
            }
            if (!one.points.empty()) series.push_back(one);
        }
        PlotParams params;
        params.title = page.title.empty() ? "What accuracy costs" : "Cost: " + page.title;
        if (!is_only_layer) params.title += ", " + what_layer_shows(layer);
        if (const std::optional<double> traced = tracer_seconds(page))
            params.places = {{*traced, "ray tracing"}};
        params.subtitle = !has_measured  ? "no measurement: the machine was shared"
                          : left_out > 0 ? std::to_string(left_out) + " runs left out: the machine was shared"
                                         : "displacement of the pixels that were measured";
        params.x_label = "time per picture [s]";
        params.y_label = "mean displacement [px]";
        params.reference_orders = false;
        params.levels = {{1, "1 px"}, {0.5, "0.5 px"}};
        plots.add((is_only_layer ? "time" : "time_" + layer) + page.file, params, series);
    }
}

}  // namespace

bool is_timed_alone(const RunRecord& run) {
    return find_value(run.metrics, "jobs").value_or(1) <= 1 &&
           find_value(run.metrics, "machine_used_by_others").value_or(0) <= kMostByOthers;
}

std::vector<std::string> layers_of(const SweepSummary& summary) {
    std::vector<std::string> layers;
    for (const RunRecord& run : summary.runs)
        for (const OpticDisplacement& one : run.displacement)
            if (std::find(layers.begin(), layers.end(), one.layer) == layers.end())
                layers.push_back(one.layer);
    return layers;
}

std::string percent_text(double share) {
    const double percent = 100 * share;
    const bool is_rounded_up = share < 1 && percent >= 99.95, is_rounded_down = share > 0 && percent < 0.05;
    return is_rounded_up ? "> 99.9 %" : is_rounded_down ? "< 0.1 %" : rounded_text(percent, 3) + " %";
}

std::string measured_range(const SweepSummary& summary, const std::string& layer) {
    std::optional<double> least, most;
    for (const RunRecord& run : summary.runs)
        for (const OpticDisplacement& one : run.displacement) {
            const std::optional<double> share = find_value(one.metrics, "disp_coverage");
            if (one.layer != layer || one.optic != kAll || !share) continue;
            least = std::min(least.value_or(1), *share);
            most = std::max(most.value_or(0), *share);
        }
    if (!least) return "nothing";
    const std::string low = percent_text(*least), high = percent_text(*most);
    return low == high ? low : low + " to " + high;
}

std::string measured_text(const MetricValues& metrics) {
    const std::optional<double> share = find_value(metrics, "disp_coverage");
    if (!share) return "not known";
    return percent_text(*share) + ", " + fixed_text(find_value(metrics, "disp_lost").value_or(0), 0) +
           " px lost, " + fixed_text(find_value(metrics, "disp_missing").value_or(0), 0) + " px missing, " +
           fixed_text(find_value(metrics, "disp_unmeasured").value_or(0), 0) + " px unmeasured";
}

bool is_exact(const SweepFit& fit) {
    return !fit.points.empty() && std::all_of(fit.points.begin(), fit.points.end(),
                                              [](const SweepPoint& p) { return p.value == 0; });
}

std::string what_layer_shows(const std::string& layer) {
    return layer == "reflect" ? "what mirrors show" : layer == "refract" ? "what glass shows" : layer;
}

std::vector<NamedPlot> make_plots(const SweepSummary& summary) {
    const SweepAxes& axes = summary.manifest.axes;
    Plots plots{summary, ordering_axis(axes), plot_groups(group_runs(axes, summary.runs))};
    if (plots.pages.size() > kMostPlotsOfAKind) plots.pages.resize(kMostPlotsOfAKind);
    const std::vector<std::string> layers = layers_of(summary);
    // Where there are many plots, the maps are the view of all.
    const auto add_maps = [&] {
        for (const std::string& layer : layers)
            for (NamedPlot& map : make_heat_maps(summary, layer)) plots.plots.push_back(std::move(map));
    };
    const bool has_many = plots.pages.size() > 4;
    if (has_many) add_maps();
    if (plots.along) {
        for (const std::string& layer : layers)
            for (const char* metric : {"disp_mean_px", "disp_p95_px"}) add_displacement(plots, layer, metric);
        add_colour(plots);
    }
    for (const std::string& layer : layers) add_time(plots, layer, layers.size() == 1);
    if (!has_many) add_maps();
    return std::move(plots.plots);
}

namespace {

std::vector<const Axis*> axes_of_numbers(const SweepAxes& axes) {
    std::vector<const Axis*> found;
    for (const Axis& axis : axes.axes)
        if (axis.values.size() > 1 &&
            std::ranges::all_of(axis.values, [](const AxisValue& value) { return value.number.has_value(); }))
            found.push_back(&axis);
    return found;
}

std::vector<std::string> texts(const Axis& axis) {
    std::vector<std::string> all;
    for (const AxisValue& value : axis.values) all.push_back(value.text);
    return all;
}

/// The place of the run's value among those of the axis.
std::size_t place_of(const RunRecord& run, const Axis& axis) {
    const AxisValue* const value = find_coordinate(run.plan.at, axis.kind.name);
    const auto found = std::ranges::find_if(
        axis.values, [&](const AxisValue& known) { return value && known.text == value->text; });
    return static_cast<std::size_t>(found - axis.values.begin());
}

}  // namespace

std::vector<NamedPlot> make_heat_maps(const SweepSummary& summary, const std::string& layer) {
    const std::vector<const Axis*> axes = axes_of_numbers(summary.manifest.axes);
    if (summary.manifest.axes.zip || axes.size() < 2) return {};
    const Axis &x = *axes[0], &y = *axes[1];
    std::map<std::string, HeatMapParams> maps;
    std::vector<std::string> order;
    for (const RunRecord& run : summary.runs) {
        const std::string rest =
            point_text(without_axis(without_axis(run.plan.at, x.kind.name), y.kind.name));
        const auto [known, is_new] = maps.emplace(rest, HeatMapParams());
        HeatMapParams& map = known->second;
        if (is_new) {
            order.push_back(rest);
            map = {"Mean displacement of " + what_layer_shows(layer),
                   (rest.empty() ? "" : rest + "; ") + "measured: " + measured_range(summary, layer),
                   x.kind.label,
                   y.kind.label,
                   "mean displacement [px]",
                   texts(x),
                   texts(y),
                   std::vector<double>(x.values.size() * y.values.size(), NAN)};
        }
        const MetricValues* const all = find_displacement(run, layer, "all");
        const auto mean = all ? find_value(*all, "disp_mean_px") : std::nullopt;
        const std::size_t column = place_of(run, x), row = place_of(run, y);
        if (mean && column < x.values.size() && row < y.values.size())
            map.values[row * x.values.size() + column] = *mean;
    }
    std::vector<NamedPlot> plots;
    for (const std::string& rest : order) {
        const HeatMapParams& map = maps.at(rest);
        if (std::ranges::none_of(map.values, [](double value) { return value > 0; })) continue;
        if (plots.size() == kMostPlotsOfAKind) break;
        const std::string number = plots.empty() ? "" : "_" + std::to_string(plots.size() + 1);
        plots.push_back({layer + "_map" + number, draw_heat_map(map)});
    }
    return plots;
}

namespace {

constexpr std::size_t kMostLines = 8;

/// A word speaks for itself, a number needs its axis.
std::string words_of(const Coordinates& point) {
    std::string text;
    for (const Coordinate& one : point)
        text += (text.empty() ? "" : ", ") + (one.value.number ? point_text({one}) : one.value.text);
    return text;
}

/// The names of the axes, from the last on, whose combinations are few enough for one plot; an axis with too
/// many values is passed over.
std::set<std::string> line_axes(const std::vector<RunGroup>& groups) {
    std::set<std::string> lines;
    if (groups.empty()) return lines;
    const Coordinates& pattern = groups[0].at;
    for (std::size_t i = pattern.size(); i-- > 0;) {
        std::set<std::string> longer = lines;
        longer.insert(pattern[i].axis);
        std::map<std::string, std::set<std::string>> by_plot;
        for (const RunGroup& group : groups) {
            Coordinates inner = group.at, outer = group.at;
            std::erase_if(inner, [&](const Coordinate& one) { return longer.count(one.axis) == 0; });
            std::erase_if(outer, [&](const Coordinate& one) { return longer.count(one.axis) > 0; });
            by_plot[point_text(outer)].insert(point_text(inner));
        }
        const bool is_few =
            std::ranges::all_of(by_plot, [](const auto& plot) { return plot.second.size() <= kMostLines; });
        if (is_few) lines = longer;
    }
    return lines;
}

std::string file_end(const Coordinates& outer) {
    std::string name;
    for (const Coordinate& one : outer)
        for (const char c : "_" + one.value.text)
            name += std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '.' ? c : '-';
    return name;
}

}  // namespace

std::vector<PlotGroups> plot_groups(const std::vector<RunGroup>& groups) {
    const std::set<std::string> lines = line_axes(groups);
    std::vector<PlotGroups> plots;
    std::map<std::string, std::size_t> known;
    for (const RunGroup& group : groups) {
        Coordinates inner = group.at, outer = group.at;
        std::erase_if(inner, [&](const Coordinate& one) { return lines.count(one.axis) == 0; });
        std::erase_if(outer, [&](const Coordinate& one) { return lines.count(one.axis) > 0; });
        const auto [place, is_new] = known.emplace(point_text(outer), plots.size());
        if (is_new) plots.push_back({words_of(outer), file_end(outer), {}});
        const std::string name = words_of(inner);
        plots[place->second].groups.push_back({name.empty() ? "all" : name, group.at, group.runs});
    }
    // Two plots of one file's name: told apart by number.
    std::map<std::string, int> uses;
    for (PlotGroups& plot : plots)
        if (const int use = uses[plot.file]++; use > 0) plot.file += "-" + std::to_string(use + 1);
    return plots;
}

const MetricValues* find_displacement(const RunRecord& run, const std::string& layer,
                                      const std::string& optic) {
    for (const OpticDisplacement& one : run.displacement)
        if (one.layer == layer && one.optic == optic) return &one.metrics;
    return nullptr;
}

}  // namespace trilens
