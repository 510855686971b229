#include "terrain/thinning.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/util/parallel.h"

namespace trilens {
namespace {

/// What an infinite scale counts as, so that a detail of nothing is worth nothing.
constexpr double kMostScale = 1e25;

float rounded_up(double value) {
    const auto near = static_cast<float>(value);
    return static_cast<double>(near) < value ? std::nextafter(near, std::numeric_limits<float>::infinity())
                                             : near;
}

/// exp(-|R p|^2), R the map that turns the region into the unit disk, times the scale.
class Weights {
  public:
    Weights(const SampleSpacing& spacing, const DetailWeights& weights)
        : spacing_(spacing), region_(weights.region), scale_(weights.scale) {
        if (!region_) return;
        const double angle = region_->turn * std::numbers::pi / 180;
        cos_ = std::cos(angle);
        sin_ = std::sin(angle);
    }
    /// Of a detail that is seen less than `half` samples around, both coordinates multiples of it.
    double at(int x, int y, int half) const {
        const double pixels = scale_ ? std::min(scale_->most_around(x, y, half), kMostScale) : 1;
        if (!region_) return pixels;
        const Vec2 p = spacing_.first + Vec2(x, y) * spacing_.step - region_->center;
        const Vec2 q((cos_ * p.x + sin_ * p.y) / region_->radii.x,
                     (cos_ * p.y - sin_ * p.x) / region_->radii.y);
        return pixels * std::exp(-dot(q, q));
    }

  private:
    const SampleSpacing& spacing_;
    const std::optional<InterestRegion>& region_;
    const FilmScale* scale_;
    double cos_ = 1, sin_ = 0;
};

/// Whether what lies less than `reach` samples around has a part in the grid.
bool reaches_grid(const HeightSquare& heights, int x, int y, int reach) {
    return x - reach < heights.last_column() && y - reach < heights.last_row();
}

}  // namespace

/// The detail signals of one rule: what the samples 2^m apart say beyond those 2^(m+1) apart.
class SampleWorth::Signals {
  public:
    Signals(const HeightSquare& heights, ThinningRule rule) : heights_(heights), rule_(rule) {
        if (rule == ThinningRule::kHaar) average_blocks();
    }

    double at(int x, int y, int m) const {
        if (rule_ == ThinningRule::kLinear) return linear(x, y, 1 << m);
        return block(x, y, m) - block(x, y, m + 1);
    }

  private:
    /// Less what lines between the coarser samples say, in both directions.
    double linear(int x, int y, int step) const {
        const int odd_x = (x / step) % 2 * step, odd_y = (y / step) % 2 * step;
        return heights_.at(x, y) -
               0.25 * (heights_.at(x - odd_x, y - odd_y) + heights_.at(x + odd_x, y - odd_y) +
                       heights_.at(x - odd_x, y + odd_y) + heights_.at(x + odd_x, y + odd_y));
    }
    /// The mean of the block of 2^m x 2^m samples that the sample is in; the last column and row are in the
    /// blocks before them.
    double block(int x, int y, int m) const {
        const int count = 1 << (heights_.levels() - m);
        const int i = std::min(x >> m, count - 1), j = std::min(y >> m, count - 1);
        return means_[static_cast<std::size_t>(
            m)][static_cast<std::size_t>(j) * static_cast<std::size_t>(count) + static_cast<std::size_t>(i)];
    }
    void average_blocks() {
        means_.resize(static_cast<std::size_t>(heights_.levels()) + 1);
        for (int m = 0; m <= heights_.levels(); ++m) {
            const int count = 1 << (heights_.levels() - m);
            std::vector<float>& means = means_[static_cast<std::size_t>(m)];
            means.resize(static_cast<std::size_t>(count) * static_cast<std::size_t>(count));
            const auto mean_of = [&](int i, int j) {
                if (m == 0) return heights_.at(i, j);
                const int half = 1 << (m - 1), x = i << m, y = j << m;
                return 0.25 * (block(x, y, m - 1) + block(x + half, y, m - 1) + block(x, y + half, m - 1) +
                               block(x + half, y + half, m - 1));
            };
            for (int j = 0; j < count; ++j)
                for (int i = 0; i < count; ++i)
                    means[static_cast<std::size_t>(j) * static_cast<std::size_t>(count) +
                          static_cast<std::size_t>(i)] = static_cast<float>(mean_of(i, j));
        }
    }

