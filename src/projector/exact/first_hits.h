// The nearest triangle at each sample of a block so far, with ties in depth resolved whatever the order of
// arrival.
#pragma once

#include <algorithm>
#include <array>
#include <limits>

#include "base/raymesh/triangle_scene.h"
#include "projector/exact/decide.h"
#include "projector/exact/sample_blocks.h"

namespace trilens {

/// At each sample: among the triangles whose t is within kDepthTie of the smallest, the one with the smallest
/// rank. A rival may leave that band after it has driven out another that stays; `order_mattered` then asks
/// for a second pass over the same triangles, which starts with the smallest t known and so is exact.
class FirstHits {
  public:
    explicit FirstHits(std::size_t count) : count_(count), unseen_(count) {
        nearest_.fill(kFar);
        winner_.fill(kNone);
    }

    /// No triangle beyond this t can change sample s.
    double limit(std::size_t s) const { return nearest_[s] * (1 + kDepthTie); }

    /// The largest limit of all samples.
    double farthest() {
        if (unseen_ > 0) return kFar;
        if (stale_) {
            farthest_ =
                *std::max_element(nearest_.begin(), nearest_.begin() + static_cast<std::ptrdiff_t>(count_)) *
                (1 + kDepthTie);
            stale_ = false;
        }
        return farthest_;
    }

    void offer(std::size_t s, const LineHit& hit, Id triangle, Id rank) {
        if (!(hit.t >= 0 && hit.t <= limit(s) && hit.t < kFar)) return;
        if (hit.t < nearest_[s]) {
            if (nearest_[s] == kFar) --unseen_;
            nearest_[s] = hit.t;
            stale_ = true;
        }
        if (winner_[s] != kNone && hit_[s].t <= limit(s)) {
            contested_[s] = true;
            if (rank_[s] < rank) return;
        } else if (contested_[s]) {
            order_mattered_ = true;
        }
        winner_[s] = triangle;
        rank_[s] = rank;
        hit_[s] = hit;
    }

    bool order_mattered() const { return order_mattered_; }
    void begin_second_pass() {
        winner_.fill(kNone);
        contested_.fill(false);
        order_mattered_ = false;
    }

    Id winner(std::size_t s) const { return winner_[s]; }
    const LineHit& hit(std::size_t s) const { return hit_[s]; }

  private:
    static constexpr double kFar = std::numeric_limits<double>::infinity();

    std::size_t count_, unseen_;
    std::array<double, kBlockSamples> nearest_{};  // the smallest t
    std::array<Id, kBlockSamples> winner_{}, rank_{};
    std::array<LineHit, kBlockSamples> hit_{};
    std::array<bool, kBlockSamples> contested_{};  // a triangle within the band of its time was turned away
    bool order_mattered_ = false;
    bool stale_ = true;
    double farthest_ = kFar;
};

}  // namespace trilens
