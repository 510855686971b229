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
/// only those that the runs have numbers for.
std::vector<NamedPlot> make_plots(const SweepSummary& summary);

/// The layers that the runs measured, in their order.
std::vector<std::string> layers_of(const SweepSummary& summary);

/// "what mirrors show" for "reflect".
std::string what_layer_shows(const std::string& layer);

}  // namespace trilens
