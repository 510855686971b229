// A tree of rounded cones over beams: which of them may come to a point.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "caustics/beams/beams.h"

namespace trilens {

/// Of the beams as they are when it is made; it keeps no reference to them. It holds each beam as a curved
/// one: all that a quadratic through the ends and the middles of a beam's sides makes on a plane.
class BeamTree {
  public:
    /// The exact rays at the middles of a beam's sides.
    using Middles = std::function<std::array<const BeamEnd*, 3>(Id beam)>;

    BeamTree() = default;
    BeamTree(const Beams& beams, const Middles& middles);

    /// Calls use(beam) for every beam that may come nearer to `point` than `reach`, and some others, in an
    /// order that is always the same.
    template <typename Use>
    void for_each_near(const Vec3& point, double reach, const Use& use) const {
        for (std::size_t n = 0; n < nodes_.size();) {
            const Node& node = nodes_[n];
            if (!node.holds(point, reach)) {
                n = node.skip;
                continue;
            }
            for (std::uint32_t i = node.first; i < node.end; ++i) use(order_[i]);
            ++n;
        }
    }

  private:
    /// All rays below it lie in the union of the balls around center + s axis of radius + s sine, s >= 0.
    struct Node {
        Vec3 center{0};
        double radius = 0;
        Vec3 axis{0};
        double sine = 2, cosine = 0;       // of half the opening angle; 2: no cone holds the directions
        std::uint32_t skip = 0;            // the node after this one's subtree
        std::uint32_t first = 0, end = 0;  // a leaf's beams in order_

        bool holds(const Vec3& point, double reach) const;
    };
    struct Build;
    void build(const Build& of, std::uint32_t first, std::uint32_t end);

    std::vector<Node> nodes_;  // depth first
    std::vector<Id> order_;    // of beams
};

}  // namespace trilens
