// The order with which the errors of a sweep fall.
#pragma once

#include <string>
#include <vector>

#include "report/plot.h"
#include "sweep/results.h"

namespace trilens {

/// Fits error = constant * n^-order to the finished runs: mean and 95 % displacement per layer and optic, and
/// the RMSE of RGB; in the order in which the runs name them, "all" optics first. MetricValues whose points
/// allow no fit come without an order. Left out of a fit: values that are not finite and positive;
/// displacements of runs that lost more than a tenth of their pixels, because what could be found says little
/// about what was lost; and a plateau at the fine end.
std::vector<SweepFit> fit_runs(const std::vector<RunRecord>& runs);

/// The fit of this metric, or nullptr.
const SweepFit* find_fit(const std::vector<SweepFit>& fits, const std::string& layer,
                         const std::string& optic, const std::string& metric);

/// The fit of the mean off the folds (measure/folds.h); nullptr where it says no more than that of the mean,
/// because no run found a pixel near a fold.
const SweepFit* find_fit_off_folds(const std::vector<SweepFit>& fits, const std::string& layer,
                                   const std::string& optic);

/// The fit's points and line for a plot.
PlotSeries plot_series(const SweepFit& fit, const std::string& name);

}  // namespace trilens
