// Builds the tree top down: each node is cut where the surface area heuristic says it costs least. The items
// themselves are moved, each a small box in single precision, so that every pass reads memory in order; the
// uppermost cuts are made first, then the trees below them side by side.
#include "projector/scene/bvh.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include "base/util/parallel.h"

namespace trilens {
namespace {

constexpr std::size_t kMostBins = 16, kFewBins = 8;
constexpr std::size_t kFewItems = 64;  // up to here few bins do
constexpr std::size_t kSmallLeaf = 4, kLargeLeaf = 16;
constexpr float kNodeCost = 0.5f;  // of testing a node's box against a beam, in units of testing one triangle
/// Trees below the uppermost cuts: at least so many of them where there are many items, none too small.
constexpr std::size_t kTrees = 64, kSmallestTree = 4096;

/// Three coordinates and room for a fourth, so that the compiler takes them together.
struct alignas(16) Four {
    std::array<float, 4> v{};
};

Four smaller(const Four& a, const Four& b) {
    Four r;
    for (std::size_t k = 0; k < 4; ++k) r.v[k] = a.v[k] < b.v[k] ? a.v[k] : b.v[k];
    return r;
}

Four larger(const Four& a, const Four& b) {
    Four r;
    for (std::size_t k = 0; k < 4; ++k) r.v[k] = a.v[k] > b.v[k] ? a.v[k] : b.v[k];
    return r;
}

constexpr float kInfinity = std::numeric_limits<float>::infinity();

struct Bounds {
    Four low{{kInfinity, kInfinity, kInfinity, kInfinity}};
    Four high{{-kInfinity, -kInfinity, -kInfinity, -kInfinity}};

    void include(const Four& from, const Four& to) {
        low = smaller(low, from);
        high = larger(high, to);
    }
    void include(const Bounds& other) { include(other.low, other.high); }
    float half_area() const {
        std::array<float, 3> size{};
        for (std::size_t k = 0; k < 3; ++k) size[k] = std::max(high.v[k] - low.v[k], 0.0f);
        return size[0] * size[1] + size[1] * size[2] + size[2] * size[0];
    }
};

/// The fourth place holds the item's number.
struct Item {
    Four low, high;

    void set_id(Id id) { low.v[3] = std::bit_cast<float>(id); }
    Id id() const { return std::bit_cast<Id>(low.v[3]); }

    /// Twice the centre: only comparisons are made with it.
    Four centre() const {
        Four c;
        for (std::size_t k = 0; k < 4; ++k) c.v[k] = low.v[k] + high.v[k];
        return c;
    }
};

/// Items first .. first + count - 1 and the bounds of their centres.
struct NodeRange {
    std::size_t first = 0, count = 0;
    Bounds centres;
};

/// Sorts each axis' centres into bins of equal width.
struct Binning {
    Four low, scale;
    std::size_t bins = kMostBins;

