// What the design of a mirror or a lens is fitted by: the sphere to begin with, and the rows of one sample.
#pragma once

#include <array>
#include <span>

#include "base/raymesh/ray_mesh.h"
#include "inverse/design/design.h"

namespace trilens {

// The sphere that comes nearest to a wish: what a freeform mirror is held against.

DesignErrors design_errors(std::vector<double> degrees);

/// Radius and tilt by Levenberg and Marquardt, through the anchor, from the flat rectangle.
BestSphere best_sphere(const DesignWish& wish, const WishedRays& rays, std::span<const Vec2> samples);

/// The height over `at` of the sphere of this curvature (0: a plane; positive: convex towards +z) through
/// (anchor, 0) with slopes `tilt` there; none where the sphere does not reach so far.
std::optional<Height> sphere_height(double curvature, const Vec2& tilt, const Vec2& at);

// One sample of a surface in design: the ray that leaves, the slopes that the wish needs, and their
// derivatives.

/// Where the samples of a rectangle lie: middles of columns x rows equal parts, row by row.
std::vector<Vec2> patch_samples(const Vec2& size, const std::array<int, 2>& counts);

/// Slopes dz/dx, dz/dy for which the eye's ray at a place leaves in the wished direction. Of a mirror the
/// normal halves the angle of both; of a lens it is along their difference, times the index, in the glass
/// (Snell), which takes the one quickest way through the plane back to a wished point (Fermat), however near.
struct NeededSlopes {
    Vec2 slopes{0};
    /// null: none. What is wished does not lie behind a lens' back; or the z of that normal, or its cosine
    /// with the eye's ray, is 0 or less. Goes on from "of the mirror", "of the lens".
    const char* refusal = nullptr;
};
NeededSlopes needed_slopes(const WishedRays& wish, const Vec3& place);

/// The eye's ray that meets the surface at (at, h.z) with the slopes of h, as it leaves: mirrored there, or
/// refracted into a lens and out of its back. Unit; the eye's ray turned around where its back reflects all
/// of it.
Ray leaving_ray(const WishedRays& wish, const Vec2& at, const Height& h);

/// Its direction minus the wished one, both unit.
Vec3 ray_residual(const WishedRays& wish, const Vec2& at, const Height& h);

/// How that residual moves with z at fixed slopes, and with either slope at fixed z.
struct RayRows {
    Vec3 residual{0}, by_z{0}, by_x{0}, by_y{0};
};
RayRows ray_rows(const WishedRays& wish, const Vec2& at, const Height& h, double length_scale);

/// The angle between the leaving ray and the wished one, degrees.
double ray_error(const WishedRays& wish, const Vec2& at, const Height& h);

/// (p_y + p_z q) - (q_x + q_z p) of the needed slopes p, q at (x, y, z): 0 where they are some surface's
/// (Frobenius). By central differences of `step`.
double slope_curl(const WishedRays& wish, const Vec3& place, double step);

}  // namespace trilens
