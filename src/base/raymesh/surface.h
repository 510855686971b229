// A curved surface as its users see it: faces with parameters, evaluated exactly; its grid of facets as
// triangles of a scene.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/math/box.h"
#include "base/raymesh/ray_mesh.h"
#include "base/raymesh/triangle_scene.h"
#include "base/util/ids.h"

namespace trilens {

/// The parameter domain of a face: the unit square, or the triangle u >= 0, v >= 0, u + v <= 1.
enum class FaceDomain { kSquare, kTriangle };

/// The place of the domain next to (u, v): of what lies in the unit square, beyond a triangle's long side
/// u + v = 1, the nearest of that side.
inline Vec2 clamped_to(FaceDomain domain, const Vec2& uv) {
    const Vec2 within = glm::clamp(uv, Vec2(0), Vec2(1));
    const double beyond = within.x + within.y - 1;
    if (domain == FaceDomain::kSquare || beyond <= 0) return within;
    const double u = std::clamp(within.x - 0.5 * beyond, 0.0, 1.0);
    return {u, 1 - u};
}

/// A point of a surface with its derivatives with respect to the face's (u, v); world frame.
struct SurfacePoint {
    Vec3 position{0};
    Vec3 du{0}, dv{0};
    Vec3 duu{0}, duv{0}, dvv{0};
    Vec3 normal{0};  // unit, du x dv turned to the front of the surface; zero where there is none
};

/// One side of a face: the edge that it runs along. Sides with equal edges are one curve in the world.
struct FaceSide {
    enum class Part { kWhole, kFirstHalf, kSecondHalf };
    Id edge = kNone;           // kNone: no other face has this side
    Part part = Part::kWhole;  // which part of the edge, in the edge's own direction
    bool reversed = false;     // the side runs against the edge
};

/// How a face hangs together with its neighbours. Square: corners (0,0), (1,0), (1,1), (0,1); triangle:
/// (0,0), (1,0), (0,1). Side k runs from corner k to the next. Equal corners are one point in the world;
/// kNone: no other face has it.
struct FaceBorder {
    std::array<Id, 4> corners{kNone, kNone, kNone, kNone};
    std::array<FaceSide, 4> sides{};
};

/// A parameter position of a surface.
struct SurfaceParameter {
    Id face = kNone;
    Vec2 uv{0};
};

/// Where a ray meets a surface.
struct SurfaceHit {
    Id face = kNone;
    Vec2 uv{0};
    double t = 0;  // in units of the ray's direction
    SurfacePoint point;
};

/// What a surface does over a box of a face's parameters: each quantity q at every point of the box (and of
/// the face) lies within its radius of middle.q, |q - middle.q| <= q_radius. An infinite radius says nothing.
struct SurfaceBounds {
    SurfacePoint middle;  // at the box's middle; where that lies outside a triangle, of the face continued
    double position_radius = std::numeric_limits<double>::infinity();
    double du_radius = position_radius, dv_radius = position_radius;
    double duu_radius = position_radius, duv_radius = position_radius, dvv_radius = position_radius;
    double normal_radius = 2;  // of the unit normals; 2 says nothing
    bool is_finest = false;    // boxes inside this one have no better bounds
};

/// Where a whole face lies, and its unit normals, whatever they come from: no farther than `angle` (radians)
/// from `normal`.
struct FaceBounds {
    Box box;
    Vec3 normal{0};  // unit
    double angle = 0;
};

/// Bounds of a surface, each good to rounding and shrinking at least in proportion to the box wherever the
/// surface is smooth. Thread-safe to read; refers to its surface, which must live longer.
class SurfaceBounder {
  public:
    virtual ~SurfaceBounder() = default;

    /// 0 <= low <= high <= 1, and low inside the domain. A box may be one point: the radii are then what
    /// rounding leaves.
    virtual SurfaceBounds bounds(Id face, const Vec2& low, const Vec2& high) const = 0;

    /// A box that holds all points of that part, often smaller than the one around bounds()' ball.
    virtual Box box(Id face, const Vec2& low, const Vec2& high) const {
        const SurfaceBounds part = bounds(face, low, high);
        return {part.middle.position - part.position_radius, part.middle.position + part.position_radius};
    }
};

/// A surface of numbered faces in the world frame: the limit of a cage, or a primitive. Thread-safe to read.
class Surface {
  public:
    virtual ~Surface() = default;
    virtual std::size_t face_count() const = 0;
    virtual FaceDomain domain(Id face) const = 0;

