// Visibility among overlapping facets on the film: the nearest facet over a position.
#pragma once

#include <optional>
#include <vector>

#include "base/raymesh/ray_mesh.h"

namespace trilens {

/// A facet at a place of the film.
struct CoveringFacet {
    Id facet = kNone;
    Vec3 weights{0};   // of its corners, sum 1
    double depth = 0;  // w of the screen positions, interpolated
};

/// Facets on the film, sorted into squares of it. Facets with a corner of w <= 0 cover nothing. Thread-safe
/// to read.
class NestedCover {
  public:
    NestedCover() = default;
    /// `outline`: screen positions and facets are asked, no rays. Must live longer. `covers`: per facet.
    NestedCover(const RayMesh& outline, std::vector<char> covers);

    /// The facet of least depth over a place; places on a facet's border belong to it, and of two equal ones
    /// the one of the lower number counts.
    std::optional<CoveringFacet> at(const Vec2& pixel) const;

    /// Whether facets that cover anything have bounds near this part of the film's plane: false only where
    /// none covers a place of it.
    bool may_cover(const Vec2& low, const Vec2& high) const;

    /// Pixels of the film's plane that its bounds take; 0: it covers nothing.
    double area() const;
    /// The root of the mean area of the facets that cover anything, in pixels.
    double facet_size() const { return facet_size_; }

  private:
    Vec2 low_{0}, high_{0};
    double square_ = 1, facet_size_ = 0;  // pixels
    std::size_t across_ = 0, down_ = 0;
    std::vector<std::size_t> first_;  // per square, and one more: into facet_
    std::vector<Id> facet_;
    std::vector<FacetWeights> weights_;  // per facet
    const RayMesh* outline_ = nullptr;
};

}  // namespace trilens
