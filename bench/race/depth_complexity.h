// How many layers of a scene its rays pass.
#pragma once

#include "bench/race/race.h"

namespace trilens_bench {

using namespace trilens;

/// Mean number of depths (t >= 0, further apart than kDepthTie) at which a ray meets triangles, over every
/// 64th sample of each facet and each facet's first. 0 where there are no samples. Builds a tree of its own.
double depth_complexity(const RaceCourse& course);

}  // namespace trilens_bench