    const HeightSquare& heights_;
    ThinningRule rule_;
    std::vector<std::vector<float>> means_;  // of Haar: per m
};

/// From the finest samples to the coarsest: own(x, y, m, most) of each, `most` of what rests on it. On a
/// square's middle rest the middles of its sides, on those the middles of the smaller squares that touch
/// them.
template <typename Own>
void SampleWorth::gather(const Own& own) {
    const int side = heights_.side();
    const auto most_at = [&](int x, int y, const std::array<std::array<int, 2>, 4>& steps) {
        float most = 0;
        for (const auto& [dx, dy] : steps) {
            const int i = x + dx, j = y + dy;
            if (i >= 0 && j >= 0 && i < side && j < side) most = std::max(most, at(i, j));
        }
        return most;
    };
    const auto settle = [&](int x, int y, int m, float most) {
        worth_[heights_.index(x, y)] =
            heights_.touches_missing(x, y) ? std::numeric_limits<float>::infinity() : own(x, y, m, most);
    };
    for (int m = 0; m < heights_.levels(); ++m) {
        const int half = 1 << m, quarter = half / 2;
        const auto rows = static_cast<std::size_t>((side - 1) / half + 1);
        // Middles of sides.
        parallel_for(rows, kRowsPerTask, [&](std::size_t first, std::size_t last) {
            for (auto row = static_cast<int>(first); row < static_cast<int>(last); ++row)
                for (int x = row % 2 == 0 ? half : 0; x < side; x += 2 * half) {
                    const int y = row * half;
                    const float most = quarter == 0 ? 0
                                                    : most_at(x, y,
                                                              {{{-quarter, -quarter},
                                                                {quarter, -quarter},
                                                                {-quarter, quarter},
                                                                {quarter, quarter}}});
                    settle(x, y, m, most);
                }
        });
        // Middles of squares.
        parallel_for(rows / 2, kRowsPerTask, [&](std::size_t first, std::size_t last) {
            for (auto row = static_cast<int>(first); row < static_cast<int>(last); ++row)
                for (int x = half; x < side; x += 2 * half) {
                    const int y = (2 * row + 1) * half;
                    settle(x, y, m, most_at(x, y, {{{-half, 0}, {half, 0}, {0, -half}, {0, half}}}));
                }
        });
    }
}

SampleWorth::SampleWorth(const HeightSquare& heights, ThinningRule rule, const SampleSpacing& spacing,
                         const DetailWeights& by)
    : heights_(heights) {
    worth_.assign(static_cast<std::size_t>(heights.side()) * static_cast<std::size_t>(heights.side()), 0);
    const Weights weights(spacing, by);
    if (rule == ThinningRule::kBound) {
        gather([&](int x, int y, int m, float most) {
            const int half = 1 << m;
            if (!reaches_grid(heights, x, y, half)) return most;
            return rounded_up(weights.at(x, y, half) * std::fabs(bisection_detail(heights, x, y, half)) +
                              static_cast<double>(most));
        });
        return;
    }
    const Signals signals(heights, rule);
    gather([&](int x, int y, int m, float most) {
        const int step = 1 << m;
        if (!reaches_grid(heights, x, y, step)) return most;
        double energy = 0;
        for (const auto& [dx, dy] : {std::array{0, 0}, {-step, 0}, {step, 0}, {0, -step}, {0, step}}) {
            const int i = x + dx, j = y + dy;
            if (i < 0 || j < 0 || i >= heights.side() || j >= heights.side()) continue;
            const double signal = weights.at(i, j, step) * signals.at(i, j, m);
            energy += signal * signal;
        }
        return std::max(most, rounded_up(std::sqrt(energy)));
    });
}

}  // namespace trilens
