// Where a ray meets one face of a curved surface: Newton's method on (u, v) in the plane at right angles to
// the ray. Source: Toth, On ray tracing parametric surfaces, SIGGRAPH 1985, with the ray's parameter
// eliminated.
#pragma once

#include <optional>

#include "base/raymesh/surface.h"

namespace trilens {

/// A ray with an orthonormal frame about it: z runs along the ray.
struct RayFrame {
    Vec3 origin{0};
    Vec3 x{0}, y{0}, z{0};  // unit
    double speed = 0;       // length of the direction: z = speed * t

    /// A world point, seen along the ray: the ray's line is x = y = 0.
    Vec3 from_world(const Vec3& point) const {
        const Vec3 local = point - origin;
        return {dot(x, local), dot(y, local), dot(z, local)};
    }
};

/// None for a ray that is not finite or has no direction.
std::optional<RayFrame> make_ray_frame(const Ray& ray);

/// Where to look for a hit: a face, a first guess, and how far (in u and v) a step may go at most.
struct SurfaceGuess {
    Id face = kNone;
    Vec2 uv{0};
    double reach = 1;
};

/// The hit that Newton's method reaches from the guess, with any t; none where it reaches none within the
/// face. The hit lies on the ray to kSurfaceResidual times the distances to the world's and the ray's origin;
/// parameters that end up outside of the face by up to kDomainSlack are put on its border. Its point is that
/// of Surface::eval_first_order.
std::optional<SurfaceHit> solve_surface_hit(const Surface& surface, const RayFrame& ray,
                                            const SurfaceGuess& guess);

/// Where a ray that meets the surface at `hit` should meet it a second time close by, if it bends as it does
/// at `hit` (near a silhouette the two are close, and either may be the first): parameters and the step in t.
/// None for flat spots. `hit` with second derivatives.
struct SecondHit {
    Vec2 uv{0};
    double t_step = 0;
};
std::optional<SecondHit> predict_second_hit(const SurfaceHit& hit, const Vec3& direction);

/// Eval rounds at about 1e-16 of the coordinates, several times over; a near miss of more than this is a
/// miss.
inline constexpr double kSurfaceResidual = 1e-13;

}  // namespace trilens
