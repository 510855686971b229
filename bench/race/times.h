// What is timed, and how several times make one.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "base/util/progress.h"

namespace trilens_bench {

using namespace trilens;

/// How long work() takes, in milliseconds.
template <typename Work>
double milliseconds(const Work& work) {
    const Stopwatch watch;
    work();
    return 1000 * watch.seconds();
}

/// The middle one by size, the upper of two; `values` is not empty.
inline double median(std::vector<double> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

}  // namespace trilens_bench
