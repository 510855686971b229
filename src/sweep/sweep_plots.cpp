// The plots of a sweep: error over resolution, and what accuracy costs.
#include "sweep/sweep_plots.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "report/plot.h"
#include "report/text.h"
#include "sweep/fit_runs.h"

namespace trilens {
namespace {

constexpr const char* kAll = "all";
constexpr const char* kResolutionLabel = "resolution n [n × n facets per cage face]";

bool can_show(const SweepFit& fit) {
    return std::any_of(fit.points.begin(), fit.points.end(),
                       [](const SweepPoint& point) { return std::isfinite(point.value) && point.value > 0; });
}

/// One line per optic; "all" only where it says more than the one optic does.
std::optional<NamedPlot> displacement_plot(const SweepSummary& summary, const std::string& layer,
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

    PlotParams params;
    params.title = std::string(is_mean ? "Mean" : "95 %") + " displacement of " + what_layer_shows(layer);
    params.subtitle = "of the pixels that were measured: " + measured_range(summary, layer);
    params.ticks_at_points = true;
    params.x_label = kResolutionLabel;
    params.y_label = is_mean ? "mean displacement [px]" : "95 % of pixels within [px]";
    params.levels = {{1, "1 px"}, {0.5, "0.5 px"}};
    if (series.empty()) return std::nullopt;
    return NamedPlot{layer + "_" + metric, log_log_plot(params, series)};
}

NamedPlot colour_plot(const SweepFit& fit) {
    PlotParams params;
    params.title = "Colour error of the whole picture";
    params.x_label = kResolutionLabel;
    params.y_label = "RMSE of RGB [linear Rec.709]";
    params.ticks_at_points = true;
    return {"rgb_rmse", log_log_plot(params, std::vector<PlotSeries>{plot_series(fit, "RGB")})};
}

std::optional<NamedPlot> time_plot(const SweepSummary& summary, const std::vector<std::string>& layers) {
    std::vector<PlotSeries> series;
    for (const std::string& layer : layers) {
        PlotSeries one{layer, {}, std::nullopt};
        for (const RunRecord& run : summary.runs)
            for (const OpticDisplacement& displacement : run.displacement) {
                const std::optional<double> seconds = find_value(run.metrics, "t_total_s");
                const std::optional<double> error = find_value(displacement.metrics, "disp_mean_px");
                if (displacement.layer == layer && displacement.optic == kAll && seconds && error &&
                    *error > 0)
                    one.points.push_back({*seconds, *error});
            }
        if (!one.points.empty()) series.push_back(one);
    }
    if (series.empty()) return std::nullopt;
    PlotParams params;
    params.title = "What accuracy costs";
    params.subtitle = "displacement of the pixels that were measured";
    params.x_label = "time per picture [s]";
    params.y_label = "mean displacement [px]";
    params.reference_orders = false;
    params.levels = {{1, "1 px"}, {0.5, "0.5 px"}};
    return NamedPlot{"time", log_log_plot(params, series)};
}

}  // namespace

std::vector<std::string> layers_of(const SweepSummary& summary) {
    std::vector<std::string> layers;
    for (const SweepFit& fit : summary.fits)
        if (!fit.layer.empty() && std::find(layers.begin(), layers.end(), fit.layer) == layers.end())
            layers.push_back(fit.layer);
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
           " px lost, " + fixed_text(find_value(metrics, "disp_missing").value_or(0), 0) + " px missing";
}

bool is_exact(const SweepFit& fit) {
    return !fit.points.empty() && std::all_of(fit.points.begin(), fit.points.end(),
                                              [](const SweepPoint& p) { return p.value == 0; });
}

std::string what_layer_shows(const std::string& layer) {
    return layer == "reflect" ? "what mirrors show" : layer == "refract" ? "what glass shows" : layer;
}

std::vector<NamedPlot> make_plots(const SweepSummary& summary) {
    std::vector<NamedPlot> plots;
    const std::vector<std::string> layers = layers_of(summary);
    for (const std::string& layer : layers)
        for (const char* metric : {"disp_mean_px", "disp_p95_px"})
            if (std::optional<NamedPlot> plot = displacement_plot(summary, layer, metric))
                plots.push_back(std::move(*plot));
    if (const SweepFit* fit = find_fit(summary.fits, "", kAll, "rgb_rmse"); fit && can_show(*fit))
        plots.push_back(colour_plot(*fit));
    if (std::optional<NamedPlot> plot = time_plot(summary, layers)) plots.push_back(std::move(*plot));
    return plots;
}

}  // namespace trilens
