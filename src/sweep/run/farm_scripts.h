// Scripts that hand the runs of a sweep to a batch system.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "base/util/error.h"

namespace trilens {

struct FarmRequest {
    std::string system;                // one of farm_systems()
    int parts = 1;                     // jobs of the array, at least 1
    std::string title;                 // of the jobs
    std::string folder;                // of the sweep
    std::vector<std::string> command;  // words of the command that runs all of the sweep, without --shard
    std::vector<std::string> report;   // words of the command that sums up; run once all parts are through
};

/// "slurm", "htcondor", "parallel".
const std::vector<std::string>& farm_systems();

/// The text of a script. Slurm: for sbatch; an array whose parts are requeued where their node fails, and
/// which hands in the report as a job that follows it. HTCondor: a submit description; the report is a line
/// to type. GNU parallel: a shell script that does all. Words are quoted for the shell, and what the batch
/// systems would replace in names is written as they read it back. Throws UsageError for another system, for
/// less than one part, and for words that a script of the system cannot hold.
std::string farm_script(const FarmRequest& request);

/// A word as a POSIX shell reads it back.
std::string shell_quoted(const std::string& word);

// Folders of one sweep from several machines joined into one.

/// Copies what is finished in `parts` to `folder` and sums up nothing; what `folder` holds already counts as
/// a part. The plan is that of all parts together, the first part's first. A finished run counts only as
/// load_sweep trusts it; where two parts have one, the first is taken; a failed one is taken where no part
/// has finished it. Truths come with the runs. Returns how many runs were copied. Throws InputError where a
/// part is no sweep's folder, or is another sweep than the first, or holds results of other scenes or another
/// build (a run of one name and another hash); then nothing is copied. OutputError; UsageError where `folder`
/// is another sweep's.
std::size_t merge_folders(const std::vector<std::string>& parts, const std::string& folder,
                          const Progress& progress = {});

}  // namespace trilens
