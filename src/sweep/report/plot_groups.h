// Which groups of runs share a plot, and what their lines are called.
#pragma once

#include <string>
#include <vector>

#include "sweep/report/fit_runs.h"
#include "sweep/store/results.h"

namespace trilens {

/// A line of a plot.
struct PlotGroup {
    std::string name;  // what tells it from the other lines of its plot: "classic, spp = 2"
    Coordinates at;
    std::vector<const RunRecord*> runs;
};

/// The lines of one plot.
struct PlotGroups {
    std::string title;  // what they have in common; empty where there is one plot only
    std::string file;   // the same as the end of a file's name: "_classic"
    std::vector<PlotGroup> groups;
};

/// At most eight lines to a plot where the axes allow it: the last axes tell the lines of a plot apart, the
/// first ones the plots.
std::vector<PlotGroups> plot_groups(const std::vector<RunGroup>& groups);

/// The displacement of one layer and optic in a run; null where it was not measured.
const MetricValues* find_displacement(const RunRecord& run, const std::string& layer,
                                      const std::string& optic);

}  // namespace trilens
