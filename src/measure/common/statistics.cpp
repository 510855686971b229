#include "measure/common/statistics.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace trilens {

Summary summarize(std::vector<double> values) {
    Summary summary;
    if (values.empty()) return summary;
    double sum = 0;
    for (const double value : values) sum += value;
    summary.mean = sum / static_cast<double>(values.size());

    // In rising order: behind each only larger values are left.
    auto first = values.begin();
    const auto percentile = [&](std::size_t percent) {
        const std::size_t rank = (percent * values.size() + 99) / 100;  // at least 1
        const auto at = values.begin() + static_cast<std::ptrdiff_t>(rank - 1);
        std::nth_element(first, at, values.end());
        first = at;
        return *at;
    };
    summary.p50 = percentile(50);
    summary.p95 = percentile(95);
    summary.p99 = percentile(99);
    summary.max = *std::max_element(first, values.end());
    return summary;
}

}  // namespace trilens
