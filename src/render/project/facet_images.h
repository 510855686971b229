// Where a point appears through the facets of one optic, each image then refined on the exact surface.
#pragma once

#include <optional>
#include <vector>

#include "base/raymesh/ray_mesh.h"
#include "base/util/parallel.h"
#include "render/frame/frame.h"
#include "specular/specular_point.h"
#include "trilinear/points/point_images.h"

namespace trilens {

/// An image of a point over one optic, before anything asks what hides it.
struct OpticImage {
    Id facet = kNone;   // of the optic's grid
    Vec2 pixel{0};      // from the film's top left
    double t = 0;       // along the ray that leaves the optic, in units of its direction
    double length = 0;  // the same in scene units
    Vec3 from{0};       // where light leaves the optic: on the exact surface where refined, else on the facet
    SurfaceParameter at{};  // where refined
    Vec3 normal{0};         // there
    bool refined = false;
    bool front = true;  // the camera sees the optic's front there
};

/// An image on the exact surface, seen at a pixel.
OpticImage optic_image(const SpecularPoint& exact, Id facet, const Vec2& pixel);

/// The law by which the optic images `point` on this path; for glass seen from its front. The camera has an
/// eye or parallel rays; of one whose film is not linear pixels mean nothing.
SpecularQuery specular_query(const World& world, const Frame& frame, std::size_t optic, Path path);

/// Copies what it needs of the mesh; world, frame and path must outlive it. Thread-safe to read.
class FacetImages {
  public:
    FacetImages(const World& world, const Frame& frame, std::size_t optic, const PathMesh& path);

    /// All images through the facets (thesis chapter 3), those left out that the facets themselves hide from
    /// the camera. `refine`: each is moved to the exact image near it, where there is one (linear cameras
    /// only); two that come to one exact image count once. `known`: exact images that are had already, not
    /// listed again.
    std::vector<OpticImage> images(const Vec3& point, bool refine,
                                   std::vector<SpecularPoint> known = {}) const;

  private:
    bool is_shown(const MeshPointImage& image) const;
    bool hidden(const MeshPointImage& image) const;
    bool shows_front(const MeshPointImage& image) const;
    std::optional<SpecularPoint> refined(const MeshPointImage& image, const Vec3& point) const;

    const World& world_;
    const Frame& frame_;
    std::size_t optic_;
    const PathMesh& path_;
    const OpticFacets& facets_;
    struct Search {
        MeshPointImages images;
        FacetsAround around;  // facets at each point of the grid
    };
    const Search& search() const;
    Lazy<Search> search_;  // where exact surfaces are searched completely nobody asks
};

}  // namespace trilens
