// A sweep's plots and its report page.
#pragma once

#include "sweep/results.h"

namespace trilens {

/// Writes plots/*.svg and report.html into summary.folder. Pictures that cannot be read are named in their
/// place with the reason. Throws OutputError.
void write_sweep_report(const SweepSummary& summary);

}  // namespace trilens
