// Bounding volume hierarchy over a surface's cells: groups of faces, faces, halved cells.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
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

/// A cell with its bounds; and its two halves, once somebody has asked for them.
class SurfaceCell {
  public:
    SurfaceCell() = default;
    ~SurfaceCell();
    SurfaceCell(const SurfaceCell&) = delete;
    SurfaceCell& operator=(const SurfaceCell&) = delete;

    CellBox box;
    SurfaceBounds bounds;

  private:
    friend class CellBvh;
    mutable std::atomic<const std::array<SurfaceCell, 2>*> halves_ = nullptr;
};
using CellHalves = std::array<SurfaceCell, 2>;

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

/// The first hit of a ray with a surface with t > t_min, t in units of its direction.
using Occluder = std::function<std::optional<SurfaceHit>(const Ray& ray, double t_min)>;

/// The tree: groups over the faces, and the faces' cells, halved as far as any search went. What is asked for
/// has the same bits whoever asked before. Thread-safe to read. The surface must live longer.
class CellBvh {
  public:
    explicit CellBvh(const Surface& surface, Occluder first_hit = {});

    /// Null where the surface has no bounds: then there are no cells.
    const SurfaceBounder* bounder() const { return bounder_.get(); }
    std::span<const CellGroup> groups() const { return groups_; }  // the last is the whole surface
    std::span<const SurfaceCell> faces() const { return faces_; }  // whole
    /// The halves of one of the tree's cells, of which one may have nothing of the face (is_outside); null
    /// where there are so many already that no more are kept.
    const CellHalves* halves(const SurfaceCell& cell) const;
    /// By which the surface hides parts of itself; empty where it is not closed, or none was given.
    const Occluder& occluder() const { return occluder_; }

  private:
    std::size_t add_groups(std::span<std::size_t> faces);

    const Surface& surface_;
    std::unique_ptr<const SurfaceBounder> bounder_;
    std::vector<SurfaceCell> faces_;
    std::vector<CellGroup> groups_;
    Occluder occluder_;
    mutable std::atomic<std::size_t> halved_ = 0;
};

}  // namespace trilens
