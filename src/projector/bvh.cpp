// Builds the tree top down: each node is cut where the surface area heuristic says it costs least.
#include "projector/bvh.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

namespace trilens {
namespace {

constexpr std::size_t kBins = 16;
constexpr std::size_t kSmallLeaf = 4, kLargeLeaf = 16;
constexpr double kNodeCost = 0.5;  // of testing a node's box against a beam, in units of testing one triangle

double half_area(const Box& box) {
    const Vec3 size = glm::max(box.high - box.low, Vec3(0));
    return size.x * size.y + size.y * size.z + size.z * size.x;
}

/// Twice the centre: only comparisons are made with it.
Vec3 centre(const Box& box) {
    return box.low + box.high;
}

struct Cut {
    double cost = std::numeric_limits<double>::infinity();
    int axis = 0;
    std::size_t bin = 0;  // items in bins below go left
};

/// Sorts an axis' centres into bins of equal width.
struct Binning {
    double low = 0, scale = 0;

    Binning(const Box& centres, int axis) : low(centres.low[axis]) {
        const double extent = centres.high[axis] - low;
        scale = extent > 0 ? static_cast<double>(kBins) / extent : 0;
    }
    bool usable() const { return scale > 0 && scale < std::numeric_limits<double>::infinity(); }
    std::size_t bin(double at) const {
        return std::min(kBins - 1, static_cast<std::size_t>((at - low) * scale));
    }
};

struct Builder {
    std::span<const Box> boxes;
    Bvh bvh;

    void build(std::size_t node, std::size_t first, std::size_t count);
    Cut best_cut(std::size_t first, std::size_t count, const Box& centres, int axis) const;
    std::size_t split(std::size_t first, std::size_t count, const Box& centres, const Cut& cut);
};

Cut Builder::best_cut(std::size_t first, std::size_t count, const Box& centres, int axis) const {
    const Binning binning(centres, axis);
    if (!binning.usable()) return {};

    std::array<Box, kBins> box;
    std::array<std::size_t, kBins> size{};
    for (std::size_t i = first; i < first + count; ++i) {
        const Box& item = boxes[bvh.order[i]];
        const std::size_t b = binning.bin(centre(item)[axis]);
        box[b].include(item);
        ++size[b];
    }

    // Sweep from the right for the costs of the right sides, then from the left for the sums.
    std::array<double, kBins> right_cost{};
    Box right;
    std::size_t right_size = 0;
    for (std::size_t b = kBins - 1; b > 0; --b) {
        right.include(box[b]);
        right_size += size[b];
        right_cost[b] = right_size > 0 ? half_area(right) * static_cast<double>(right_size) : -1;
    }
    Cut best;
    Box left;
    std::size_t left_size = 0;
    for (std::size_t b = 1; b < kBins; ++b) {
        left.include(box[b - 1]);
        left_size += size[b - 1];
        if (left_size == 0 || right_cost[b] < 0) continue;
        const double cost = half_area(left) * static_cast<double>(left_size) + right_cost[b];
        if (cost < best.cost) best = {cost, axis, b};
    }
    return best;
}

/// Reorders the items and returns how many go left; both sides get at least one.
std::size_t Builder::split(std::size_t first, std::size_t count, const Box& centres, const Cut& cut) {
    const auto begin = bvh.order.begin() + static_cast<std::ptrdiff_t>(first);
    if (cut.bin == 0) return count / 2;  // all centres coincide: no cut is better than another
    const Binning binning(centres, cut.axis);
    const auto middle = std::partition(begin, begin + static_cast<std::ptrdiff_t>(count), [&](Id item) {
        return binning.bin(centre(boxes[item])[cut.axis]) < cut.bin;
    });
    return static_cast<std::size_t>(middle - begin);
}

void Builder::build(std::size_t node, std::size_t first, std::size_t count) {
    Box bounds, centres;
    for (std::size_t i = first; i < first + count; ++i) {
        bounds.include(boxes[bvh.order[i]]);
        centres.include(centre(boxes[bvh.order[i]]));
    }
    bvh.nodes[node] = {bounds, static_cast<Id>(first), static_cast<Id>(count)};
    if (count <= kSmallLeaf) return;

    Cut cut;
    for (int axis = 0; axis < 3; ++axis) {
        const Cut candidate = best_cut(first, count, centres, axis);
        if (candidate.cost < cut.cost) cut = candidate;
    }
    const double leaf_cost = half_area(bounds) * static_cast<double>(count);
    if (count <= kLargeLeaf && leaf_cost <= cut.cost + kNodeCost * half_area(bounds)) return;

    const std::size_t left = split(first, count, centres, cut);
    const std::size_t child = bvh.nodes.size();
    bvh.nodes.resize(child + 2);
    bvh.nodes[node].first = static_cast<Id>(child);
    bvh.nodes[node].count = 0;
    build(child, first, left);
    build(child + 1, first + left, count - left);
}

}  // namespace

Bvh build_bvh(std::span<const Box> boxes) {
    if (boxes.empty()) return {};
    Builder builder{boxes, {}};
    builder.bvh.order.resize(boxes.size());
    std::iota(builder.bvh.order.begin(), builder.bvh.order.end(), Id{0});
    builder.bvh.nodes.reserve(boxes.size() / 2 + 8);
    builder.bvh.nodes.resize(1);
    builder.build(0, 0, boxes.size());
    return std::move(builder.bvh);
}

}  // namespace trilens
