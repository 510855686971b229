// Which runs a sweep consists of, what each depends on, and which part of them one process does (--shard); a
// sweep as a file that a repository can keep.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "sweep/store/axis.h"
#include "sweep/store/results.h"

namespace trilens {

// Which runs a sweep consists of, what each depends on, and which part of them one process does (--shard).

/// What decides the pixels of a run, as texts that change whenever the pixels may.
struct RunKeys {
    std::string job;    // of the run's own image
    std::string truth;  // of its truth: runs with the same text share one image
    std::vector<SweptOptic> optics = {};
};

/// One run per point of the axes, in their order. Equal hashes, equal results. Throws UsageError as
/// make_points does, and where two points have one name; and what `keys` throws.
std::vector<PlannedRun> make_plan(const SweepAxes& axes,
                                  const std::function<RunKeys(const Coordinates&)>& keys);

/// Job i of a plan belongs to shard i % count.
struct Shard {
    int index = 0, count = 1;

    bool has(std::size_t job) const {
        return job % static_cast<std::size_t>(count) == static_cast<std::size_t>(index);
    }
};

/// Value of an environment variable, or nullptr.
using Environment = std::function<const char*(const char* name)>;

/// Reads "i/n" with 0 <= i < n, or "auto": from the variables of Slurm, Grid Engine, LSF job arrays or of
/// GoogleTest sharding. Throws UsageError.
Shard parse_shard(const std::string& text, const Environment& environment);

// A sweep as a file that a repository can keep: what is swept, over what, against which truth.

/// A sweep file as it is written; what it leaves out is empty.
struct SweepFile {
    std::vector<std::string> scenes;
    std::vector<AxisRequest> over;
    bool zip = false;
    std::string truth, camera, title;
    std::vector<std::pair<std::string, std::string>> set;  // JSON pointer, value as JSON text
    int repeats = 0;
};

/// Reads a sweep file: { "scenes": [...], "over": [{"axis": ..., "values": [...]}], "zip": false, "truth":
/// "limit", "camera": ..., "title": ..., "repeats": R, "set": {"/json/pointer": value} }; all but "over" and
/// "scenes" may be missing, scenes too where an axis names them. Values are JSON, or texts as --over takes
/// them ("1..64:x2"). Comments are allowed. Throws InputError with the file and the JSON pointer of the first
/// problem.
SweepFile read_sweep_file(const std::string& file);

/// The JSON Schema (draft 7) of sweep files, as text.
std::string sweep_schema();

/// Whether the file is meant as a sweep: a JSON object with "over" in it. False for what cannot be read.
bool is_sweep_file(const std::string& file);

}  // namespace trilens
