// The order with which the errors of a sweep fall.
#include "sweep/fit_runs.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "measure/fit.h"

namespace trilens {
namespace {

constexpr double kMostLost = 0.1;  // share of an optic's pixels

const OpticDisplacement* find_displacement(const RunRecord& run, const std::string& layer,
                                           const std::string& optic) {
    for (const OpticDisplacement& one : run.displacement)
        if (one.layer == layer && one.optic == optic) return &one;
    return nullptr;
}

/// In either direction: a mean over what is left says little of the whole.
bool lost_too_many(const MetricValues& metrics) {
    const double lost = find_value(metrics, "disp_lost").value_or(0),
                 missing = find_value(metrics, "disp_missing").value_or(0),
                 found = find_value(metrics, "disp_pixels").value_or(0);
    return std::max(lost, missing) > kMostLost * (std::max(lost, missing) + found);
}

/// Fits the points gathered in `fit`; `usable` says which may take part.
void fit_points(SweepFit& fit, const std::vector<bool>& usable) {
    std::vector<FitPoint> points;
    for (std::size_t i = 0; i < fit.points.size(); ++i)
        points.push_back({static_cast<double>(fit.points[i].n),
                          usable[i] ? fit.points[i].value : std::numeric_limits<double>::quiet_NaN()});
    const std::optional<Fit> law = fit_power_law(points, {0, true});
    if (!law) return;
    for (std::size_t i = 0; i < fit.points.size(); ++i) fit.points[i].used = law->used[i];
    fit.order = law->order;
    fit.constant = law->constant;
    fit.r2 = law->r2;
    if (fit.layer.empty()) return;
    fit.n_for_1px = law->n_for_1;
    fit.n_for_half_px = law->n_for_half;
}

SweepFit fit_displacement(const std::vector<RunRecord>& runs, const OpticDisplacement& of,
                          const std::string& name) {
    SweepFit fit;
    fit.layer = of.layer, fit.optic = of.optic, fit.metric = name;
    std::vector<bool> usable;
    std::vector<std::optional<double>> coverage;
    for (const RunRecord& run : runs) {
        const OpticDisplacement* const one = find_displacement(run, of.layer, of.optic);
        const std::optional<double> value = one ? find_value(one->metrics, name) : std::nullopt;
        if (!value) continue;
        fit.points.push_back({run.plan.n, *value, false});
        usable.push_back(!lost_too_many(one->metrics));
        coverage.push_back(find_value(one->metrics, "disp_coverage"));
    }
    fit_points(fit, usable);
    for (std::size_t i = 0; i < fit.points.size(); ++i)
        if (fit.points[i].used && coverage[i])
            fit.coverage = std::min(fit.coverage.value_or(1), *coverage[i]);
    return fit;
}

}  // namespace

std::vector<SweepFit> fit_runs(const std::vector<RunRecord>& runs) {
    std::vector<SweepFit> fits;
    for (const RunRecord& run : runs)
        for (const OpticDisplacement& one : run.displacement)
            for (const char* name : {"disp_mean_px", "disp_mean_off_folds_px", "disp_p50_px", "disp_p95_px"})
                if (!find_fit(fits, one.layer, one.optic, name))
                    fits.push_back(fit_displacement(runs, one, name));

    SweepFit colour;
    colour.optic = "all", colour.metric = "rgb_rmse";
    for (const RunRecord& run : runs)
        if (const std::optional<double> value = find_value(run.metrics, colour.metric))
            colour.points.push_back({run.plan.n, *value, false});
    fit_points(colour, std::vector<bool>(colour.points.size(), true));
    if (!colour.points.empty()) fits.push_back(colour);
    return fits;
}

const SweepFit* find_fit(const std::vector<SweepFit>& fits, const std::string& layer,
                         const std::string& optic, const std::string& metric_name) {
    const auto found = std::find_if(fits.begin(), fits.end(), [&](const SweepFit& fit) {
        return fit.layer == layer && fit.optic == optic && fit.metric == metric_name;
    });
    return found == fits.end() ? nullptr : &*found;
}

const SweepFit* find_fit_off_folds(const std::vector<SweepFit>& fits, const std::string& layer,
                                   const std::string& optic) {
    const SweepFit* const all = find_fit(fits, layer, optic, "disp_mean_px");
    const SweepFit* const off = find_fit(fits, layer, optic, "disp_mean_off_folds_px");
    if (!all || !off) return nullptr;
    const auto is_same = [](const SweepPoint& a, const SweepPoint& b) {
        return a.n == b.n && a.value == b.value;
    };
    return std::ranges::equal(all->points, off->points, is_same) ? nullptr : off;
}

PlotSeries plot_series(const SweepFit& fit, const std::string& name) {
    PlotSeries series{name, {}, std::nullopt};
    for (const SweepPoint& point : fit.points) series.points.push_back({point.n, point.value});
    if (fit.order && fit.constant) series.fit = PlotFit{*fit.order, *fit.constant};
    return series;
}

}  // namespace trilens
