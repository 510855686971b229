// Where world points appear in a facet: the real roots of the coplanarity cubic (Vallance 2005, chapter 3,
// listing 3.1), and a cheap test before it; and in a whole RayMesh, whose tree of cones finds the few facets
// that may image a point.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "base/raymesh/ray_mesh.h"
#include "base/util/ids.h"
#include "trilinear/facet/facet.h"

namespace trilens {

// Where a facet images a world point: the real roots of the coplanarity cubic (Vallance 2005, chapter 3,
// listing 3.1).

/// The point lies at `t` on the ray of `weights`, which sum to 1.
struct PointImage {
    double t = 0;  // in units of the interpolated direction
    Vec3 weights{0};
};

/// Up to three images, t ascending.
struct PointImages {
    int count = 0;
    std::array<PointImage, 3> image;

    const PointImage* begin() const { return image.data(); }
    const PointImage* end() const { return image.data() + count; }
};

/// Which images are wanted.
struct ImageFilter {
    bool behind = false;       // also those with t < 0
    bool whole_plane = false;  // also those whose weights leave [0, 1]
};

/// All images of a world point in a facet. Borders belong to the facet: a weight counts as >= 0 down to
/// -kWeightTolerance and further down by what rounding of the coordinates does to it (kCoordinateRounding, at
/// most kLooseWeight), so that a point on the border of two facets is found in at least one of them, maybe in
/// both; t >= 0 likewise, and t is then 0. A point whose root is double (on the caustic) has one image there.
/// No image where the parametric triangle is degenerate: a pinhole's root at t = 0, where every ray meets, is
/// none.
PointImages point_images(const Coplanarity& facet, const Vec3& point, const ImageFilter& filter = {});

inline constexpr double kWeightTolerance = 1e-12;
inline constexpr double kCoordinateRounding =
    2e-15;  // share of the coordinates' size that computing may lose
inline constexpr double kLooseWeight = 1e-6;

/// An image whose point misses the world point by more than this share of its distance is none: a root at a
/// far t that rounding made of a vanishing leading coefficient.
inline constexpr double kImageResidual = 1e-9;

// Can a facet's beam hold a point at all? A cheap test before the cubic.

/// What the test needs of a facet besides its Coplanarity: an axis on which all its rays go forward.
struct FacetBeam {
    Vec3 axis{0};   // unit; zero where the corner rays have no such axis: then every point may be held
    Vec3 along{0};  // the corner directions' parts along the axis, all positive
};

FacetBeam make_facet_beam(const Coplanarity& facet);

/// False only where point_images (with the usual filter) finds no image. On the axis, t of the point is a
/// mean of its values at the three corner rays; between the least and the largest of them the beam lies in
/// the hull of six points, and the point must not be beyond that hull's sides.
bool may_hold(const Coplanarity& facet, const FacetBeam& beam, const Vec3& point);

// Where world points appear through a whole RayMesh: a tree of cones finds the few facets that may image a
// point.

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
    /// kLargestNumber (base/raymesh/sample_grid.h).
    std::vector<MeshPointImage> images(const Vec3& point) const;

    /// The same for many points, in parallel.
    PointImageLists images(std::span<const Vec3> points) const;

    /// A facet's corners on the screen, homogeneous.
    std::array<Vec3, 3> screen_corners(Id facet) const {
        const IdTriple& c = corners_[facet];
        return {screen_[c[0]], screen_[c[1]], screen_[c[2]]};
    }

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
