// The files of one run: what makes it finished, and what it then says.
#pragma once

#include <string>

#include "sweep/measure_run.h"
#include "sweep/results.h"

namespace trilens {

/// The file whose lock (file_lock.h) a process holds while it does or judges the run. Throws OutputError.
std::string run_lock(const std::string& folder, const PlannedRun& plan);

/// Tells apart the failures that the folder keeps of this run, one after the other; empty where it keeps
/// none.
std::string failure_stamp(const std::string& folder, const PlannedRun& plan);

/// What the folder says of this run. Finished only where DONE holds plan.hash and the hashes of files that
/// are as they were written; any damage makes it missing.
RunRecord load_run(const std::string& folder, const PlannedRun& plan);

/// Makes the run unfinished, before it is done again. A failure stays told until the new attempt has ended,
/// so that who sums up meanwhile does not miss the run. Throws OutputError.
void clear_run(const std::string& folder, const PlannedRun& plan);

/// Writes the images, metrics.json and last DONE, then forgets an earlier failure; returns the record with
/// its image_hash. Throws OutputError.
RunRecord store_run(const std::string& folder, RunRecord run, const Image& image, const Image& diff);

/// Writes error.json. Throws OutputError.
void store_failure(const std::string& folder, const RunRecord& run);

}  // namespace trilens
