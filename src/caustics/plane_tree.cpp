#include "caustics/plane_tree.h"

#include <numeric>
#include <queue>
#include <utility>

namespace trilens {
namespace {

constexpr std::size_t kPerLeaf = 8;
/// Shapes stand in so many leaves in the mean at most.
constexpr std::size_t kMostCopies = 6;
/// A leaf is left whole where halving it so often in turn brought two leaves that hold more than this share
/// of twice its shapes.
constexpr int kMostVain = 3;
constexpr double kVain = 0.9;

}  // namespace

/// A leaf that may be divided.
struct PlaneTree::Open {
    std::uint32_t node = 0;
    std::size_t depth = 0;
    int vain = 0;  // halvings, in turn
    PlaneBox cell, asked;
    std::vector<std::uint32_t> shapes;

    /// Shapes that are asked for there, were all of the plane asked alike.
    double cost() const {
        const Vec2 wide = asked.high - asked.low;
        return wide.x * wide.y * static_cast<double>(shapes.size());
    }
    bool operator<(const Open& other) const {
        if (cost() != other.cost()) return cost() < other.cost();
        return node > other.node;
    }
};

struct PlaneTree::Build {
    PlaneTree& tree;
    std::priority_queue<Open> queue{};
    std::size_t room = 0;  // for more copies

    void close(const Open& leaf) {
        Node& node = tree.nodes_[leaf.node];
        node.first = static_cast<std::uint32_t>(tree.references_.size());
        tree.references_.insert(tree.references_.end(), leaf.shapes.begin(), leaf.shapes.end());
        node.end = static_cast<std::uint32_t>(tree.references_.size());
    }

    std::vector<std::uint32_t> shapes_in(const PlaneBox& cell,
                                         const std::vector<std::uint32_t>& shapes) const {
        std::vector<std::uint32_t> found;
        const PlaneParallelogram whole = PlaneParallelogram::of(cell);
        for (const std::uint32_t shape : shapes)
            if (tree.shapes_[shape].meets(cell, whole)) found.push_back(shape);
        return found;
    }

    void divide(const Open& leaf) {
        const Vec2 wide = leaf.asked.high - leaf.asked.low;
        const int axis = wide.x > wide.y ? 0 : 1;
        if (leaf.shapes.size() <= kPerLeaf || leaf.depth >= kDeepest || !(wide[axis] > 0)) return close(leaf);
        const double split = 0.5 * (leaf.asked.low[axis] + leaf.asked.high[axis]);
        Open low = {0, leaf.depth + 1, 0, leaf.cell, leaf.asked, {}}, high = low;
        low.cell.high[axis] = low.asked.high[axis] = split;
        high.cell.low[axis] = high.asked.low[axis] = split;
        low.shapes = shapes_in(low.cell, leaf.shapes);
        high.shapes = shapes_in(high.cell, leaf.shapes);

        const std::size_t before = leaf.shapes.size(), after = low.shapes.size() + high.shapes.size();
        const bool is_vain = static_cast<double>(after) > 2 * kVain * static_cast<double>(before);
        if (after > before + room || (is_vain && leaf.vain == kMostVain)) return close(leaf);
        if (after > before) room -= after - before;
        low.vain = high.vain = is_vain ? leaf.vain + 1 : 0;
        low.node = static_cast<std::uint32_t>(tree.nodes_.size()), high.node = low.node + 1;
        Node& node = tree.nodes_[leaf.node];
        node.split = split, node.axis = axis, node.child = low.node;
        tree.nodes_.resize(tree.nodes_.size() + 2);
        queue.push(std::move(low)), queue.push(std::move(high));
    }
};

PlaneTree::PlaneTree(std::vector<PlaneBounds> shapes, const PlaneBox& within) : shapes_(std::move(shapes)) {
    if (shapes_.empty()) return;
    Open all{0, 0, 0, within, within, {}};
    for (const PlaneBounds& one : shapes_) all.cell.include(one.box.low), all.cell.include(one.box.high);
    all.shapes.resize(shapes_.size());
    std::iota(all.shapes.begin(), all.shapes.end(), std::uint32_t{0});
    nodes_.emplace_back();
    Build build{*this, {}, (kMostCopies - 1) * shapes_.size()};
    build.queue.push(std::move(all));
    while (!build.queue.empty()) {
        const Open leaf = build.queue.top();
        build.queue.pop();
        build.divide(leaf);
    }
}

}  // namespace trilens
