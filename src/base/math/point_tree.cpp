#include "base/math/point_tree.h"

#include <numeric>
#include <span>
#include <utility>

namespace trilens {

PointTree::PointTree(std::vector<Vec3> points) : points_(std::move(points)), order_(points_.size()) {
    std::iota(order_.begin(), order_.end(), 0);
    if (!points_.empty()) build(0, points_.size());
}

void PointTree::build(std::size_t first, std::size_t last) {
    const std::size_t n = nodes_.size();
    Node node{{}, first, last, 0};
    for (std::size_t i = first; i < last; ++i) node.box.include(points_[order_[i]]);
    nodes_.push_back(node);
    if (last - first <= kFewPoints) return;
    const std::size_t half = spatial_split(points_, std::span(order_).subspan(first, last - first));
    build(first, first + half);
    nodes_[n].second_child = nodes_.size();
    build(first + half, last);
}

}  // namespace trilens
