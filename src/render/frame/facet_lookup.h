// Which facet of a grid holds a parameter position.
#pragma once

#include <cstddef>
#include <vector>

#include "base/raymesh/surface.h"

namespace trilens {

/// Every face's parameters in bins that know the facets which reach into them. The grid must live longer.
class FacetLookup {
  public:
    FacetLookup(const SurfaceGrid& grid, std::size_t faces);

    /// The first of the grid's facets that holds the position of the face; kNone where rounding leaves it in
    /// none.
    Id at(Id face, const Vec2& uv) const;

  private:
    struct FaceBins {
        std::size_t first = 0;  // of its side * side bins, row by row
        std::size_t side = 1;
    };
    template <typename Body>
    void for_each_bin(std::size_t facet, const Body& body) const;
    std::size_t cell_of(double x, const FaceBins& bins) const;

    const SurfaceGrid& grid_;
    std::vector<FaceBins> faces_;
    std::vector<std::size_t> begin_;  // per bin, and one more: into facets_
    std::vector<Id> facets_;          // ascending in each bin
};

}  // namespace trilens
