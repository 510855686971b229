#include "measure/statistics.h"

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

    std::sort(values.begin(), values.end());
    const auto percentile = [&](std::size_t percent) {
        const std::size_t rank = (percent * values.size() + 99) / 100;  // at least 1
        return values[rank - 1];
    };
    summary.p50 = percentile(50);
    summary.p95 = percentile(95);
    summary.p99 = percentile(99);
    summary.max = values.back();
    return summary;
}

}  // namespace trilens
