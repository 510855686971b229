// The ray that leaves an optic where another ray met it: mirrored, or refracted through its surface.
#pragma once

#include <optional>

#include "base/raymesh/surface.h"

namespace trilens {

/// Where a ray arrives at an interface between air (the side that the normals point to) and a body.
struct Arrival {
    Vec3 normal{0};       // unit, on the side that the ray comes from
    bool inside = false;  // it comes from within the body, against the normals
};

/// The hit's normal turned to face the ray.
Arrival arrival(const Ray& incoming, const SurfaceHit& hit);

/// The mirrored ray: from the hit's point exactly (trace it with a t_min where it may meet the same surface),
/// with the length of the incoming direction. Either side of the surface mirrors.
Ray mirrored_ray(const Ray& incoming, const SurfaceHit& hit);

/// The refracted ray, likewise; none on total internal reflection. `ior`: the body's refractive index over
/// that of the outside; rays that arrive from the front enter (eta = 1 / ior), rays that arrive from the back
/// leave (eta = ior).
std::optional<Ray> refracted_ray(const Ray& incoming, const SurfaceHit& hit, double ior);

}  // namespace trilens
