// The plots of a sweep: error over resolution, and what accuracy costs.
#pragma once

#include <string>
#include <vector>

#include "sweep/results.h"

namespace trilens {

struct NamedPlot {
    std::string name;  // of the file, without its end: "reflect_disp_mean_px"
    std::string svg;
};

/// Per layer mean and 95 % displacement with a line per optic, the colour error, and displacement over time;
/// only those that the runs have numbers above zero for.
std::vector<NamedPlot> make_plots(const SweepSummary& summary);

/// The layers that the runs measured, in their order.
std::vector<std::string> layers_of(const SweepSummary& summary);

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

}  // namespace trilens
