// The order with which the errors of a sweep fall.
#pragma once

#include <string>
#include <vector>

#include "report/plot.h"
#include "sweep/store/results.h"

namespace trilens {

/// The axis along which errors are fitted: the resolution where it is one, else the first whose errors follow
/// a power (AxisKind::is_scale), else the first of numbers; null where there is none.
const Axis* ordering_axis(const SweepAxes& axes);

/// The runs in the order of the plan, those of one group together: all that differ along the ordering axis
/// alone (zipped axes of numbers differ with it). Without an ordering axis each run is a group.
struct RunGroup {
    Coordinates at;  // what its runs have in common
    std::vector<const RunRecord*> runs;
};
std::vector<RunGroup> group_runs(const SweepAxes& axes, const std::vector<RunRecord>& runs);

/// Fits error = constant * n^-order to the finished runs of each group, n along the ordering axis: mean and
/// 95 % displacement per layer and optic, and the RMSE of RGB; in the order in which the runs name them,
/// "all" optics first. Metrics whose points allow no fit come without an order. Left out of a fit: values
/// that are not finite and positive; displacements of runs that lost more than a tenth of their pixels,
/// because what could be found says little about what was lost; and a plateau at the fine end. None without
/// an ordering axis.
std::vector<SweepFit> fit_runs(const SweepAxes& axes, const std::vector<RunRecord>& runs);

/// The first fit of this metric, or nullptr; of a group where one is given.
const SweepFit* find_fit(const std::vector<SweepFit>& fits, const std::string& layer,
                         const std::string& optic, const std::string& metric,
                         const Coordinates* group = nullptr);

/// The fit of the mean off the folds (measure/field/folds.h); nullptr where it says no more than that
/// of the mean, because no run found a pixel near a fold.
const SweepFit* find_fit_off_folds(const std::vector<SweepFit>& fits, const std::string& layer,
                                   const std::string& optic, const Coordinates* group = nullptr);

/// The fit's points and line for a plot.
PlotSeries plot_series(const SweepFit& fit, const std::string& name);

}  // namespace trilens
