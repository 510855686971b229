// Does the runs of a plan: several at once, beside other processes, within memory.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "sweep/run/sweep.h"

namespace trilens {

class KeptPictures;

/// Does the shard's part of the plan: first what nobody else is at, then what those have left. Runs of one
/// truth follow each other. Returns those that were done here, by id, as load_run would read them now. Throws
/// Interrupted between runs, and as run_sweep does. `pictures`: where given, takes those of the runs done.
std::map<std::string, RunRecord> run_plan(const SweepParams& params, const SweepCallbacks& callbacks,
                                          const std::vector<PlannedRun>& plan,
                                          KeptPictures* pictures = nullptr);

}  // namespace trilens
