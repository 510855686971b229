#include "render/engines/first_surface.h"

#include <cmath>
#include <optional>

namespace trilens {

FirstSurface first_surface(const PathWorld& world, const Tracer& objects, const Ray& ray, double reach) {
    FirstSurface first;
    first.object = objects.first_hit(ray);
    if (first.object.seen() && first.object.t > reach) first.object = {};
    const auto turn = [&](std::size_t optic, const SurfaceHit& hit) {
        return coincident_order(world.optics[optic].mirror, dot(hit.point.normal, ray.direction) <= 0);
    };
    const auto comes_first = [&](std::size_t optic, const SurfaceHit& hit) {
        if (first.optic == kNone) return true;
        const double touch = world.optics[optic].tracer->self_hit_t_min(ray);
        if (std::fabs(hit.t - first.at.t) > touch) return hit.t < first.at.t;
        const int own = turn(optic, hit), other = turn(first.optic, first.at);
        return own < other || (own == other && hit.t < first.at.t);
    };
    for (std::size_t i = 0; i < world.optics.size(); ++i) {
        const PathOptic& optic = world.optics[i];
        const std::optional<SurfaceHit> hit = optic.tracer->first_hit(ray);
        if (!hit || hit->t > reach || (first.object.seen() && hit->t >= first.object.t)) continue;
        const bool leaves = !optic.mirror && dot(hit->point.normal, ray.direction) > 0;
        const bool rests =
            first.object.seen() && first.object.t <= hit->t + optic.tracer->self_hit_t_min(ray);
        if ((leaves && rests) || !comes_first(i, *hit)) continue;
        first.optic = static_cast<Id>(i);
        first.at = *hit;
    }
    if (first.optic != kNone) first.object = {};
    return first;
}

}  // namespace trilens
