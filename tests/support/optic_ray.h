// A single ray mirrored or refracted where it met a surface: the single-ray laws at a hit, for tests to trace
// with.
#pragma once

#include <optional>

#include "base/raymesh/surface.h"
#include "reflect/mirror.h"
#include "refract/dielectric.h"

namespace trilens_test {

/// Where a ray arrives at an interface between air (the side that the normals point to) and a body.
struct Arrival {
    trilens::Vec3 normal{0};  // unit, on the side that the ray comes from
    bool inside = false;      // it comes from within the body, against the normals
};

/// The hit's normal turned to face the ray.
inline Arrival arrival(const trilens::Ray& incoming, const trilens::SurfaceHit& hit) {
    const bool inside = dot(incoming.direction, hit.point.normal) > 0;
    return {inside ? -hit.point.normal : hit.point.normal, inside};
}

/// The mirrored ray: from the hit's point exactly (trace it with a t_min where it may meet the same surface),
/// with the length of the incoming direction. Either side of the surface mirrors.
inline trilens::Ray mirrored_ray(const trilens::Ray& incoming, const trilens::SurfaceHit& hit) {
    return {hit.point.position, trilens::mirrored(incoming.direction, hit.point.normal)};
}

/// The refracted ray, likewise; none on total internal reflection. `ior`: the body's refractive index over
/// that of the outside; rays that arrive from the front enter (eta = 1 / ior), rays that arrive from the back
/// leave (eta = ior).
inline std::optional<trilens::Ray> refracted_ray(const trilens::Ray& incoming, const trilens::SurfaceHit& hit,
                                                 double ior) {
    const Arrival at = arrival(incoming, hit);
    const std::optional<trilens::Vec3> direction =
        trilens::refracted(incoming.direction, at.normal, at.inside ? ior : 1 / ior);
    if (!direction) return std::nullopt;
    return trilens::Ray{hit.point.position, *direction};
}

}  // namespace trilens_test
