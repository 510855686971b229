// Where world points appear through a whole RayMesh: a tree of cones finds the few facets that may image a
// point.
#pragma once

#include <span>
#include <vector>

#include "base/raymesh/ray_mesh.h"
#include "base/util/ids.h"
#include "trilinear/points/beam.h"
#include "trilinear/points/point_images.h"

namespace trilens {

/// An image of a point: facet, place on its ray, place on the screen.
struct MeshPointImage {
    Id facet = kNone;
    double t = 0;     // in units of the facet's interpolated direction, >= 0
    Vec3 weights{0};  // of the facet's corners, sum 1
    Vec2 screen{0};   // pixels from the film's top left; may lie off the film
};

/// The images of many points, one after the other: those of point i are of(i), by ascending facet, then t.
struct PointImageLists {
    std::vector<std::size_t> first;  // number of points + 1 entries
    std::vector<MeshPointImage> image;

    std::span<const MeshPointImage> of(std::size_t point) const {
        return {image.data() + first[point], first[point + 1] - first[point]};
    }
};

/// A RayMesh made ready to image points. Copies what it needs.
class MeshPointImages {
  public:
    /// Throws InputError as check_ray_mesh does.
    explicit MeshPointImages(const RayMesh& mesh);

    /// All images of a world point with t >= 0 inside their facet (borders: see point_images). An image on an
    /// edge or corner that facets share is listed once, with the smallest facet. Images behind the camera
    /// (screen w <= 0) are left out. Throws InputError for a point that is not finite or beyond
    /// kLargestNumber (base/raymesh/check_data.h).
    std::vector<MeshPointImage> images(const Vec3& point) const;

    /// The same for many points, in parallel.
    PointImageLists images(std::span<const Vec3> points) const;

  private:
    // All rays of the facets below a node lie in the union of balls about center + s * axis of radius
    // radius + s * spread, s >= 0: a rounded cone.
    struct Node {
        Vec3 center{0};
        double radius = 0;
        Vec3 axis{0};                      // unit
        double spread = 0;                 // sine of the half-angle; 2: no cone holds the directions
        std::uint32_t skip = 0;            // the node after this one's subtree
        std::uint32_t first = 0, end = 0;  // leaf: range of facet_; else empty
    };

    struct Means;
    std::uint32_t build(const RayMesh& mesh, const Means& means, std::uint32_t first, std::uint32_t end);
    static Node cone(const RayMesh& mesh, const Means& means, std::span<const Id> facets);
    static bool may_see(const Node& node, const Vec3& point);
    void append(const Vec3& point, std::vector<MeshPointImage>& images) const;
    bool same_image(const MeshPointImage& a, const MeshPointImage& b) const;

    std::vector<Node> node_;                // depth first
    std::vector<Id> facet_;                 // in the order of the leaves
    std::vector<Coplanarity> coplanarity_;  // of facet_[i]
    std::vector<FacetBeam> beam_;           // of facet_[i]
    std::vector<IdTriple> corners_;         // of the mesh's facet
    std::vector<Vec3> screen_;              // of the mesh's corners
};

}  // namespace trilens
