// Rays, and RayMesh: a triangle mesh on the screen whose corners carry rays. Everything that looks at the
// scene is one.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "base/math/vec.h"
#include "base/util/ids.h"

namespace trilens {

// A ray: the points origin + t * direction with t >= 0.

/// World frame. The direction is NOT unit: its length is the unit of t, and a choice that matters
/// (a corner ray keeps the eye-to-corner length, so that a flat mirror stays exact).
struct Ray {
    Vec3 origin{0};
    Vec3 direction{0};
};

/// Facets with shared corners (Vallance 2005, chapter 2). `rays` and `screen` have one entry per corner.
struct RayMesh {
    std::vector<Ray> rays;     // world frame; directions are not unit
    std::vector<Vec3> screen;  // homogeneous screen position (x w, y w, w), x and y in pixels from the film's
                               // top left, w the depth along the view axis (1 for affine screens)
    std::vector<IdTriple>
        facets;  // corners; {kNone, kNone, kNone}: this facet has no rays (total internal reflection)

    bool has_rays(std::size_t facet) const { return facets[facet][0] != kNone; }
};

/// The unnormalised weights e of one facet as functions of the screen: e(x, y) = weights_from_screen * (x, y,
/// 1). The weights of the facet's corners are e / (e0 + e1 + e2); perspective-correct by construction
/// (homogeneous rasterisation: Olano and Greer, Triangle Scan Conversion using 2D Homogeneous Coordinates,
/// 1997).
struct FacetWeights {
    Mat3 weights_from_screen{0};
    bool edge_on = true;  // the facet has no area on the screen: no pixel sees it, the matrix is zero

    Vec3 unnormalised(double x, double y) const { return weights_from_screen * Vec3(x, y, 1); }
};

/// Inverts the facet's screen matrix. The result is scaled so that e sums to a positive number of order 1
/// in front of the camera. Works for corners behind the camera (w <= 0) too.
FacetWeights facet_weights(const RayMesh& mesh, std::size_t facet);

/// The facet's ray for weights that sum to 1: origin and direction interpolated linearly.
inline Ray interpolated_ray(const RayMesh& mesh, std::size_t facet, const Vec3& weights) {
    const IdTriple& corner = mesh.facets[facet];
    Ray ray;
    for (int k = 0; k < 3; ++k) {
        const Ray& at_corner = mesh.rays[corner[static_cast<std::size_t>(k)]];
        ray.origin += weights[k] * at_corner.origin;
        ray.direction += weights[k] * at_corner.direction;
    }
    return ray;
}

/// The facet's ray through the screen position `at` (pixels from the film's top left). `weights`: the facet's
/// own, not edge-on.
inline Ray sample_ray(const RayMesh& mesh, std::size_t facet, const FacetWeights& weights, const Vec2& at) {
    const Vec3 e = weights.unnormalised(at.x, at.y);
    return interpolated_ray(mesh, facet, e / (e.x + e.y + e.z));
}

// Which facets meet at each vertex of a mesh.

/// Lists of facets by vertex: those at vertex v are facet[first[v]] .. facet[first[v + 1] - 1], ascending.
struct FacetsAround {
    std::vector<std::size_t> first;  // number of vertices + 1 entries
    std::vector<Id> facet;

    std::span<const Id> of(Id vertex) const {
        return {facet.data() + first[vertex], first[vertex + 1] - first[vertex]};
    }
    /// The facets that share a vertex with one that has these three, itself among them; ascending, each once.
    std::vector<Id> ring(const IdTriple& vertices) const;
};

/// `vertex_of`: from a facet's corner to its vertex, below vertex_count. Facets of kNone are left out.
FacetsAround facets_around(std::span<const IdTriple> facets, std::size_t vertex_count,
                           const std::function<Id(Id corner)>& vertex_of);

/// The same where corners are the vertices.
FacetsAround facets_around(std::span<const IdTriple> facets, std::size_t vertex_count);

// A linear camera, one 3 x 4 map from the world to the homogeneous screen, and how a camera sees one corner
// of a grid.

/// Perspective (all rays leave `eye`) or parallel (all rays share `view_direction`), world frame.
struct LinearCamera {
    bool parallel = false;
    Vec3 eye{0};             // perspective: the centre of projection; parallel: any point of the image plane
    Vec3 view_direction{0};  // unit, the view axis; parallel: the rays' direction, whose part along the
                             // view axis is 1
    Vec4 screen_x{0}, screen_y{0},
        screen_w{0};    // rows of the map: (x w, y w, w) = rows . (point, 1); w is the depth
                        // along the view axis from `eye` for perspective, 1 for parallel
    Vec3 view_axis{0};  // of oblique cameras: unit; zero where it is view_direction

    bool operator==(const LinearCamera&) const = default;
};

/// Homogeneous screen position (x w, y w, w) of a world point; x, y in pixels from the film's top left.
/// w <= 0: the point is not in front of a perspective camera.
inline Vec3 screen_from_world(const LinearCamera& camera, const Vec3& point) {
    const Vec4 p(point, 1);
    return {dot(camera.screen_x, p), dot(camera.screen_y, p), dot(camera.screen_w, p)};
}

/// The direction from the camera to `point`: for perspective point - eye, NOT unit (the eye-to-corner
/// length); for parallel view_direction, unit but for oblique rays.
inline Vec3 incident_direction(const LinearCamera& camera, const Vec3& point) {
    if (!camera.parallel) return point - camera.eye;
    return camera.view_direction;
}

/// `screen`: homogeneous, as RayMesh::screen has it. `incident`: from the camera to the corner, not unit: the
/// eye-to-corner length, or as incident_direction for parallel rays.
struct CornerView {
    Vec3 screen{0, 0, 1};
    Vec3 incident{0};
};

}  // namespace trilens
