// A set of numbers as mean, percentiles and maximum.
#pragma once

#include <vector>

namespace trilens {

/// All zero where there are no numbers. A percentile p is the smallest number that at least p % of all do not
/// exceed (nearest rank), so it is always one of them.
struct Summary {
    double mean = 0, p50 = 0, p95 = 0, p99 = 0, max = 0;
};

/// Precondition: no NaN. The sum runs in the order given, so equal input gives equal bits.
Summary summarize(std::vector<double> values);

}  // namespace trilens
