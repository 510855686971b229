// Paths of light over coaxial interfaces: parallel planes by Snell's invariant, concentric spheres by
// Bouguer's (Agrawal, Ramalingam, Taguchi and Chari, A Theory of Multi-Layer Flat Refractive Geometry, CVPR
// 2012).
#pragma once

#include <array>
#include <optional>
#include <span>

#include "specular/chain/path_chain.h"

namespace trilens {

/// Where a path meets a surface: on which face, and whether on its front.
struct ChainFace {
    Id face = kNone;
    bool front = true;
};

/// A path of light over coaxial interfaces; of each event the place.
struct CoaxialPath {
    PerEvent<SurfaceParameter> at;
    PerEvent<Vec3> places, normals;  // world; normals unit, on the surface's front
    Mat3 first_by_point{0};          // how the first place moves with the path's end
};

/// Surfaces that a path meets one after the other and that have an axis in common with its eye: the planes'
/// normal through it, or the line from it to the spheres' centre. A path of light lies in the plane of axis
/// and point, where one number tells it: its slope in the medium of the least index, or the angle at which it
/// leaves the eye. How far from the axis it comes to the point grows with that number, so that there is one
/// path at most, which Newton's method finds to rounding. Surfaces must live longer.
class CoaxialChain {
  public:
    /// None where the surfaces are neither parallel planes, with faces of affine parameters, nor concentric
    /// spheres that hold the eye and that the path leaves one after the other; where the eye is a direction;
    /// and of spheres where the proof of one path fails, as it does where the eye is nearer to the skin than
    /// to the centre. The chain's point does not matter.
    static std::optional<CoaxialChain> of(const PathChain& chain, std::span<const ChainFace> faces);

    /// None: there is no path of light from these sides over these faces to the point. A place that rounding
    /// puts beyond its face's border lies on the border.
    std::optional<CoaxialPath> path_to(const Vec3& point) const;

    /// Of planes: whether all rays from the eye between these three, in any order, go over all of the faces.
    /// Of spheres, which have no borders: true.
    bool holds_rays_between(const std::array<Vec3, 3>& directions) const;

    /// Of planes: the last stretch, unit, of the path of light that leaves the eye in a direction; none where
    /// it misses a face, or is reflected totally.
    std::optional<Ray> last_ray(const Vec3& direction) const;

    /// Spheres have no other faces that a path of these events may meet instead; planes may.
    bool are_planes() const { return are_planes_; }

  private:
    /// A plane's face: corner + u du + v dv.
    struct PlaneFace {
        Vec3 corner{0}, normal{0};
        Vec3 by_u{0}, by_v{0};  // u = by_u . (place - corner)
        FaceDomain domain = FaceDomain::kSquare;

        Vec2 uv(const Vec3& place) const { return {dot(by_u, place - corner), dot(by_v, place - corner)}; }
    };
    struct SphereRay;

    CoaxialChain(const PathChain& chain, std::span<const ChainFace> faces)
        : chain_(chain), faces_(faces.begin(), faces.end()) {}

    bool set_planes();
    bool set_plane_order();
    static std::optional<PlaneFace> plane_face(const Surface& surface, Id face);
    bool set_spheres();
    double least_angle_slope() const;
    std::optional<CoaxialPath> over_planes(const Vec3& point) const;
    std::optional<CoaxialPath> over_spheres(const Vec3& point) const;
    SphereRay sphere_ray(const Vec2& from_eye, double end_radius) const;
    double index(std::size_t stretch) const {
        return stretch == 0 ? chain_.events[0].index_before : chain_.events[stretch - 1].index_after;
    }

    PathChain chain_;
    PerEvent<ChainFace> faces_;
    bool are_planes_ = true;
    Vec3 axis_{0};                // planes: the unit normal of the first; spheres: their centre
    PerEvent<double> place_;      // planes: from the eye along the axis; spheres: the radius
    PerStretch<double> forward_;  // planes: whether a stretch runs along the axis, 1, or against it, -1
    PerEvent<double> depth_;      // planes: how far each stretch before an event runs along the axis
    PerEvent<PlaneFace> planes_;
    double eye_radius_ = 0, least_slope_ = 1;  // spheres: of the angle of the point by that at the eye
    Vec3 to_eye_{0};                           // spheres: unit from the centre; zero: the eye lies there
};

}  // namespace trilens
