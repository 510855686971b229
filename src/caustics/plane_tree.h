// k-d tree over shapes in a plane, each in every leaf that it meets (Kaplan, Space-Tracing, 1985; Fussell and
// Subramanian, Fast Ray Tracing Using K-D Trees, 1988).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/math/vec.h"
#include "base/util/few.h"

namespace trilens {

struct PlaneBox {
    Vec2 low{INFINITY}, high{-INFINITY};
    void include(const Vec2& at) { low = glm::min(low, at), high = glm::max(high, at); }
    bool meets(const PlaneBox& other) const {
        return low.x <= other.high.x && other.low.x <= high.x && low.y <= other.high.y &&
               other.low.y <= high.y;
    }
};

/// Lines of one direction: those from `low` to `high` along their normal, in its lengths.
struct PlaneStrip {
    Vec2 normal{0};
    double low = 0, high = 0;
};

struct PlaneParallelogram {
    Vec2 middle{0};
    Mat2 half{1};  // of its sides

    static PlaneParallelogram of(const PlaneBox& box) {
        const Vec2 half = 0.5 * (box.high - box.low);
        return {0.5 * (box.low + box.high), Mat2(half.x, 0, 0, half.y)};
    }
    PlaneBox box() const {
        const Vec2 reach = glm::abs(half[0]) + glm::abs(half[1]);
        return {middle - reach, middle + reach};
    }
    bool is_beside(const PlaneStrip& strip) const {
        const double at = dot(strip.normal, middle);
        const double reach = std::fabs(dot(strip.normal, half[0])) + std::fabs(dot(strip.normal, half[1]));
        return at - reach > strip.high || at + reach < strip.low;
    }
};

/// Around a shape: it lies in the box and in all strips.
struct PlaneBounds {
    PlaneBox box;
    std::array<PlaneStrip, 3> strips;

    /// Of the convex hull of points. Its strips are those of its first three points' sides' directions: they
    /// part it from what is beside (separating axes).
    template <std::size_t kCount>
    static PlaneBounds of(const std::array<Vec2, kCount>& hull);

    /// `around`: the asked one's box.
    bool meets(const PlaneBox& around, const PlaneParallelogram& asked) const {
        return box.meets(around) && std::none_of(strips.begin(), strips.end(), [&](const PlaneStrip& strip) {
                   return asked.is_beside(strip);
               });
    }
};

/// Thread-safe to read.
class PlaneTree {
  public:
    PlaneTree() = default;
    /// `within`: where it is asked most; shapes beyond are found too.
    PlaneTree(std::vector<PlaneBounds> shapes, const PlaneBox& within);

    /// Calls use(shape) once for every shape whose bounds meet the asked one, in the order of their numbers.
    template <typename Use>
    void for_each_near(const PlaneParallelogram& asked, const Use& use) const;

  private:
    static constexpr std::size_t kDeepest = 28;
    struct Node {
        double split = 0;
        std::uint32_t child = 0;           // the lower one, the other is the next; 0: a leaf
        int axis = 0;                      // across which it is split
        std::uint32_t first = 0, end = 0;  // a leaf's shapes in references_
    };
    struct Open;
    struct Build;

    std::vector<PlaneBounds> shapes_;
    std::vector<Node> nodes_;
    std::vector<std::uint32_t> references_;
};

template <std::size_t kCount>
PlaneBounds PlaneBounds::of(const std::array<Vec2, kCount>& hull) {
    PlaneBounds bounds;
    for (const Vec2& point : hull) bounds.box.include(point);
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec2 side = hull[(k + 1) % 3] - hull[k];
        const Vec2 normal(-side.y, side.x);
        PlaneStrip& strip = bounds.strips[k] = {normal, INFINITY, -INFINITY};
        for (const Vec2& point : hull) {
            strip.low = std::min(strip.low, dot(normal, point));
            strip.high = std::max(strip.high, dot(normal, point));
        }
    }
    return bounds;
}

template <typename Use>
void PlaneTree::for_each_near(const PlaneParallelogram& asked, const Use& use) const {
    if (nodes_.empty()) return;
    const PlaneBox around = asked.box();
    std::array<std::uint32_t, kDeepest + 1> open;
    std::size_t open_count = 0;
    open[open_count++] = 0;
    bool is_first = true;
    Few<std::uint32_t, 64> several, both;  // of more than one leaf, in order, as those of each are
    const auto for_each_in = [&](const Node& leaf, const auto& use_shape) {
        for (std::uint32_t i = leaf.first; i < leaf.end; ++i)
            if (shapes_[references_[i]].meets(around, asked)) use_shape(references_[i]);
    };
    const auto add = [&](const Node& leaf) {
        both.clear();
        const std::uint32_t* next = several.begin();
        for_each_in(leaf, [&](std::uint32_t shape) {
            for (; next != several.end() && *next <= shape; ++next)
                if (*next < shape) both.push_back(*next);
            both.push_back(shape);
        });
        for (; next != several.end(); ++next) both.push_back(*next);
        std::swap(several, both);
    };
    while (open_count > 0) {
        const Node* node = &nodes_[open[--open_count]];
        while (node->child != 0) {
            const std::uint32_t child = node->child;
            const bool low = around.low[node->axis] <= node->split,
                       high = around.high[node->axis] >= node->split;
            if (low && high) open[open_count++] = child + 1;
            node = &nodes_[low ? child : child + 1];
        }
        if (is_first && open_count == 0) return for_each_in(*node, use);
        is_first = false;
        add(*node);
    }
    for (const std::uint32_t shape : several) use(shape);
}

}  // namespace trilens
