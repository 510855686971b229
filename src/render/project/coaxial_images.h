// Images over coaxial interfaces (flat and dome ports, plates, shells): found from no seed, since there is
// one path of light at most.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "base/raymesh/ray_mesh.h"
#include "paths/trace/follow.h"
#include "render/frame/frame.h"
#include "render/frame/image_chain.h"
#include "specular/chain/coaxial_chain.h"

namespace trilens {

/// The facets of a linear camera's film that have one history.
struct HistoryFacets {
    std::span<const PathSegment> chain;  // the history
    const RayMesh& mesh;
    std::span<const Id> grid_facet;  // per facet of the mesh: of the first optic's grid
    std::span<const char> proven;    // likewise: all rays of it have the history
};

/// An image over coaxial interfaces.
struct CoaxialImage {
    ChainImage image;
    Id facet = kNone;        // of the first optic's grid, that holds it
    bool is_proven = false;  // the camera's ray at its place has the history
};

/// The coaxial interfaces that one history meets: runs of faces. World and frame must live longer.
/// Thread-safe to read.
class CoaxialImages {
  public:
    /// Finds the runs by exact rays of some facets; none where the camera is not linear with an eye, or its
    /// rays start in different media.
    CoaxialImages(const World& world, const Frame& frame, const HistoryFacets& facets);

    std::size_t run_count() const { return runs_.size(); }
    /// The run's image of a point, where there is one; what hides it is not asked.
    std::optional<CoaxialImage> image(std::size_t run, const Vec3& point) const;

    /// Whether no path of the history leaves the one run: no other image needs to be looked for.
    bool hold_all() const { return !runs_.empty() && !runs_[0].chain.are_planes(); }
    /// Whether all paths of a facet of the mesh are those of one run.
    bool hold(std::size_t facet) const { return facet < held_.size() && held_[facet] != 0; }
    /// Whether the path of a place of the film that leaves the optics along this ray, unit, is one of a run.
    bool hold(const Vec2& pixel, const Ray& exit) const;

  private:
    struct Run {
        CoaxialChain chain;
        std::vector<PathEvent> events;
    };
    struct Triangle {
        std::array<Vec2, 3> corner;  // pixels
        bool holds(const Vec2& pixel) const;
    };

    bool hold(std::span<const PathEvent> events) const;
    bool may_have_runs(std::span<const PathSegment> chain) const;
    void add_run(const std::vector<PathEvent>& events, const Vec2& pixel);
    void find_runs(const HistoryFacets& facets);
    void hold_facets(const HistoryFacets& facets);
    bool is_held(const std::array<Vec2, 3>& corner) const;

    const World& world_;
    const Frame& frame_;
    std::vector<Run> runs_;
    std::vector<char> held_;  // per facet of the mesh
    std::optional<FacetLookup> facet_at_;
    // Per facet of the grid, and one more: the first of its triangles that are proven to have the history.
    std::vector<std::size_t> first_;
    std::vector<Triangle> triangles_;
};

}  // namespace trilens
