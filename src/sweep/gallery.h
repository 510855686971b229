// The page over several sweeps: each scene with its finest picture, the truth, the difference and the error
// plot.
#pragma once

#include <span>
#include <string>

#include "sweep/results.h"

namespace trilens {

/// Writes `folder`/report.html over sweeps that lie in folders below it. Throws UsageError where the folder
/// is a sweep's own, OutputError.
void write_sweep_gallery(const std::string& folder, std::span<const SweepSummary> summaries);

}  // namespace trilens
