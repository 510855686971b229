// A k-d tree over points: which of them lie near a place (Bentley, Multidimensional binary search trees used
// for associative searching, 1975).
#pragma once

#include <cstddef>
#include <vector>

#include "base/math/box.h"
#include "base/math/vec.h"

namespace trilens {

/// Finite points, which may lie at one place. Building takes O(n log n) comparisons, also of points in a
/// plane or on a line along an axis.
class PointTree {
  public:
    explicit PointTree(std::vector<Vec3> points);

    /// Calls use(k) for each point k with length(point - place) <= reach, until one call returns true, and
    /// returns whether one did. The order is a matter of the points alone.
    template <typename Use>
    bool any_within(const Vec3& place, double reach, Use&& use) const {
        return !nodes_.empty() && any_below(0, place, reach, use);
    }

  private:
    static constexpr std::size_t kFewPoints = 8;

    /// Its first child follows it.
    struct Node {
        Box box;
        std::size_t first = 0, last = 0;  // its points are order_[first .. last)
        std::size_t second_child = 0;     // 0: a leaf
    };

    void build(std::size_t first, std::size_t last);

    static bool is_beyond(const Box& box, const Vec3& place, double reach) {
        const Vec3 away = glm::max(box.low - place, place - box.high);
        return away.x > reach || away.y > reach || away.z > reach;
    }

    template <typename Use>
    bool any_below(std::size_t n, const Vec3& place, double reach, Use& use) const {
        const Node& node = nodes_[n];
        if (is_beyond(node.box, place, reach)) return false;
        if (node.second_child != 0)
            return any_below(n + 1, place, reach, use) || any_below(node.second_child, place, reach, use);
        for (std::size_t i = node.first; i < node.last; ++i)
            if (length(points_[order_[i]] - place) <= reach && use(order_[i])) return true;
        return false;
    }

    std::vector<Vec3> points_;
    std::vector<std::size_t> order_;
    std::vector<Node> nodes_;
};

}  // namespace trilens
