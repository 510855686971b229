// Scripts that hand the runs of a sweep to a batch system.
#pragma once

#include <string>
#include <vector>

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

}  // namespace trilens