    explicit Binning(const NodeRange& range)
        : low(range.centres.low), bins(range.count <= kFewItems ? kFewBins : kMostBins) {
        for (std::size_t k = 0; k < 3; ++k) {
            const float extent = range.centres.high.v[k] - low.v[k];
            const float per_unit = static_cast<float>(bins) / extent;
            scale.v[k] = extent > 0 && per_unit < kInfinity ? per_unit : 0;
        }
    }
    std::size_t bin(const Four& centre, std::size_t axis) const {
        const float at = (centre.v[axis] - low.v[axis]) * scale.v[axis];
        return std::min(bins - 1, static_cast<std::size_t>(static_cast<int>(at)));
    }
};

struct Cut {
    float cost = kInfinity;
    std::size_t axis = 0;
    std::size_t bin = 0;  // items in bins below go left; 0: all centres coincide
};

struct Bin {
    Bounds bounds;
    std::size_t size = 0;
};

using Bins = std::array<std::array<Bin, kMostBins>, 3>;

Bins fill_bins(const std::vector<Item>& items, const NodeRange& range, const Binning& binning) {
    Bins bins;
    for (std::size_t i = range.first; i < range.first + range.count; ++i) {
        const Four centre = items[i].centre();
        for (std::size_t axis = 0; axis < 3; ++axis) {
            Bin& bin = bins[axis][binning.bin(centre, axis)];
            bin.bounds.include(items[i].low, items[i].high);
            ++bin.size;
        }
    }
    return bins;
}

/// Sweeps an axis from the right for the costs of the right sides, then from the left for the sums.
void improve_cut(const std::array<Bin, kMostBins>& bins, std::size_t count, std::size_t axis, Cut& best) {
    std::array<float, kMostBins> right_cost{};
    Bounds right;
    std::size_t right_size = 0;
    for (std::size_t b = count - 1; b > 0; --b) {
        right.include(bins[b].bounds);
        right_size += bins[b].size;
        right_cost[b] = right_size > 0 ? right.half_area() * static_cast<float>(right_size) : -1;
    }
    Bounds left;
    std::size_t left_size = 0;
    for (std::size_t b = 1; b < count; ++b) {
        left.include(bins[b - 1].bounds);
        left_size += bins[b - 1].size;
        if (left_size == 0 || right_cost[b] < 0) continue;
        const float cost = left.half_area() * static_cast<float>(left_size) + right_cost[b];
        if (cost < best.cost) best = {cost, axis, b};
    }
}

/// The cut of a node with these bins; none where it is better a leaf.
bool choose_cut(const Bins& bins, const Binning& binning, std::size_t count, Cut& cut) {
    for (std::size_t axis = 0; axis < 3; ++axis)
        if (binning.scale.v[axis] > 0) improve_cut(bins[axis], binning.bins, axis, cut);
    Bounds bounds;
    for (std::size_t b = 0; b < binning.bins; ++b) bounds.include(bins[0][b].bounds);
    const float area = bounds.half_area();
    return count > kLargeLeaf || area * static_cast<float>(count) > cut.cost + kNodeCost * area;
}

/// Reorders the items of a range by the cut; both sides get at least one.
std::pair<NodeRange, NodeRange> split(std::vector<Item>& items, const NodeRange& range,
                                      const Binning& binning, const Cut& cut) {
    NodeRange left{range.first, 0, {}}, right;
    std::size_t end = range.first + range.count;
    if (cut.bin == 0) {
        left = {range.first, range.count / 2, range.centres};
        return {left, {range.first + left.count, range.count - left.count, range.centres}};
    }
    for (std::size_t i = range.first; i < end;) {
        const Four centre = items[i].centre();
        if (binning.bin(centre, cut.axis) < cut.bin) {
            left.centres.include(centre, centre);
            ++i;
        } else {
            right.centres.include(centre, centre);
            std::swap(items[i], items[--end]);
        }
    }
    left.count = end - range.first;
    right.first = end;
    right.count = range.count - left.count;
    return {left, right};
}

/// A node that waits to be built.
struct WaitingNode {
    std::size_t node = 0;
    NodeRange range;
};

/// Builds the tree over `root` in `nodes`, whose node 0 it is. Ranges of at most `stop` items are left to
/// `rest` instead.
void build(std::vector<Item>& items, const NodeRange& root, std::vector<BvhNode>& nodes, std::size_t stop,
           std::vector<WaitingNode>& rest) {
    nodes.resize(1);
    std::vector<WaitingNode> open{{0, root}};
    while (!open.empty()) {
        const WaitingNode now = open.back();
        open.pop_back();
        const NodeRange& range = now.range;
        nodes[now.node].first = static_cast<Id>(range.first);
        nodes[now.node].count = static_cast<Id>(range.count);
        if (range.count <= stop) {
            rest.push_back(now);
            continue;
        }
        if (range.count <= kSmallLeaf) continue;
        const Binning binning(range);
        Cut cut;
        if (!choose_cut(fill_bins(items, range, binning), binning, range.count, cut)) continue;
        const auto [left, right] = split(items, range, binning, cut);
        const std::size_t child = nodes.size();
        nodes.resize(child + 2);
        nodes[now.node].first = static_cast<Id>(child);
        nodes[now.node].count = 0;
        open.push_back({child + 1, right});
        open.push_back({child, left});
    }
}

/// Puts a tree, built by itself, in the place of its root.
void graft(const std::vector<BvhNode>& tree, std::size_t place, std::vector<BvhNode>& nodes) {
    const std::size_t base = nodes.size() - 1;  // the tree's node 1 comes next
    const auto moved = [&](BvhNode node) {
        if (node.count == 0) node.first += static_cast<Id>(base);
        return node;
    };
    nodes[place] = moved(tree[0]);
    for (std::size_t i = 1; i < tree.size(); ++i) nodes.push_back(moved(tree[i]));
}

/// The boxes in single precision, in units of the largest extent and from its corner: as fine as that allows
/// wherever the items lie.
std::vector<Item> small_items(std::size_t count, const BoxOf& box_of) {
    constexpr std::size_t kTogether = 4096;
    std::vector<Box> parts((count + kTogether - 1) / kTogether);
    parallel_for(parts.size(), 1, [&](std::size_t from, std::size_t to) {
        for (std::size_t p = from; p < to; ++p)
            for (std::size_t i = p * kTogether; i < std::min(count, (p + 1) * kTogether); ++i)
                parts[p].include(box_of(static_cast<Id>(i)));
    });
    Box all;
    for (const Box& part : parts) all.include(part);
    const Vec3 size = all.size();
    const double extent = std::max({size.x, size.y, size.z});
    const double scale = extent > 0 && std::isfinite(1 / extent) ? 1 / extent : 0;

    std::vector<Item> items(count);
    parallel_for(count, kTogether, [&](std::size_t from, std::size_t to) {
        for (std::size_t i = from; i < to; ++i) {
            const Box box = box_of(static_cast<Id>(i));
            const Vec3 low = scale * (box.low - all.low), high = scale * (box.high - all.low);
            for (int k = 0; k < 3; ++k) {
                items[i].low.v[static_cast<std::size_t>(k)] = static_cast<float>(low[k]);
                items[i].high.v[static_cast<std::size_t>(k)] = static_cast<float>(high[k]);
            }
            items[i].set_id(static_cast<Id>(i));
        }
    });
    return items;
}

}  // namespace

Bvh build_bvh(std::size_t count, const BoxOf& box_of) {
    if (count == 0) return {};
    std::vector<Item> items = small_items(count, box_of);
    NodeRange root{0, count, {}};
    for (const Item& item : items) root.centres.include(item.centre(), item.centre());

    Bvh bvh;
    std::vector<WaitingNode> trees;
    build(items, root, bvh.nodes, std::max(count / kTrees, kSmallestTree), trees);
    std::vector<std::vector<BvhNode>> built(trees.size());
    parallel_for(trees.size(), 1, [&](std::size_t from, std::size_t to) {
        std::vector<WaitingNode> none;
        for (std::size_t t = from; t < to; ++t) build(items, trees[t].range, built[t], 0, none);
    });
    std::size_t total = bvh.nodes.size();
    for (const auto& tree : built) total += tree.size();
    bvh.nodes.reserve(total);
    for (std::size_t t = 0; t < trees.size(); ++t) {
        graft(built[t], trees[t].node, bvh.nodes);
        built[t] = {};
    }
    bvh.order.resize(count);
    for (std::size_t i = 0; i < count; ++i) bvh.order[i] = items[i].id();
    return bvh;
}

void fit_boxes(Bvh& bvh, const BoxOf& box_at) {
    parallel_for(bvh.nodes.size(), 4096, [&](std::size_t from, std::size_t to) {
        for (std::size_t n = from; n < to; ++n) {
            BvhNode& node = bvh.nodes[n];
            node.box = {};
            for (Id i = node.first; i < node.first + node.count; ++i) node.box.include(box_at(i));
        }
    });
    for (std::size_t n = bvh.nodes.size(); n-- > 0;) {
        BvhNode& node = bvh.nodes[n];
        if (node.count > 0) continue;
        node.box = bvh.nodes[node.first].box;
        node.box.include(bvh.nodes[node.first + 1].box);
    }
}

}  // namespace trilens
