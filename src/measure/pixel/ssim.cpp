#include "measure/pixel/ssim.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "base/util/check.h"
#include "base/util/parallel.h"

namespace trilens {
namespace {

constexpr int kGaussReach = 5;  // an 11 x 11 window
constexpr double kSigma = 1.5, kC1 = 0.01 * 0.01, kC2 = 0.03 * 0.03;

/// Sums of weight, a, b, a a, b b, a b under a window.
using Moments = std::array<double, 6>;

std::array<double, 2 * kGaussReach + 1> window_weights() {
    std::array<double, 2 * kGaussReach + 1> weights{};
    for (int i = -kGaussReach; i <= kGaussReach; ++i)
        weights[static_cast<std::size_t>(i + kGaussReach)] = std::exp(-0.5 * i * i / (kSigma * kSigma));
    return weights;
}

/// Columns x0 .. x1 - 1 and rows y0 .. y1 - 1, whose windows hold pixels that differ or are not finite. Any
/// other pixel has a similarity of exactly 1: all moments of the two pictures are the same numbers, and so
/// are the two sides of the fraction.
struct Differing {
    int x0, y0, x1 = 0, y1 = 0;

    explicit Differing(const GreyPicture& a, const GreyPicture& b) : x0(a.width), y0(a.height) {
        for (int y = 0; y < a.height; ++y) {
            const std::size_t row = static_cast<std::size_t>(y) * static_cast<std::size_t>(a.width);
            const auto is_same = [&](int x) {
                const std::size_t i = row + static_cast<std::size_t>(x);
                return a.values[i] == b.values[i] && std::isfinite(a.values[i]);
            };
            int first = 0, last = a.width;
            while (first < last && is_same(first)) ++first;
            if (first == last) continue;
            while (is_same(last - 1)) --last;
            x0 = std::min(x0, first - kGaussReach);
            x1 = std::max(x1, last + kGaussReach);
            y0 = std::min(y0, y - kGaussReach);
            y1 = y + 1 + kGaussReach;
        }
    }
    bool holds(int x, int y) const { return x >= x0 && x < x1 && y >= y0 && y < y1; }
};

struct Filter {
    const GreyPicture &a, &b;
    const Differing& differing;
    std::array<double, 2 * kGaussReach + 1> weights = window_weights();

    std::size_t index(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(a.width) + static_cast<std::size_t>(x);
    }

    /// The window's horizontal half, for all pixels of a row.
    void filter_row(int y, std::vector<Moments>& row) const {
        row.assign(static_cast<std::size_t>(a.width), Moments{});
        for (int x = std::max(0, differing.x0 - kGaussReach);
             x < std::min(a.width, differing.x1 + kGaussReach); ++x) {
            const double p = a.values[index(x, y)], q = b.values[index(x, y)];
            if (!std::isfinite(p) || !std::isfinite(q)) continue;
            const Moments here = {1, p, q, p * p, q * q, p * q};
            for (int to = std::max(0, x - kGaussReach); to <= std::min(a.width - 1, x + kGaussReach); ++to) {
                const double weight = weights[static_cast<std::size_t>(to - x + kGaussReach)];
                for (std::size_t m = 0; m < 6; ++m) row[static_cast<std::size_t>(to)][m] += weight * here[m];
            }
        }
    }
};

double similarity(const Moments& sum) {
    const double ma = sum[1] / sum[0], mb = sum[2] / sum[0];
    const double aa = sum[3] / sum[0] - ma * ma, bb = sum[4] / sum[0] - mb * mb,
                 ab = sum[5] / sum[0] - ma * mb;
    return (2 * ma * mb + kC1) * (2 * ab + kC2) / ((ma * ma + mb * mb + kC1) * (aa + bb + kC2));
}

struct RowSum {
    double sum = 0;
    std::size_t pixels = 0;
};

/// Rows [first, last): each horizontally filtered row is made once and kept while windows reach it.
void measure_rows(const Filter& filter, std::span<const std::uint8_t> counted, int first, int last,
                  std::vector<RowSum>& sums) {
    constexpr int kKept = 2 * kGaussReach + 1;
    std::array<std::vector<Moments>, kKept> kept;
    int made = std::max(0, first - kGaussReach);
    for (int y = first; y < last; ++y) {
        const int top = std::max(0, y - kGaussReach), bottom = std::min(filter.a.height - 1, y + kGaussReach);
        const bool is_asked = y >= filter.differing.y0 && y < filter.differing.y1;
        if (is_asked) made = std::max(made, top);
        for (; is_asked && made <= bottom; ++made)
            filter.filter_row(made, kept[static_cast<std::size_t>(made % kKept)]);
        for (int x = 0; x < filter.a.width; ++x) {
            const std::size_t i = filter.index(x, y);
            if (!counted[i] || !std::isfinite(filter.a.values[i]) || !std::isfinite(filter.b.values[i]))
                continue;
            sums[static_cast<std::size_t>(y)].pixels += 1;
            if (!filter.differing.holds(x, y)) {
                sums[static_cast<std::size_t>(y)].sum += 1;
                continue;
            }
            Moments total{};
            for (int row = top; row <= bottom; ++row) {
                const double weight = filter.weights[static_cast<std::size_t>(row - y + kGaussReach)];
                const Moments& part =
                    kept[static_cast<std::size_t>(row % kKept)][static_cast<std::size_t>(x)];
                for (std::size_t m = 0; m < 6; ++m) total[m] += weight * part[m];
            }
            sums[static_cast<std::size_t>(y)].sum += similarity(total);
        }
    }
}

}  // namespace

double structural_similarity(const GreyPicture& a, const GreyPicture& b,
                             std::span<const std::uint8_t> counted) {
    const std::size_t pixels = static_cast<std::size_t>(a.width) * static_cast<std::size_t>(a.height);
    TRILENS_CHECK(a.width == b.width && a.height == b.height, "pictures of one size");
    TRILENS_CHECK(a.values.size() == pixels && b.values.size() == pixels && counted.size() == pixels,
                  "one value per pixel");
    const Differing differing(a, b);
    const Filter filter{a, b, differing};
    std::vector<RowSum> sums(static_cast<std::size_t>(a.height));
    parallel_for(sums.size(), 64, [&](std::size_t first, std::size_t last) {
        measure_rows(filter, counted, static_cast<int>(first), static_cast<int>(last), sums);
    });

    // Add up in row order, so that the result does not depend on the threads.
    RowSum all;
    for (const RowSum& row : sums) {
        all.sum += row.sum;
        all.pixels += row.pixels;
    }
    return all.pixels > 0 ? all.sum / static_cast<double>(all.pixels) : 1;
}

}  // namespace trilens
