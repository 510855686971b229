// Turns the normal to the ray and asks the single-ray laws.
#include "paths/trace/optic_ray.h"

#include "reflect/mirror.h"
#include "refract/snell.h"

namespace trilens {
namespace {

double eta_of(const Arrival& at, double ior) {
    return at.inside ? ior : 1 / ior;
}

}  // namespace

Arrival arrival(const Ray& incoming, const SurfaceHit& hit) {
    const bool inside = dot(incoming.direction, hit.point.normal) > 0;
    return {inside ? -hit.point.normal : hit.point.normal, inside};
}

Ray mirrored_ray(const Ray& incoming, const SurfaceHit& hit) {
    return {hit.point.position, mirrored(incoming.direction, hit.point.normal)};
}

std::optional<Ray> refracted_ray(const Ray& incoming, const SurfaceHit& hit, double ior) {
    const Arrival at = arrival(incoming, hit);
    const std::optional<Vec3> direction = refracted(incoming.direction, at.normal, eta_of(at, ior));
    if (!direction) return std::nullopt;
    return Ray{hit.point.position, *direction};
}

}  // namespace trilens
