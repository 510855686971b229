// Builds the wide tree top down by medians, so that almost all leaves are full.
#include "projector/scene/bvh.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "base/util/parallel.h"

namespace trilens {
namespace {

constexpr std::size_t kTogether = 4096;   // triangles that are worth a thread
constexpr std::size_t kWorthBins = 1024;  // so many are better cut by bins first

struct FloatBox {
    std::array<float, 3> low{INFINITY, INFINITY, INFINITY}, high{-INFINITY, -INFINITY, -INFINITY};

    void include(const FloatBox& other) {
        for (std::size_t k = 0; k < 3; ++k) {
            low[k] = std::min(low[k], other.low[k]);
            high[k] = std::max(high[k], other.high[k]);
        }
    }
};

/// The float after `f`, which is finite, upwards.
float next_above(float f) {
    if (f == 0) return std::numeric_limits<float>::denorm_min();
    const auto bits = std::bit_cast<std::uint32_t>(f);
    return std::bit_cast<float>(f > 0 ? bits + 1 : bits - 1);
}

float above(double v) {
    return next_above(static_cast<float>(v));
}

float below(double v) {
    return -above(-v);
}

struct LeafRange {
    std::size_t first = 0, last = 0;

    std::size_t size() const { return last - first; }
};

/// A part of the tree: what its children name is counted from its own beginning.
struct Part {
    std::vector<WideNode> nodes;
    std::vector<LeafRange> leaves;  // of the order
    std::int32_t root = 0;
    FloatBox box;
};

void append(const Part& part, Part& all) {
    const auto node_offset = static_cast<std::int32_t>(all.nodes.size());
    const auto leaf_offset = static_cast<std::int32_t>(all.leaves.size());
    for (WideNode node : part.nodes) {
        for (std::uint32_t lane = 0; lane < node.count; ++lane)
            node.child[lane] += node.child[lane] < 0 ? -leaf_offset : node_offset;
        all.nodes.push_back(node);
    }
    all.leaves.insert(all.leaves.end(), part.leaves.begin(), part.leaves.end());
}

class Builder {
  public:
    Builder(std::size_t count, const BoxOf& box_of) : items_(count), scratch_(count), box_(count) {
        take_boxes(box_of);
    }
    LeafTree build(std::vector<Id>& order);

  private:
    struct Item {
        std::array<float, 3> middle{};  // twice the box's, from the tree's centre
        Id triangle = 0;
    };
    void take_boxes(const BoxOf& box_of);
    void gather_around(const LeafRange& range, std::size_t place, std::size_t axis, LeafRange& among);
    std::size_t halve(const LeafRange& range, std::size_t unit);
    std::vector<LeafRange> cut(const LeafRange& range);
    Part make_leaf(const LeafRange& range) const;
    Part make(const LeafRange& range);
    Part make_node(const std::vector<LeafRange>& ranges);
    std::size_t put_large_last();
    Part make_all();

    std::vector<Item> items_, scratch_;
    std::vector<FloatBox> box_;  // by triangle
    LeafTree tree_;
};

void Builder::take_boxes(const BoxOf& box_of) {
    Box all;
    for (std::size_t i = 0; i < items_.size(); ++i) all.include(box_of(static_cast<Id>(i)));
    if (items_.empty()) return;
    tree_.centre = 0.5 * all.low + 0.5 * all.high;
    tree_.half = glm::max(all.high - tree_.centre, tree_.centre - all.low);
    parallel_for(items_.size(), kTogether, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            const Box box = box_of(static_cast<Id>(i));
            for (std::size_t k = 0; k < 3; ++k) {
                const int c = static_cast<int>(k);
                box_[i].low[k] = below(box.low[c] - tree_.centre[c]);
                box_[i].high[k] = above(box.high[c] - tree_.centre[c]);
                items_[i].middle[k] = box_[i].low[k] + box_[i].high[k];
            }
            items_[i].triangle = static_cast<Id>(i);
        }
    });
}

