// Which runs a sweep consists of, and what each of them depends on.
#pragma once

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

}  // namespace trilens
