// The first triangle along one ray, with ties in depth resolved whatever the order of arrival.
#pragma once

#include <limits>

#include "base/raymesh/triangle_scene.h"
#include "projector/exact/exact_hit.h"

namespace trilens {

/// Among the triangles whose t is within kDepthTie of the smallest, the one with the smallest rank. A rival
/// may leave that band after it has driven out another that stays; `order_mattered` then asks for a second
/// pass over the same triangles, which starts with the smallest t known and so is exact.
class FirstHit {
  public:
    /// No triangle beyond this t can change the hit.
    double limit() const { return nearest_ * (1 + kDepthTie); }

    void offer(const LineHit& hit, Id triangle, Id rank) {
        if (!(hit.t >= 0 && hit.t <= limit() && hit.t < kFar)) return;
        if (hit.t < nearest_) nearest_ = hit.t;
        if (winner_ != kNone && hit_.t <= limit()) {
            contested_ = true;
            if (rank_ < rank) return;
        } else if (contested_) {
            order_mattered_ = true;
        }
        winner_ = triangle;
        rank_ = rank;
        hit_ = hit;
    }

    bool order_mattered() const { return order_mattered_; }
    void begin_second_pass() {
        winner_ = kNone;
        contested_ = order_mattered_ = false;
    }

    Id winner() const { return winner_; }  // kNone: nothing is hit
    const LineHit& hit() const { return hit_; }

  private:
    static constexpr double kFar = std::numeric_limits<double>::infinity();

    double nearest_ = kFar;  // the smallest t
    Id winner_ = kNone, rank_ = 0;
    LineHit hit_;
    bool contested_ = false;  // a triangle within the band of its time was turned away
    bool order_mattered_ = false;
};

}  // namespace trilens
