// What share of a picture's job its parts are: what is made before it is drawn, and its rows, by timing some
// of them (stratified sampling).
#pragma once

#include <functional>
#include <vector>

#include "base/util/error.h"
#include "render/engines/engine.h"
#include "render/frame/request.h"
#include "render/world/world.h"

namespace trilens {

/// Shares of a picture's work, 1 in all.
class RowShares {
  public:
    /// Seconds that the rows [from, to) take.
    using TimeRows = std::function<double(int from, int to)>;

    /// Rows [y0, y1), all alike; y0 < y1.
    RowShares(int y0, int y1);

    /// By few rows, spread over the picture: one in 32 at the most, and three of pictures that are done
    /// before anybody asks how long they take. Between them shares are interpolated.
    static RowShares measured(int y0, int y1, const TimeRows& time);

    /// What share the rows [from, to) are, y0 <= from <= to <= y1.
    double of(int from, int to) const {
        return before_[static_cast<std::size_t>(to - y0_)] - before_[static_cast<std::size_t>(from - y0_)];
    }

  private:
    int y0_ = 0;
    std::vector<double> before_;  // per row, and one more: the share of those above
};

/// Many optics take a while to make, of which the user is told; returns the rest of the progress.
Progress prepare_many_optics(const World& world, const PictureRequest& request, const Progress& progress);

/// Makes the beams of lights with caustics; returns the rest of the progress.
Progress prepare_caustics(const World& world, bool exact, const Progress& progress);

/// Gathers their light on what is seen, where pictures do not ask for exact rays; returns the rest of the
/// progress.
Progress gather_seen(const World& world, Viewer& viewer, const LayerRequest& window,
                     const Progress& progress);

}  // namespace trilens
