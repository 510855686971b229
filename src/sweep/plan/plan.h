// Which runs a sweep consists of, what each depends on, and which part of them one process does (--shard).
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "sweep/store/results.h"

namespace trilens {

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

}  // namespace trilens
