// The report of a sweep: the order with which its errors fall, its text, its plots and its page.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "report/page.h"
#include "report/plot.h"
#include "sweep/store/results.h"

namespace trilens {

// The order with which the errors of a sweep fall.

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

/// The fit of the mean off the folds (measure/field/position_field.h); nullptr where it says no more than that
/// of the mean, because no run found a pixel near a fold.
const SweepFit* find_fit_off_folds(const std::vector<SweepFit>& fits, const std::string& layer,
                                   const std::string& optic, const Coordinates* group = nullptr);

/// The fit's points and line for a plot.
PlotSeries plot_series(const SweepFit& fit, const std::string& name);

// A sweep in words and numbers, as its report says it, and its fits as a LaTeX table.

/// What stands for the optics of a run together.
inline constexpr const char* kAllOptics = "all";

/// A column's value as a cell: whole, with three digits, of disp_coverage as a percentage; empty where there
/// is none.
std::string count_text(const MetricValues& metrics, const std::string& name);
std::string value_text(const MetricValues& metrics, const std::string& name);
std::string coverage_text(const MetricValues& metrics);

/// The displacement of all optics together; null where the run has no such layer.
const MetricValues* find_all(const RunRecord& run, const std::string& layer);

/// Orders of convergence, what resolution one pixel takes, what was measured.
std::vector<Headline> make_headlines(const SweepSummary& summary);

/// What was swept, in a sentence.
std::string summary_words(const SweepSummary& summary);

/// What plots would say with nothing in them: that all is exact.
std::vector<std::string> exact_sentences(const SweepSummary& summary);

/// That a scene was left out, and why.
std::string left_out_words(const LeftOutScene& scene);

/// Whether times are measurements; empty where all are.
std::string timing_warning(const SweepSummary& summary);

/// A tabular of the booktabs package, a row per group, layer and optic with the order of the mean
/// displacement, its 95 % confidence interval, the constant and the n for one pixel; of sweeps without
/// displacements the order of the colour error. To be read with \input.
std::string summary_latex(const SweepSummary& summary);

// The plots of a sweep: error along its axes, what accuracy costs, maps over two axes; which groups of runs
// share one.

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

// A sweep's plots and its report page.

class KeptPictures;

inline constexpr std::size_t kMostBytesInPage = 50'000'000;  // of pictures; more lie beside the page

/// Writes plots/*.svg and report.html into summary.folder. Pictures that cannot be read are named in their
/// place with the reason; those in `kept` are not read. Throws OutputError.
void write_sweep_report(const SweepSummary& summary, KeptPictures* kept = nullptr);

}  // namespace trilens
