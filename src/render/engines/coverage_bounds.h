// How much of a pixel shows a mesh, as an interval that holds for every place in the pixel, not for samples.
// After: Catmull, A Hidden-Surface Algorithm with Anti-Aliasing, SIGGRAPH 1978 (exact coverage of pixels);
// Duff, Interval Arithmetic and Recursive Subdivision, SIGGRAPH 1992.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "base/raymesh/sample_grid.h"
#include "projector/squares/square_rays.h"
#include "render/frame/frame.h"
#include "render/frame/views.h"
#include "render/world/world.h"

namespace trilens {

/// The share of a pixel lies between; 0 and 1 say nothing.
struct CoverageBounds {
    float low = 0, high = 1;
};

/// The mesh (index into Scene::meshes) that a sample shows first, an optic or an object; kNone: neither.
Id shown_mesh(const World& world, const SampleView& view);

/// Bounds what the pixels of one frame show first, by the facets of optics and of the camera.
class CoverageBounder {
  public:
    /// `windows`: where each optic may be seen. All must live longer.
    CoverageBounder(const World& world, const Frame& frame, const std::vector<SampleGrid>& windows);

    /// Of each pixel of the grid's window, in rows, the share that shows the mesh `shown` has for it; kNone:
    /// that shows none. Where several optics' windows overlap, nothing is said of which of them is seen.
    void bound(const SampleGrid& grid, std::span<const Id> shown, std::span<CoverageBounds> bounds) const;

  private:
    struct CameraFacet {
        FacetRays rays;
        FacetWeights weights;
        std::array<Vec3, 3> corner{};  // on the homogeneous screen
        bool turned = false;           // clockwise there
        Vec2 low{0}, high{0};          // of the pixels that it may touch

        bool touches(const Vec2& from, const Vec2& to) const {
            return low.x <= to.x && high.x >= from.x && low.y <= to.y && high.y >= from.y;
        }
    };
    class Pixel;
    struct BlockSight;
    struct Place;
    struct Wanted;

    std::vector<SquareTriangle> triangles_before(const SquareRays& rays, const Place& place) const;
    const CameraFacet* facet_around(const Vec2& low, const Vec2& high, std::span<const Id> facets) const;
    std::optional<BlockSight> meet_block(const Vec2& at, double size, std::span<const Id> facets) const;
    void bound_block(const Vec2& at, double size, const BlockSight* around, const Wanted& wanted) const;
    CoverageBounds bound_pixel(const Vec2& at, Id shown, std::span<const Id> facets,
                               const BlockSight* around) const;

    const World& world_;
    const Frame& frame_;
    const std::vector<SampleGrid>& windows_;
    std::vector<CameraFacet> facets_;
    double reach_ = 0;
};

}  // namespace trilens
