// Which runs a sweep consists of, and what each of them depends on.
#pragma once

#include <string>
#include <vector>

#include "sweep/results.h"

namespace trilens {

/// What decides the pixels of a sweep, as texts that change whenever the pixels may.
struct SweepKeys {
    std::string job;             // of the projector's images
    std::string truth;           // of the truth
    bool truth_per_run = false;  // the truth depends on n
};

/// One run per value of the axis, in its order. Equal hashes, equal results.
std::vector<PlannedRun> make_plan(const Axis& axis, const std::vector<SweptOptic>& optics,
                                  const SweepKeys& keys);

}  // namespace trilens
