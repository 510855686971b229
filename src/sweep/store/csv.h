// runs.csv and displacement.csv: one row per run, and one row per run, optic and layer;
// "all" alone where a layer has one optic.
#pragma once

#include <string>

#include "sweep/store/results.h"

namespace trilens {

/// One row per run under the columns of the interface that any run has something for, and behind the id one
/// for each axis that has none there. Numbers are the
/// shortest that read back; an empty cell was not computed, "nan" was. Cells with commas, quotes or line ends
/// are quoted as in RFC 4180.
std::string runs_csv(const SweepSummary& summary);

/// One row per finished run, layer and optic ("all" included) with its displacement.
std::string displacement_csv(const SweepSummary& summary);

}  // namespace trilens
