// The files of one run: what makes it finished, and what it then says.
#pragma once

#include <string>

#include "sweep/measure_run.h"
#include "sweep/results.h"

namespace trilens {

/// What the folder says of this run. Finished only where DONE holds plan.hash and the hashes of files that
/// are as they were written; any damage makes it missing.
RunRecord load_run(const std::string& folder, const PlannedRun& plan);

/// Forgets what an earlier attempt left: DONE first.
void clear_run(const std::string& folder, const PlannedRun& plan);

/// Writes the images, metrics.json and last DONE; returns the record with its image_hash. Throws OutputError.
RunRecord store_run(const std::string& folder, RunRecord run, const Image& image, const Image& diff);

/// Writes error.json. Throws OutputError.
void store_failure(const std::string& folder, const RunRecord& run);

}  // namespace trilens
