#include "paths/facets/fit_nodes.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/util/check.h"
#include "base/util/parallel.h"

namespace trilens {
namespace {

constexpr int kSteps = 24;  // each gains (sqrt 5 + 1) / (sqrt 5 - 1) = 2.6; all of them 1e10
constexpr double kSmallestEigenvalue = 0.2, kLargestEigenvalue = 1;
constexpr std::size_t kRowsPerTask = 1024;
constexpr std::size_t kRayParts = 6;  // of a value: origin and direction
constexpr double kNoMiss = 1e-9;      // facets that miss by less are exact

/// The mass matrix by rows, and its right-hand sides.
struct Equations {
    std::vector<std::size_t> first;
    std::vector<Id> column;
    std::vector<double> entry;
    std::vector<double> row_sum;
    std::vector<FitValue> right;
};

Equations make_equations(std::span<const FitSample> samples, std::size_t corners) {
    struct Entry {
        Id row, column;
        double value;
    };
    Equations equations;
    equations.row_sum.resize(corners, 0.0);
    equations.right.resize(corners, FitValue{});
    std::vector<Entry> entries;
    entries.reserve(9 * samples.size());
    for (const FitSample& sample : samples)
        for (std::size_t i = 0; i < 3; ++i) {
            const Id row = sample.corners[i];
            TRILENS_CHECK(row < corners, "a sample names corners that have values");
            const double share = sample.measure * sample.weights[static_cast<int>(i)];
            equations.row_sum[row] += share;
            for (std::size_t p = 0; p < kFitParts; ++p) equations.right[row][p] += share * sample.value[p];
            for (std::size_t j = 0; j < 3; ++j)
                entries.push_back({row, sample.corners[j], share * sample.weights[static_cast<int>(j)]});
        }
    std::stable_sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) {
        return a.row != b.row ? a.row < b.row : a.column < b.column;
    });
    equations.first.assign(corners + 1, 0);
    for (std::size_t e = 0; e < entries.size(); ++e) {
        if (e > 0 && entries[e - 1].row == entries[e].row && entries[e - 1].column == entries[e].column) {
            equations.entry.back() += entries[e].value;
            continue;
        }
        equations.column.push_back(entries[e].column);
        equations.entry.push_back(entries[e].value);
        ++equations.first[entries[e].row + 1];
    }
    for (std::size_t r = 0; r < corners; ++r) equations.first[r + 1] += equations.first[r];
    return equations;
}

FitValue row_times(const Equations& equations, std::size_t row, std::span<const FitValue> vector) {
    FitValue product{};
    for (std::size_t e = equations.first[row]; e < equations.first[row + 1]; ++e)
        for (std::size_t p = 0; p < kFitParts; ++p)
            product[p] += equations.entry[e] * vector[equations.column[e]][p];
    return product;
}

/// The square of how far a ray is from what its sample asks, in parts of its direction's length, for which
/// `unit` stands where that is 1.
double relative_miss(const FitSample& sample, std::span<const FitValue> values, double unit) {
    double miss = 0, direction = 0;
    for (std::size_t p = 0; p < kRayParts; ++p) {
        double off = -sample.value[p];
        for (std::size_t k = 0; k < 3; ++k)
            off += sample.weights[static_cast<int>(k)] * values[sample.corners[k]][p];
        const bool is_direction = p >= kRayParts / 2;
        const double length2 = is_direction ? unit * unit : 1;
        miss += length2 * (off * off);
        if (is_direction) direction += length2 * (sample.value[p] * sample.value[p]);
    }
    return direction > 0 ? miss / direction : 0;
}

}  // namespace

void even_out(std::span<FitSample> samples, std::span<const FitValue> values, double unit) {
    for (std::size_t first = 0, end = 0; first < samples.size(); first = end) {
        double miss = 0, whole = 0;
        for (; end < samples.size() && samples[end].corners == samples[first].corners; ++end) {
            const double share = samples[end].measure;
            miss += share * relative_miss(samples[end], values, unit);
            whole += share;
        }
        const double scale = 1 / (std::sqrt(miss / whole) + kNoMiss);
        for (std::size_t i = first; i < end; ++i) samples[i].measure *= scale;
    }
}

void fit_linear(std::span<const FitSample> samples, std::span<FitValue> values) {
    const Equations equations = make_equations(samples, values.size());
    std::vector<FitValue> left(values.size()), change(values.size());  // residual; step
    const auto over_rows = [&](const auto& body) {
        parallel_for(values.size(), kRowsPerTask, [&](std::size_t from, std::size_t to) {
            for (std::size_t r = from; r < to; ++r)
                if (equations.row_sum[r] > 0) body(r);
        });
    };
    // Chebyshev's iteration (Saad, Iterative Methods for Sparse Linear Systems, algorithm 12.1).
    constexpr double kMiddle = (kLargestEigenvalue + kSmallestEigenvalue) / 2,
                     kHalf = (kLargestEigenvalue - kSmallestEigenvalue) / 2;
    over_rows([&](std::size_t r) {
        const FitValue product = row_times(equations, r, values);
        for (std::size_t p = 0; p < kFitParts; ++p) {
            left[r][p] = equations.right[r][p] - product[p];
            change[r][p] = left[r][p] / (equations.row_sum[r] * kMiddle);
        }
    });
    double rho = kHalf / kMiddle;
    for (int step = 0; step < kSteps; ++step) {
        over_rows([&](std::size_t r) {
            const FitValue product = row_times(equations, r, change);
            for (std::size_t p = 0; p < kFitParts; ++p) {
                values[r][p] += change[r][p];
                left[r][p] -= product[p];
            }
        });
        const double next = 1 / (2 * kMiddle / kHalf - rho);
        over_rows([&](std::size_t r) {
            for (std::size_t p = 0; p < kFitParts; ++p)
                change[r][p] =
                    next * rho * change[r][p] + 2 * next / kHalf * left[r][p] / equations.row_sum[r];
        });
        rho = next;
    }
}

}  // namespace trilens
