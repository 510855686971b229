// Medians of repeated runs.
#pragma once

#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "bench/race/times.h"

namespace trilens_bench {

/// The median of `repeats` runs of `work`, milliseconds of wall time.
inline double median_ms(int repeats, const std::function<void()>& work) {
    std::vector<double> times;
    for (int i = 0; i < repeats; ++i) times.push_back(milliseconds(work));
    return median(std::move(times));
}

/// Reproducible uniform numbers, the same with every compiler.
inline double uniform(std::uint64_t& state, double low, double high) {
    state = state * 6364136223846793005u + 1442695040888963407u;
    return low + (high - low) * (static_cast<double>(state >> 11) * 0x1p-53);
}

}  // namespace trilens_bench