/// Orders a large range roughly along the axis, in three parts: what lies in the middle one, `among`, is
/// little and has the item that belongs at `place`.
void Builder::gather_around(const LeafRange& range, std::size_t place, std::size_t axis, LeafRange& among) {
    float low = INFINITY, high = -INFINITY;
    for (std::size_t i = range.first; i < range.last; ++i) {
        low = std::min(low, items_[i].middle[axis]);
        high = std::max(high, items_[i].middle[axis]);
    }
    constexpr std::size_t kBins = 256;
    const float scale = static_cast<float>(kBins - 1) / (high - low);
    if (!(scale > 0) || !std::isfinite(scale)) return;
    const auto bin_of = [&](const Item& item) {
        return static_cast<std::size_t>((item.middle[axis] - low) * scale);
    };
    std::array<std::size_t, kBins + 1> bin{};
    for (std::size_t i = range.first; i < range.last; ++i) ++bin[bin_of(items_[i])];
    std::size_t middle = 0, before = range.first;
    while (before + bin[middle] <= place) before += bin[middle++];

    std::array<std::size_t, 3> next{range.first, before, before + bin[middle]};
    among = {before, before + bin[middle]};
    for (std::size_t i = range.first; i < range.last; ++i) {
        const std::size_t b = bin_of(items_[i]);
        scratch_[next[std::size_t{b >= middle} + std::size_t{b > middle}]++] = items_[i];
    }
    std::copy_n(scratch_.begin() + static_cast<std::ptrdiff_t>(range.first), range.size(),
                items_.begin() + static_cast<std::ptrdiff_t>(range.first));
}

/// Cuts the range across its longest side, near the middle, so that the first part is a multiple of `unit`
/// where it can be. Returns where.
std::size_t Builder::halve(const LeafRange& range, std::size_t unit) {
    std::array<float, 3> low = items_[range.first].middle, high = low;
    for (std::size_t i = range.first; i < range.last; ++i) {
        for (std::size_t k = 0; k < 3; ++k) {
            low[k] = std::min(low[k], items_[i].middle[k]);
            high[k] = std::max(high[k], items_[i].middle[k]);
        }
    }
    std::size_t axis = 0;
    for (std::size_t k = 1; k < 3; ++k) {
        if (high[k] - low[k] > high[axis] - low[axis]) axis = k;
    }
    std::size_t half = (range.size() / 2 + unit - 1) / unit * unit;
    if (half == 0 || half >= range.size()) half = range.size() / 2;

    const std::size_t place = range.first + half;
    LeafRange among = range;
    if (range.size() > kWorthBins) gather_around(range, place, axis, among);
    const auto at = [&](std::size_t i) { return items_.begin() + static_cast<std::ptrdiff_t>(i); };
    std::nth_element(at(among.first), at(place), at(among.last), [axis](const Item& a, const Item& b) {
        return std::pair(a.middle[axis], a.triangle) < std::pair(b.middle[axis], b.triangle);
    });
    return place;
}

/// Up to 16 parts of a range of more than 16, all but the last full subtrees.
std::vector<LeafRange> Builder::cut(const LeafRange& range) {
    std::size_t capacity = kLanes;
    while (capacity * kLanes < range.size()) capacity *= kLanes;
    std::vector<LeafRange> parts{range};
    for (bool again = true; again;) {
        std::vector<std::size_t> middle(parts.size());
        parallel_for(parts.size(), std::max<std::size_t>(1, kTogether / capacity),
                     [&](std::size_t first, std::size_t last) {
                         for (std::size_t i = first; i < last; ++i)
                             if (parts[i].size() > capacity) middle[i] = halve(parts[i], capacity);
                     });
        std::vector<LeafRange> next;
        for (std::size_t i = 0; i < parts.size(); ++i) {
            if (parts[i].size() <= capacity) {
                next.push_back(parts[i]);
                continue;
            }
            next.push_back({parts[i].first, middle[i]});
            next.push_back({middle[i], parts[i].last});
        }
        again = next.size() > parts.size();
        parts = std::move(next);
    }
    return parts;
}

Part Builder::make_leaf(const LeafRange& range) const {
    Part part{{}, {range}, ~std::int32_t{0}, {}};
    for (std::size_t i = range.first; i < range.last; ++i) part.box.include(box_[items_[i].triangle]);
    return part;
}

Part Builder::make(const LeafRange& range) {
    if (range.size() <= kLanes) return make_leaf(range);
    return make_node(cut(range));
}

