// Bounding volume hierarchy over a surface's cells: groups of faces, faces, halved cells.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "base/raymesh/surface.h"
#include "specular/cell_bounds.h"

namespace trilens {

/// A box of a face's parameters.
struct CellBox {
    Id face = kNone;
    Vec2 low{0}, high{1};

    Vec2 middle() const { return 0.5 * (low + high); }
    Vec2 half() const { return 0.5 * (high - low); }
};

/// A cell with its bounds; its two halves stand next to each other.
struct SurfaceCell {
    CellBox box;
    SurfaceBounds bounds;
    std::size_t halves = 0;  // index of the first; 0: none are stored
};

/// Several cells or groups within one bound.
struct CellGroup {
    PlaceBounds place;
    std::size_t first = 0, second = 0;  // groups; or, for a leaf, cell `first`
    bool leaf = false;
};

/// Whether every place of `inner` is one of `outer`.
inline bool is_within(const CellBox& inner, const CellBox& outer) {
    return inner.face == outer.face && inner.low.x >= outer.low.x && inner.low.y >= outer.low.y &&
           inner.high.x <= outer.high.x && inner.high.y <= outer.high.y;
}

/// Whether a box has nothing of the face's domain.
bool is_outside(FaceDomain domain, const CellBox& box);

/// The halves of a cell, across its side that is longer in the world.
std::pair<CellBox, CellBox> halves_of(const CellBox& box, const SurfacePoint& middle);

/// The tree: groups over the faces, the faces' cells halved down to where their normals hardly turn.
/// Deterministic; thread-safe to read. The surface must live longer.
class CellBvh {
  public:
    explicit CellBvh(const Surface& surface);

    /// Null where the surface has no bounds: then there are no cells.
    const SurfaceBounder* bounder() const { return bounder_.get(); }
    std::span<const CellGroup> groups() const { return groups_; }  // the last is the whole surface
    std::span<const SurfaceCell> cells() const { return cells_; }

  private:
    void add_halves(std::size_t from, std::size_t to);
    std::size_t add_groups(std::span<std::size_t> faces);

    const Surface& surface_;
    std::unique_ptr<const SurfaceBounder> bounder_;
    std::vector<SurfaceCell> cells_;
    std::vector<CellGroup> groups_;
};

}  // namespace trilens
