// The plots of a sweep: error along its axes, what accuracy costs, maps over two axes; which groups of runs
// share one.
#pragma once

#include <string>
#include <vector>

#include "report/plot_style.h"
#include "sweep/report/fit_runs.h"
#include "sweep/store/results.h"

namespace trilens {

struct NamedPlot {
    std::string name;  // of the file, without its end: "reflect_disp_mean_px"
    PlotDrawing drawing;
};

/// Per layer mean and 95 % displacement, the colour error, and displacement over time; of one group of runs
/// with a line per optic, of several with a line per group, eight to a plot; maps of the mean displacement
/// over the first two axes of numbers. Only those that the runs have numbers above zero for.
std::vector<NamedPlot> make_plots(const SweepSummary& summary);

/// The most plots of one kind that are made; further groups are in the tables alone.
inline constexpr std::size_t kMostPlotsOfAKind = 12;

/// The layers that the runs measured, in their order.
std::vector<std::string> layers_of(const SweepSummary& summary);

/// Whether the run's time is a measurement: one at a time, and hardly any other work on the machine.
bool is_timed_alone(const RunRecord& run);

/// How much was measured over all finished runs: "98.2 %", "97.9 % to 99.8 %", or "nothing".
std::string measured_range(const SweepSummary& summary, const std::string& layer);

/// How much of one run's layer was measured, with the losses in both directions.
std::string measured_text(const MetricValues& metrics);

/// A share as "98.2 %"; never rounded to 100 % or 0 % where it is not.
std::string percent_text(double share);

/// Whether the fit has points and all of them are zero: there is nothing to draw.
bool is_exact(const SweepFit& fit);

/// "what mirrors show" for "reflect".
std::string what_layer_shows(const std::string& layer);

/// The mean displacement of what a layer shows over the first two axes of numbers with at least two values,
/// one map per combination of the other axes (at most kMostPlotsOfAKind); none where there are no two such
/// axes, or they are zipped, or nothing above zero was measured.
std::vector<NamedPlot> make_heat_maps(const SweepSummary& summary, const std::string& layer);

// Which groups of runs share a plot, and what their lines are called.

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
