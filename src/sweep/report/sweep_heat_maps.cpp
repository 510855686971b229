#include "sweep/report/sweep_heat_maps.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>

#include "report/heat_map.h"
#include "sweep/report/plot_groups.h"

namespace trilens {
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

}  // namespace trilens
