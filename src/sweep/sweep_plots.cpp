// The plots of a sweep: error over resolution, and what accuracy costs.
#include "sweep/sweep_plots.h"

#include <algorithm>
#include <optional>

#include "report/plot.h"
#include "sweep/fit_runs.h"

namespace trilens {
namespace {

constexpr const char* kAll = "all";
constexpr const char* kResolutionLabel = "resolution n [n × n facets per cage face]";

// --------------------------------------------------------------------------------------------------------

/// One line per optic; "all" only where it says more than the one optic does.
NamedPlot displacement_plot(const SweepSummary& summary, const std::string& layer,
                            const std::string& metric) {
    const bool is_mean = metric == "disp_mean_px";
    std::vector<const SweepFit*> fits;
    for (const SweepFit& fit : summary.fits)
        if (fit.layer == layer && fit.metric == metric) fits.push_back(&fit);
    std::vector<PlotSeries> series;
    for (const SweepFit* fit : fits)
        if (fits.size() != 2 || fit->optic != kAll) {
            series.push_back(plot_series(*fit, fit->optic));
            const SweepFit* const off =
                is_mean ? find_fit_off_folds(summary.fits, layer, fit->optic) : nullptr;
            if (off) series.push_back(plot_series(*off, fit->optic + ", off folds"));
        }

    PlotParams params;
    params.title = std::string(is_mean ? "Mean" : "95 %") + " displacement of " + what_layer_shows(layer);
    params.x_label = kResolutionLabel;
    params.y_label = is_mean ? "mean displacement [px]" : "95 % of pixels within [px]";
    params.levels = {{1, "1 px"}, {0.5, "0.5 px"}};
    return {layer + "_" + metric, log_log_plot(params, series)};
}

NamedPlot colour_plot(const SweepFit& fit) {
    PlotParams params;
    params.title = "Colour error of the whole picture";
    params.x_label = kResolutionLabel;
    params.y_label = "RMSE of RGB [linear Rec.709]";
    return {"rgb_rmse", log_log_plot(params, std::vector<PlotSeries>{plot_series(fit, "RGB")})};
}

NamedPlot time_plot(const SweepSummary& summary, const std::vector<std::string>& layers) {
    std::vector<PlotSeries> series;
    for (const std::string& layer : layers) {
        PlotSeries one{layer, {}, std::nullopt};
        for (const RunRecord& run : summary.runs)
            for (const OpticDisplacement& displacement : run.displacement) {
                const std::optional<double> seconds = find_value(run.metrics, "t_total_s");
                const std::optional<double> error = find_value(displacement.metrics, "disp_mean_px");
                if (displacement.layer == layer && displacement.optic == kAll && seconds && error)
                    one.points.push_back({*seconds, *error});
            }
        series.push_back(one);
    }
    PlotParams params;
    params.title = "What accuracy costs";
    params.x_label = "time per picture [s]";
    params.y_label = "mean displacement [px]";
    params.reference_orders = false;
    params.levels = {{1, "1 px"}, {0.5, "0.5 px"}};
    return {"time", log_log_plot(params, series)};
}

}  // namespace

std::vector<std::string> layers_of(const SweepSummary& summary) {
    std::vector<std::string> layers;
    for (const SweepFit& fit : summary.fits)
        if (!fit.layer.empty() && std::find(layers.begin(), layers.end(), fit.layer) == layers.end())
            layers.push_back(fit.layer);
    return layers;
}

std::string what_layer_shows(const std::string& layer) {
    return layer == "reflect" ? "what mirrors show" : layer == "refract" ? "what glass shows" : layer;
}

std::vector<NamedPlot> make_plots(const SweepSummary& summary) {
    std::vector<NamedPlot> plots;
    const std::vector<std::string> layers = layers_of(summary);
    for (const std::string& layer : layers)
        for (const char* metric : {"disp_mean_px", "disp_p95_px"})
            plots.push_back(displacement_plot(summary, layer, metric));
    if (const SweepFit* fit = find_fit(summary.fits, "", kAll, "rgb_rmse"))
        plots.push_back(colour_plot(*fit));
    if (!layers.empty()) plots.push_back(time_plot(summary, layers));
    return plots;
}

}  // namespace trilens
