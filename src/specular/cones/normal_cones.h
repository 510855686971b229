// Faces that may show a point: cones of normals in a bounding volume hierarchy, against the cone of the
// directions in which a normal would have to lie (Shirman and Abi-Ezzi, The Cone of Normals Technique for
// Fast Processing of Curved Patches, 1993; Walter et al., Single Scattering in Refractive Media with Triangle
// Mesh Boundaries, 2009).
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/raymesh/surface.h"

namespace trilens {

/// Of a surface with normals of any origin, as far as it bounds its faces (Surface::face_bounds).
class NormalCones {
  public:
    explicit NormalCones(const Surface& surface);

    /// Faces that may(bounds) is true of, ascending, where it is true of bounds that hold those of which it
    /// is. Faces without bounds are always among them.
    template <typename May>
    std::vector<Id> faces_where(const May& may) const {
        std::vector<Id> faces = unbounded_;
        for (std::size_t n = 0; n < nodes_.size();) {
            const Node& node = nodes_[n];
            if (!may(node.bounds)) {
                n = node.skip;
                continue;
            }
            for (std::uint32_t i = node.first; i < node.end; ++i)
                if (may(bounds_[i])) faces.push_back(static_cast<Id>(order_[i]));
            ++n;
        }
        std::sort(faces.begin(), faces.end());
        return faces;
    }

  private:
    struct Node {
        FaceBounds bounds;
        std::uint32_t skip = 0;            // the node after this one's subtree
        std::uint32_t first = 0, end = 0;  // a leaf's faces in order_
    };
    void build(const std::vector<FaceBounds>& faces, std::span<const Vec3> centres, std::uint32_t first,
               std::uint32_t end);

    std::vector<FaceBounds> bounds_;  // of order_
    std::vector<Node> nodes_;         // depth first
    std::vector<std::size_t> order_;
    std::vector<Id> unbounded_;
};

}  // namespace trilens
