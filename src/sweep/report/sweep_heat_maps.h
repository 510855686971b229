// Maps of a sweep's error over two axes of numbers.
#pragma once

#include <string>
#include <vector>

#include "sweep/report/sweep_plots.h"
#include "sweep/store/results.h"

namespace trilens {

/// The mean displacement of what a layer shows over the first two axes of numbers with at least two values,
/// one map per combination of the other axes (at most kMostPlotsOfAKind); none where there are no two such
/// axes, or they are zipped, or nothing above zero was measured.
std::vector<NamedPlot> make_heat_maps(const SweepSummary& summary, const std::string& layer);

}  // namespace trilens