/// Over consecutive ranges.
Part Builder::make_node(const std::vector<LeafRange>& ranges) {
    const std::size_t all = ranges.back().last - ranges.front().first;
    std::vector<Part> children(ranges.size());
    parallel_for(ranges.size(), std::max<std::size_t>(1, kTogether * ranges.size() / all),
                 [&](std::size_t first, std::size_t last) {
                     for (std::size_t i = first; i < last; ++i) children[i] = make(ranges[i]);
                 });

    Part part;
    part.nodes.emplace_back();
    WideNode node{};
    node.count = static_cast<std::uint32_t>(children.size());
    for (std::size_t lane = 0; lane < children.size(); ++lane) {
        const Part& child = children[lane];
        for (std::size_t k = 0; k < 3; ++k) {
            node.low[k][lane] = child.box.low[k];
            node.high[k][lane] = child.box.high[k];
        }
        node.child[lane] = child.root < 0 ? ~static_cast<std::int32_t>(part.leaves.size())
                                          : static_cast<std::int32_t>(part.nodes.size());
        append(child, part);
        part.box.include(child.box);
    }
    part.nodes.front() = node;
    return part;
}

/// Puts the triangles that span much of the tree behind all others. Returns how many others there are.
std::size_t Builder::put_large_last() {
    constexpr double kLarge = 0.25;
    const double side = 2 * std::max(tree_.half.x, std::max(tree_.half.y, tree_.half.z));
    const auto is_small = [&](const Item& item) {
        const FloatBox& box = box_[item.triangle];
        float longest = 0;
        for (std::size_t k = 0; k < 3; ++k) longest = std::max(longest, box.high[k] - box.low[k]);
        return longest < kLarge * side;
    };
    return static_cast<std::size_t>(std::stable_partition(items_.begin(), items_.end(), is_small) -
                                    items_.begin());
}

/// Large triangles, as of a ground, have leaves of their own: among small ones they would spread the leaves'
/// boxes and error bounds over all.
Part Builder::make_all() {
    const LeafRange all{0, items_.size()};
    if (all.size() <= kLanes) return make(all);
    const LeafRange small{0, put_large_last()}, large{small.last, all.last};
    if (small.size() == 0 || large.size() == 0) return make(all);
    std::vector<LeafRange> ranges;
    if (small.size() > kLanes) ranges = cut(small);
    if (ranges.empty() || ranges.size() == kLanes) ranges = {small};
    ranges.push_back(large);
    return make_node(ranges);
}

LeafTree Builder::build(std::vector<Id>& order) {
    if (items_.empty()) return {};
    Part all = make_all();
    tree_.root = all.root;
    tree_.nodes = std::move(all.nodes);
    order.resize(items_.size());
    for (std::size_t i = 0; i < items_.size(); ++i) order[i] = items_[i].triangle;
    std::vector<Item>().swap(items_);
    std::vector<Item>().swap(scratch_);
    std::vector<FloatBox>().swap(box_);
    tree_.leaves.resize(all.leaves.size());
    for (std::size_t i = 0; i < all.leaves.size(); ++i) {
        Leaf& leaf = tree_.leaves[i];
        leaf.count = static_cast<std::uint32_t>(all.leaves[i].size());
        for (std::size_t lane = 0; lane < leaf.count; ++lane)
            leaf.triangle[lane] = static_cast<Id>(all.leaves[i].first + lane);
    }
    return std::move(tree_);
}

void fill_leaf(const PreparedScene::Data& data, Leaf& leaf) {
    Box box;
    for (std::size_t lane = 0; lane < leaf.count; ++lane)
        for (std::size_t k = 0; k < 3; ++k) box.include(data.corner(k, leaf.triangle[lane], Vec3(0)));
    const Vec3 centre = 0.5 * box.low + 0.5 * box.high;
    for (int k = 0; k < 3; ++k) leaf.centre[k] = centre[k];
    for (std::size_t lane = 0; lane < leaf.count; ++lane) {
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3 corner = data.corner(k, leaf.triangle[lane], centre);
            leaf.x[k][lane] = static_cast<float>(corner.x);
            leaf.y[k][lane] = static_cast<float>(corner.y);
            leaf.z[k][lane] = static_cast<float>(corner.z);
            for (int c = 0; c < 3; ++c) leaf.half[c] = std::max(leaf.half[c], above(std::fabs(corner[c])));
        }
    }
}

}  // namespace

LeafTree cut_leaf_tree(std::size_t count, const BoxOf& box_of, std::vector<Id>& order) {
    return Builder(count, box_of).build(order);
}

void fill_leaves(const PreparedScene::Data& data, LeafTree& tree) {
    parallel_for(tree.leaves.size(), kTogether / kLanes, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) fill_leaf(data, tree.leaves[i]);
    });
}

}  // namespace trilens
