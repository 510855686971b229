// Which few of a face's many patch points its surface at one place is made of.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "base/math/vec.h"
#include "base/raymesh/surface.h"

namespace trilens {

/// A face's sub-patches: dyadic parts of its domain, each made of a few patch points, of which there are
/// hundreds around an extraordinary vertex. Found once for all faces of a kind; immutable.
class SubPatches {
  public:
    /// Which patch points have a weight at (u, v), in rising order. Sub-patches differ in their points; their
    /// borders are those of halves, of halves of these, and so on `depth` times.
    using UsedPoints = std::function<std::vector<int>(const Vec2& uv)>;
    SubPatches(FaceDomain domain, int depth, const UsedPoints& used);

    /// The points of the sub-patch that holds (u, v) of the domain; a border belongs to what lies beyond it.
    /// Empty where parts are smaller than they were looked for.
    std::span<const int> points_at(const Vec2& uv) const;

    std::size_t bytes() const { return nodes_.capacity() * sizeof(Node) + points_.capacity() * sizeof(int); }

  private:
    /// A part of the domain: four nodes from `first` on, or `count` points.
    struct Node {
        std::size_t first = 0, count = 0;
        bool is_leaf = true;
    };
    struct Part;

    void divide(std::size_t at, const Part& part, const UsedPoints& used);
    void set_points(std::size_t at, const std::vector<int>& points);

    FaceDomain domain_;
    int depth_;
    std::vector<Node> nodes_;  // the whole domain first
    std::vector<int> points_;
};

}  // namespace trilens
