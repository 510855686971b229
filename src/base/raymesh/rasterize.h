// Which facet of a RayMesh each sample of the film shows.
#pragma once

#include <array>
#include <cstddef>

#include "base/math/vec.h"
#include "base/raymesh/ray_mesh.h"
#include "base/raymesh/sample_grid.h"

namespace trilens {

/// The facets' samples by the top-left rule on the screen: a sample on an edge or a corner that facets share
/// belongs to exactly one of them, also where corners are duplicated and where some lie behind the camera (w
/// <= 0). For meshes that do not fold over on the screen (cameras); where they do, the facet with the smaller
/// index wins. Facets without rays or without area on the screen own nothing.
FacetSamples rasterize_facets(const RayMesh& mesh, const SampleGrid& grid);

/// The pixels of the grid's window, numbered in rows, all of whose samples rasterize_facets() gives to one
/// facet, by that facet; but for some at edges that rounding leaves open. `grid`: in any order, with all its
/// samples.
FacetSamples pixels_in_facets(const RayMesh& mesh, const SampleGrid& grid);

// The part of a row of samples that a facet covers: decided at its ends, not sample by sample.

/// Columns of samples, counted from the window's left: those in [sure_begin, sure_end) are covered beyond any
/// rounding, those outside [begin, end) are not; the rest must be asked one by one.
/// begin <= sure_begin <= sure_end <= end.
struct RowSpan {
    std::size_t begin = 0, sure_begin = 0, sure_end = 0, end = 0;
};

/// A facet's edge functions as affine functions of the film's x and y, with a bound of every rounding on the
/// way, here and in side_of_edge: where they lie beyond the bound, side_of_edge has their sign.
class FacetEdges {
  public:
    /// `corner`: homogeneous, as in RayMesh::screen. `orientation`: the sign that the edge functions have in
    /// the facet; 0: any, all corners are in front of the camera.
    FacetEdges(const std::array<Vec3, 3>& corner, int orientation, const SampleGrid& grid);

    /// Of the samples in columns [first, last) of this row.
    RowSpan cover(std::size_t row, std::size_t first, std::size_t last) const;

  private:
    const SampleGrid grid_;
    std::array<Vec3, 3> edge_{};  // positive inside: x, y and constant
    double bound_ = 0;
    bool usable_ = false;  // false: nothing is sure
};

}  // namespace trilens
