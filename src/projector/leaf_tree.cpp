// Builds the wide tree top down by medians, so that all leaves but the last are full.
#include "projector/leaf_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "base/parallel.h"
#include "projector/prepared_scene.h"

namespace trilens {
namespace {

constexpr std::size_t kTogether = 4096;  // triangles that are worth a thread

struct FloatBox {
    std::array<float, 3> low{INFINITY, INFINITY, INFINITY}, high{-INFINITY, -INFINITY, -INFINITY};

    void include(const FloatBox& other) {
        for (std::size_t k = 0; k < 3; ++k) {
            low[k] = std::min(low[k], other.low[k]);
            high[k] = std::max(high[k], other.high[k]);
        }
    }
};

float below(double v) {
    return std::nextafterf(static_cast<float>(v), -INFINITY);
}

float above(double v) {
    return std::nextafterf(static_cast<float>(v), INFINITY);
}

struct Range {
    std::size_t first = 0, last = 0;

    std::size_t size() const { return last - first; }
};

class Builder {
  public:
    Builder(std::size_t count, const BoxOf& box_of) : items_(count), box_(count) { take_boxes(box_of); }
    LeafTree build(std::vector<Id>& order);

  private:
    struct Item {
        std::array<float, 3> middle{};  // twice the box's, from the tree's centre
        Id triangle = 0;
    };
    void take_boxes(const BoxOf& box_of);
    FloatBox bounds(const Range& range) const;
    std::size_t halve(const Range& range, std::size_t unit);
    std::int32_t add_leaf(const Range& range);
    std::int32_t add(const Range& range);

    std::vector<Item> items_;
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

FloatBox Builder::bounds(const Range& range) const {
    FloatBox box;
    for (std::size_t i = range.first; i < range.last; ++i) box.include(box_[items_[i].triangle]);
    return box;
}

/// Cuts the range across its longest side, near the middle, so that the first part is a multiple of `unit`
/// where it can be. Returns where.
std::size_t Builder::halve(const Range& range, std::size_t unit) {
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
    const auto begin = items_.begin() + static_cast<std::ptrdiff_t>(range.first);
    std::nth_element(begin, begin + static_cast<std::ptrdiff_t>(half),
                     items_.begin() + static_cast<std::ptrdiff_t>(range.last),
                     [axis](const Item& a, const Item& b) {
                         return std::pair(a.middle[axis], a.triangle) < std::pair(b.middle[axis], b.triangle);
                     });
    return range.first + half;
}

std::int32_t Builder::add_leaf(const Range& range) {
    Leaf leaf{};
    leaf.count = static_cast<std::uint32_t>(range.size());
    for (std::size_t lane = 0; lane < range.size(); ++lane)
        leaf.triangle[lane] = static_cast<Id>(range.first + lane);
    tree_.leaves.push_back(leaf);
    return ~static_cast<std::int32_t>(tree_.leaves.size() - 1);
}

std::int32_t Builder::add(const Range& range) {
    if (range.size() <= kLanes) return add_leaf(range);
    std::size_t capacity = kLanes;  // of a child: a full subtree
    while (capacity * kLanes < range.size()) capacity *= kLanes;

    std::vector<Range> parts{range};
    for (bool again = true; again;) {
        again = false;
        std::vector<Range> next;
        for (const Range& part : parts) {
            if (part.size() <= capacity) {
                next.push_back(part);
                continue;
            }
            const std::size_t middle = halve(part, capacity);
            next.push_back({part.first, middle});
            next.push_back({middle, part.last});
            again = true;
        }
        parts = std::move(next);
    }

    const std::size_t id = tree_.nodes.size();
    tree_.nodes.emplace_back();
    WideNode node{};
    node.count = static_cast<std::uint32_t>(parts.size());
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
        const FloatBox box = lane < parts.size() ? bounds(parts[lane]) : FloatBox{};
        for (std::size_t k = 0; k < 3; ++k) {
            node.low[k][lane] = lane < parts.size() ? box.low[k] : 0;
            node.high[k][lane] = lane < parts.size() ? box.high[k] : 0;
        }
        if (lane < parts.size()) node.child[lane] = add(parts[lane]);
    }
    tree_.nodes[id] = node;
    return static_cast<std::int32_t>(id);
}

LeafTree Builder::build(std::vector<Id>& order) {
    if (items_.empty()) return {};
    tree_.leaves.reserve(items_.size() / kLanes + 16);
    tree_.root = add({0, items_.size()});
    order.resize(items_.size());
    for (std::size_t i = 0; i < items_.size(); ++i) order[i] = items_[i].triangle;
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
