// The order with which the errors of a sweep fall.
#include "sweep/report/sweep_report.h"

#include <algorithm>
#include <limits>
#include <map>
#include <utility>

#include "measure/common/statistics.h"

namespace trilens {
namespace {

constexpr double kMostLost = 0.1;  // share of an optic's pixels

const OpticDisplacement* find_optic_displacement(const RunRecord& run, const std::string& layer,
                                                 const std::string& optic) {
    for (const OpticDisplacement& one : run.displacement)
        if (one.layer == layer && one.optic == optic) return &one;
    return nullptr;
}

/// In either direction, and with what is unmeasured: a mean over what is left says little of the whole.
bool lost_too_many(const MetricValues& metrics) {
    const double lost = find_value(metrics, "disp_lost").value_or(0) +
                        find_value(metrics, "disp_unmeasured").value_or(0),
                 missing = find_value(metrics, "disp_missing").value_or(0),
                 found = find_value(metrics, "disp_pixels").value_or(0);
    return std::max(lost, missing) > kMostLost * (std::max(lost, missing) + found);
}

/// Where the run stands along the axis.
double place_of(const RunRecord& run, const std::string& axis) {
    const AxisValue* const value = find_coordinate(run.plan.at, axis);
    return value && value->number ? *value->number : std::numeric_limits<double>::quiet_NaN();
}

/// Fits the points gathered in `fit`; `usable` says which may take part.
void fit_points(SweepFit& fit, const std::vector<bool>& usable) {
    std::vector<FitPoint> points;
    for (std::size_t i = 0; i < fit.points.size(); ++i)
        points.push_back(
            {fit.points[i].n, usable[i] ? fit.points[i].value : std::numeric_limits<double>::quiet_NaN()});
    const std::optional<Fit> law = fit_power_law(points, {0, true});
    if (!law) return;
    for (std::size_t i = 0; i < fit.points.size(); ++i) fit.points[i].used = law->used[i];
    fit.order = law->order;
    fit.constant = law->constant;
    fit.r2 = law->r2;
    fit.order_low = law->order_low;
    fit.order_high = law->order_high;
    if (fit.layer.empty() || fit.axis != "resolution") return;
    fit.n_for_1px = law->n_for_1;
    fit.n_for_half_px = law->n_for_half;
}

SweepFit empty_fit(const std::string& axis, const RunGroup& group) {
    SweepFit fit;
    fit.axis = axis;
    fit.group = group.at;
    fit.optic = "all";
    return fit;
}

SweepFit fit_displacement(SweepFit fit, const RunGroup& group, bool is_scale) {
    std::vector<bool> usable;
    std::vector<std::optional<double>> coverage;
    for (const RunRecord* run : group.runs) {
        const OpticDisplacement* const one = find_optic_displacement(*run, fit.layer, fit.optic);
        const std::optional<double> value = one ? find_value(one->metrics, fit.metric) : std::nullopt;
        if (!value) continue;
        fit.points.push_back({place_of(*run, fit.axis), *value, false});
        usable.push_back(!lost_too_many(one->metrics));
        coverage.push_back(find_value(one->metrics, "disp_coverage"));
    }
    if (is_scale) fit_points(fit, usable);
    for (std::size_t i = 0; i < fit.points.size(); ++i)
        if (fit.points[i].used && coverage[i])
            fit.coverage = std::min(fit.coverage.value_or(1), *coverage[i]);
    return fit;
}

void fit_group(const AxisKind& along, const RunGroup& group, std::vector<SweepFit>& fits) {
    const std::string& axis = along.name;
    std::vector<SweepFit> found;
    for (const RunRecord* run : group.runs)
        for (const OpticDisplacement& one : run->displacement)
            for (const char* name :
                 {"disp_mean_px", "disp_mean_off_folds_px", "disp_p50_px", "disp_p95_px"}) {
                if (find_fit(found, one.layer, one.optic, name)) continue;
                SweepFit fit = empty_fit(axis, group);
                fit.layer = one.layer, fit.optic = one.optic, fit.metric = name;
                found.push_back(fit_displacement(std::move(fit), group, along.is_scale));
            }
    SweepFit colour = empty_fit(axis, group);
    colour.metric = "rgb_rmse";
    for (const RunRecord* run : group.runs)
        if (const std::optional<double> value = find_value(run->metrics, colour.metric))
            colour.points.push_back({place_of(*run, axis), *value, false});
    if (along.is_scale) fit_points(colour, std::vector<bool>(colour.points.size(), true));
    if (!colour.points.empty()) found.push_back(colour);
    fits.insert(fits.end(), found.begin(), found.end());
}

bool has_numbers(const Axis& axis) {
    return std::ranges::all_of(axis.values, [](const AxisValue& value) { return value.number.has_value(); });
}

}  // namespace

const Axis* ordering_axis(const SweepAxes& axes) {
    for (const Axis& axis : axes.axes)
        if (axis.kind.name == "resolution") return &axis;
    for (const Axis& axis : axes.axes)
        if (axis.kind.is_scale) return &axis;
    for (const Axis& axis : axes.axes)
        if (has_numbers(axis)) return &axis;
    return nullptr;
}

std::vector<RunGroup> group_runs(const SweepAxes& axes, const std::vector<RunRecord>& runs) {
    const Axis* const along = ordering_axis(axes);
    std::map<std::string, std::size_t> known;
    std::vector<RunGroup> groups;
    for (const RunRecord& run : runs) {
        Coordinates at = run.plan.at;
        if (along) at = without_axis(std::move(at), along->kind.name);
        if (along && axes.zip)
            for (const Axis& axis : axes.axes)
                if (has_numbers(axis)) at = without_axis(std::move(at), axis.kind.name);
        const auto [place, is_new] = known.emplace(point_text(at), groups.size());
        if (is_new) groups.push_back({at, {}});
        groups[place->second].runs.push_back(&run);
    }
    return groups;
}

std::vector<SweepFit> fit_runs(const SweepAxes& axes, const std::vector<RunRecord>& runs) {
    std::vector<SweepFit> fits;
    const Axis* const along = ordering_axis(axes);
    if (!along) return fits;
    for (const RunGroup& group : group_runs(axes, runs)) fit_group(along->kind, group, fits);
    return fits;
}

const SweepFit* find_fit(const std::vector<SweepFit>& fits, const std::string& layer,
                         const std::string& optic, const std::string& metric_name, const Coordinates* group) {
    const auto found = std::find_if(fits.begin(), fits.end(), [&](const SweepFit& fit) {
        return fit.layer == layer && fit.optic == optic && fit.metric == metric_name &&
               (!group || fit.group == *group);
    });
    return found == fits.end() ? nullptr : &*found;
}

const SweepFit* find_fit_off_folds(const std::vector<SweepFit>& fits, const std::string& layer,
                                   const std::string& optic, const Coordinates* group) {
    const SweepFit* const all = find_fit(fits, layer, optic, "disp_mean_px", group);
    const SweepFit* const off = find_fit(fits, layer, optic, "disp_mean_off_folds_px", group);
    if (!all || !off) return nullptr;
    const auto is_same = [](const SweepPoint& a, const SweepPoint& b) {
        return a.n == b.n && a.value == b.value;
    };
    return std::ranges::equal(all->points, off->points, is_same) ? nullptr : off;
}

PlotSeries plot_series(const SweepFit& fit, const std::string& name) {
    PlotSeries series{name, {}, std::nullopt};
    for (const SweepPoint& point : fit.points) series.points.push_back({point.n, point.value});
    std::ranges::stable_sort(series.points, {}, &Vec2::x);
    if (fit.order && fit.constant) series.fit = PlotFit{*fit.order, *fit.constant};
    return series;
}

}  // namespace trilens
