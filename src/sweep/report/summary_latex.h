// The fits of a sweep as a LaTeX table.
#pragma once

#include <string>

#include "sweep/store/results.h"

namespace trilens {

/// A tabular of the booktabs package, a row per group, layer and optic with the order of the mean
/// displacement, its 95 % confidence interval, the constant and the n for one pixel; of sweeps without
/// displacements the order of the colour error. To be read with \input.
std::string summary_latex(const SweepSummary& summary);

}  // namespace trilens