    /// The corners and edges that the face shares with others; the default shares nothing.
    virtual FaceBorder border(Id /*face*/) const { return {}; }

    /// Position and derivatives at (u, v) of a face; parameters outside the domain are clamped to it.
    virtual SurfacePoint eval(Id face, const Vec2& uv) const = 0;
    /// The same bit for bit, but that the second derivatives may be left out.
    virtual SurfacePoint eval_first_order(Id face, const Vec2& uv) const { return eval(face, uv); }

    /// The first hit with t > t_min in closed form, for surfaces that have one; `has_closed_form` says which.
    virtual bool has_closed_form() const { return false; }
    virtual std::optional<SurfaceHit> intersect(const Ray&, double /*t_min*/) const { return std::nullopt; }
    /// Whether that hit has t < t_max.
    virtual bool meets(const Ray& ray, double t_min, double t_max) const {
        const std::optional<SurfaceHit> hit = intersect(ray, t_min);
        return hit && hit->t < t_max;
    }

    /// Whether the whole face lies in a plane; false says nothing.
    virtual bool is_flat(Id /*face*/) const { return false; }

    /// 1 / radius of the sphere that the whole surface lies on, normals outward; 0 of every other surface.
    virtual double sphere_curvature() const { return 0; }
    /// Of a sphere, where its normal is along `normal`, to rounding; no face where that is not known.
    virtual SurfaceParameter sphere_place(const Vec3& /*normal*/) const { return {}; }

    /// Bytes that it holds now, but for the allocator's own and what does not grow with the surface.
    virtual std::size_t bytes_held() const { return 0; }

    /// None where nothing is known of the face.
    virtual std::optional<FaceBounds> face_bounds(Id /*face*/) const { return std::nullopt; }

    /// What bounds this surface's parts, or null where none are known. Prepares all faces, so ask once.
    virtual std::unique_ptr<const SurfaceBounder> make_bounder() const { return nullptr; }
};

/// An N x N grid on a surface: facets whose corners lie on the surface. Points on edges that faces share
/// exist once, so there are no cracks; a corner is a point with one normal, so it splits along sharp creases.
struct SurfaceGrid {
    std::vector<Vec3> points;                   // world frame, on the surface
    std::vector<Id> corner_point;               // per corner: index into points
    std::vector<Vec3> corner_normal;            // per corner: unit; zero where the surface has none
    std::vector<IdTriple> facets;               // corners, counter-clockwise seen from the front
    std::vector<Id> facet_face;                 // per facet: face of the surface
    std::vector<std::array<Vec2, 3>> facet_uv;  // per facet: (u, v) of its corners in that face
};

/// Whether a ray of this direction (any length) comes to the flat facet from its front; edge-on counts as the
/// front.
inline bool faces_front(const SurfaceGrid& grid, const IdTriple& facet, const Vec3& direction) {
    const Vec3& a = grid.points[grid.corner_point[facet[0]]];
    const Vec3& b = grid.points[grid.corner_point[facet[1]]];
    const Vec3& c = grid.points[grid.corner_point[facet[2]]];
    return dot(cross(b - a, c - a), direction) <= 0;
}

/// Whether a point lies before the tangent plane of any corner of the grid: never inside of a convex body.
inline bool lies_before(const SurfaceGrid& grid, const Vec3& point) {
    for (std::size_t i = 0; i < grid.corner_point.size(); ++i)
        if (dot(point - grid.points[grid.corner_point[i]], grid.corner_normal[i]) > 0) return true;
    return false;
}

/// Of a grid that bounds a body, 1 where its facets' fronts are outside of it and -1 where they are inside; 0
/// where it bounds none: an edge is not two facets' one way each.
int body_orientation(const SurfaceGrid& grid);

// A surface's grid as triangles of a scene.

/// Appends the facets of `grid` to `scene` as triangles of `object`; primitive f is facet f. Points that
/// facets share stay shared.
void append_facets(const SurfaceGrid& grid, Id object, TriangleScene& scene);

}  // namespace trilens
