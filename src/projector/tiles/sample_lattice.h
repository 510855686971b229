// The samples of a grid as one lattice of columns and rows, whatever the number of samples in a pixel.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

#include "base/raymesh/sample_grid.h"
#include "base/util/ids.h"

namespace trilens {

/// Where a sample stands, from the window's corner.
struct LatticeSample {
    int column = 0, row = 0;
};

/// A rectangle of the lattice, first and last line each way.
struct LatticeExtent {
    int x0 = INT32_MAX, x1 = 0, y0 = INT32_MAX, y1 = 0;

    void include(const LatticeSample& s) {
        x0 = std::min(x0, s.column), x1 = std::max(x1, s.column);
        y0 = std::min(y0, s.row), y1 = std::max(y1, s.row);
    }
};

/// Finds samples that come in ascending order: neighbours in a row without a division.
class LatticeWalk {
  public:
    explicit LatticeWalk(const SampleGrid& grid)
        : width_(static_cast<Id>(
              grid.order == SampleOrder::kLattice ? grid.columns() : static_cast<std::size_t>(grid.width()))),
          side_(static_cast<Id>(grid.order == SampleOrder::kLattice ? 1 : grid.side)),
          per_pixel_(side_ * side_),
          chosen_(grid.chosen) {}

    LatticeSample at(Id sample) {
        if (!chosen_.empty()) sample = chosen_[sample];
        if (side_ == 1) {
            move_to_row_of(sample);
            return {static_cast<int>(sample - row_start_), static_cast<int>(row_)};
        }
        const Id pixel = sample / per_pixel_, inside = sample % per_pixel_;
        move_to_row_of(pixel);
        return {static_cast<int>((pixel - row_start_) * side_ + inside % side_),
                static_cast<int>(row_ * side_ + inside / side_)};
    }

  private:
    void move_to_row_of(Id pixel) {
        if (pixel - row_start_ < width_) return;
        row_ = pixel / width_;
        row_start_ = row_ * width_;
    }

    Id width_, side_, per_pixel_;
    std::span<const Id> chosen_;
    Id row_ = 0, row_start_ = 0;  // of pixels; the row's first pixel
};

/// Neighbours in a row: `sample` at `first`, and the count - 1 after it.
struct LatticeRun {
    LatticeSample first;
    int count = 1;
    Id sample = 0;

    LatticeSample last() const { return {first.column + count - 1, first.row}; }
};

/// Calls body for runs of all the samples, which ascend. Where numbers count on along rows and the samples
/// are many, the runs are as long as they can be, and found by their ends; else each sample is one.
template <typename Body>
void for_each_run(const SampleGrid& grid, std::span<const Id> samples, const Body& body) {
    constexpr std::size_t kMany = 100;  // measured
    LatticeWalk walk(grid);
    const bool long_runs = grid.in_rows() && samples.size() >= kMany;
    std::size_t count = 1;
    for (std::size_t i = 0; i < samples.size(); i += count) {
        LatticeRun run{walk.at(samples[i]), 1, samples[i]};
        if (long_runs) {
            const std::size_t most =
                std::min(samples.size() - i, grid.columns() - static_cast<std::size_t>(run.first.column));
            const auto follow = [&](std::size_t n) { return samples[i + n - 1] - samples[i] == n - 1; };
            // A row is about as long as the one before.
            count = std::min(count, most);
            while (!follow(count)) --count;
            while (count < most && follow(count + 1)) ++count;
            run.count = static_cast<int>(count);
        }
        body(run);
    }
}

}  // namespace trilens
